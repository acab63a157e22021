#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/contact_primitive.h"
#include "core/geometry.h"
#include "core/parameters.h"
#include "core/strand_set.h"
#include "core/surface_bend.h"
#include "core/triangle_mesh.h"

namespace strandcast {

/// A groom as a renderer needs it: sent once, kept for those who come late.
struct GroomDescription {
  uint32_t groom_id = 0;
  uint64_t session = 0;   ///< of the daemon's start; another session means everything is new
  uint32_t revision = 0;  ///< of the topology; frames name the revision they fit
  std::string name;
  float hair_radius = 40e-6f;  ///< m, see isHairRadius()
  StrandSet guides;            ///< rest shape, metres, groom frame
};

inline bool isHairRadius(float radius) { return radius >= 0 && radius <= kThickestHair; }

/// The surface that the hair grows on and falls over.
struct BodyDescription {
  uint32_t groom_id = 0;
  uint64_t session = 0;
  uint32_t revision = 0;            ///< of the groom that it was announced with (set by Publisher::announce)
  TriangleMesh mesh;                ///< metres, groom frame
  std::vector<float> head_weights;  ///< per position, 0 to 1: 1 moves with the head, 0 stays; empty = all 1
};

/// A body of the simulation: shapes that share one rigid motion.
struct Collider {
  uint32_t id = 0;  ///< of a session, never given to another one
  bool follows_head = false;
  bool is_whole = true;  ///< of the receiver: false where a field of it was too large to be sent
  std::vector<ContactPrimitive> shapes;  ///< m: of the head at rest, else in the collider's own frame
};

/// What hair collides with.
struct ColliderSet {
  uint32_t groom_id = 0;
  uint64_t session = 0;
  uint32_t revision = 0;  ///< counts up within a session with every collider that is added or removed
  std::vector<Collider> colliders;
};

/// Where a collider is that does not follow the head.
struct PlacedCollider {
  uint32_t id = 0;
  Pose pose;
  SurfaceBend bend;  ///< of its fields, in its own frame
};
inline constexpr size_t kMaxPlacedColliders = 128;  ///< in a frame

/// All guides at one instant.
struct GuideFrame {
  uint32_t groom_id = 0;
  uint64_t session = 0;
  uint32_t revision = 0;
  uint64_t frame = 0;                     ///< from 1, counts up by one per published frame
  double simulation_time = 0;             ///< s
  uint64_t publish_time = 0;              ///< ns, system clock of the daemon
  Pose head;                              ///< of the head, relative to rest
  std::vector<Vec3> positions;            ///< world, m, natural order of the groom's guides
  std::vector<PlacedCollider> colliders;  ///< that do not follow the head; kMaxPlacedColliders at most
  // Of the receiver:
  uint64_t arrival_time = 0;       ///< ns, steady clock of the receiver, when it was complete
  uint32_t strands_concealed = 0;  ///< that were lost on the way and are put where they probably are, as
                                   ///< colliders are whose chunk was lost
};

enum class CommandKind : uint32_t {
  kSetParameter = 0,
  kHeadPose = 1,
  kHeadMotion = 2,
  kReset = 3,
  kShutdown = 4,
  kPause = 5,
  kStep = 6,
  kPull = 7,
  kAddCollider = 8,
  kMoveCollider = 9,
  kRemoveCollider = 10,
  kAddWindSource = 11,
  kMoveWindSource = 12,
  kRemoveWindSource = 13,
  kAddColliderFile = 14
};

struct Command {
  uint32_t groom_id = 0;
  uint64_t id = 0;  ///< chosen by the sender, not 0; echoed in Status::last_command
  CommandKind kind = CommandKind::kReset;
  std::string name;            ///< of a parameter, head motion, collider (and its file) or source of wind
  std::vector<double> values;  ///< docs/wire.md, "Command"
};

/// What the channel made of the newest frame.
struct EncodingReport {
  std::string codec;         ///< as of codecList(), transport/codec/codec.h; empty where nothing is encoded
  double max_error = 0;      ///< m, that the encoder keeps to
  double worst_error = 0;    ///< m, that it found
  uint64_t frame_bytes = 0;  ///< of all payloads; 0 before the first frame
  uint64_t strands_sent_finer = 0;  ///< because their error would have been larger
};

/// Parameters as a status tells them, flat as on the wire (transport/parameter_table.h).
struct ParameterTable {
  std::string names;                ///< in order, a space between two
  std::vector<uint8_t> components;  ///< per parameter: how many of the values are its
  std::vector<float> values;
};

struct Status {
  uint32_t groom_id = 0;
  uint64_t session = 0;
  std::string groom_name, backend, device;
  uint64_t strands = 0, vertices = 0;
  uint64_t frames = 0;         ///< published
  double simulation_time = 0;  ///< s
  double step_ms_median = 0, step_ms_p95 = 0;
  double mean_stretch = 0;     ///< relative, in the frames since the last status
  double max_stretch = 0;      ///< relative, the most since the start
  double max_penetration = 0;  ///< m, deepest since the start
  uint64_t non_finite = 0;     ///< vertices, in the frames since the last status
  uint64_t strands_reset = 0;  ///< put back to their rest shape because they went wrong, since the start
  uint32_t readers = 0;        ///< matched subscribers of the guides
  EncodingReport encoding;
  uint64_t last_command = 0;       ///< id of the newest command carried out or refused
  std::string last_command_error;  ///< empty when it was carried out
  ParameterTable parameters;       ///< that commands can set, with their present values; behind them
                                   ///< what else they steer: toldOf()
};

}  // namespace strandcast
