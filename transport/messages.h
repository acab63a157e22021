// Public API
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/contact_primitive.h"
#include "core/distance_field.h"
#include "core/geometry.h"
#include "core/parameters.h"
#include "core/strand_set.h"

namespace strandcast {

/// A groom as a renderer needs it: sent once and kept for late joiners.
struct GroomDescription {
  uint32_t groom_id = 0;
  uint64_t session = 0;   ///< random per start of the daemon; another one invalidates all data of the last
  uint32_t revision = 0;  ///< of the topology; frames name the revision that they fit
  std::string name;
  float hair_radius = 40e-6f;  ///< m, see isHairRadius()
  StrandSet guides;            ///< rest shape, metres, groom frame
  /// What is drawn, a sum. A renderer draws once all that it names is here.
  enum Growth : uint32_t {
    kFromSeed = 1,  ///< hair that the renderer grows from a seed
    kHairs = 2,     ///< hairs that follow: HairDescription
    kHairMesh = 4   ///< a hair mesh that follows
  };
  uint32_t growth = kFromSeed;  ///< 1 to 7
  std::vector<uint8_t> seeded;  ///< per guide, 1 where hair from a seed may follow it; empty: all
  std::vector<uint32_t> ids;    ///< per guide, the artist's id, or empty
};

/// Hairs that follow the guides of a groom instead of growing from a seed: docs/architecture.md, "From guides
/// to pixels". Every array but the hairs' positions and the bindings may be empty.
struct HairDescription {
  uint32_t groom_id = 0;
  uint64_t session = 0;
  uint32_t revision = 0;                        ///< of the groom, whose guides the bindings name
  StrandSet hairs;                              ///< rest shape, metres, groom frame; `pinned` is not used
  std::vector<HairBinding> bindings;            ///< per hair
  std::vector<std::array<uint8_t, 3>> colours;  ///< per hair, reflectance, sRGB 0 to 255
  std::vector<uint32_t> ids;                    ///< per hair, the artist's id
  std::string source;                           ///< files and option, for errors; not sent, empty at readers
};

inline bool isHairRadius(float radius) { return radius >= 0 && radius <= kThickestHair; }

/// The surface that the hair grows on and collides with.
struct BodyDescription {
  uint32_t groom_id = 0;
  uint64_t session = 0;
  uint32_t revision = 0;  ///< of the groom that it was announced with (set by Publisher::announce)
  TriangleMesh mesh;      ///< metres, groom frame
  /// Per position, 0 to 1: 1 moves with the head, 0 stays; empty means all 1
  std::vector<float> head_weights;
};

/// A body of the simulation: shapes that share one rigid motion.
struct Collider {
  uint32_t id = 0;  ///< unique within a session, never reused
  bool follows_head = false;
  bool is_whole = true;  ///< set by the receiver: false where one of its fields was too large to be sent
  /// m; in the frame of the head at rest if follows_head, else in the collider's own frame
  std::vector<ContactPrimitive> shapes;
};

/// All colliders of the hair.
struct ColliderSet {
  uint32_t groom_id = 0;
  uint64_t session = 0;
  uint32_t revision = 0;  ///< counts up within a session with every collider that is added or removed
  std::vector<Collider> colliders;
};

/// Pose of a collider that does not follow the head.
struct PlacedCollider {
  uint32_t id = 0;
  Pose pose;
  SurfaceBend bend;  ///< of the collider's fields, in its own frame
};
inline constexpr size_t kMaxPlacedColliders = 128;  ///< per frame

/// All guides at one instant.
struct GuideFrame {
  uint32_t groom_id = 0;
  uint64_t session = 0;
  uint32_t revision = 0;
  uint64_t frame = 0;                     ///< from 1, counts up by one per published frame
  double simulation_time = 0;             ///< s
  uint64_t publish_time = 0;              ///< ns, system clock of the daemon
  uint64_t pose_source = 0;               ///< sender of the live poses that the frame shows; 0 = none
  uint64_t pose_time = 0;                 ///< ns by that sender's clock, of the newest pose in the frame
  uint32_t continuity = 0;                ///< another value than in the frame before: the motion jumps here
  Pose head;                              ///< pose of the head relative to rest
  std::vector<Vec3> positions;            ///< world, m, natural order of the groom's guides
  std::vector<PlacedCollider> colliders;  ///< those that do not follow the head; at most kMaxPlacedColliders
  // Set by the receiver:
  uint64_t arrival_time = 0;       ///< ns, steady clock of the receiver, when the frame was complete
  uint32_t strands_concealed = 0;  ///< strands that were lost and whose positions were extrapolated;
                                   ///< colliders are extrapolated likewise where their chunk was lost
};

/// Numbers on the wire: docs/wire.md, "Command", has the name and the values of each kind.
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

/// A command to the daemon of a groom. isSound(Command) in transport/chunks.h has its limits.
struct Command {
  uint32_t groom_id = 0;
  uint64_t id = 0;  ///< chosen by the sender, not 0; repeated in Status::last_command
  CommandKind kind = CommandKind::kReset;
  std::string name;            ///< of a parameter, head motion, collider (and its file) or source of wind
  std::vector<double> values;  ///< docs/wire.md, "Command"
};

/// Poses of a head, joints and bodies, from a program that moves a character to the daemon of its hair. Each
/// is a motion from rest: x_world = rotation * x_rest + position. A message has the newest sample and may
/// repeat some before it. Fields and ranges: docs/wire.md, "PoseSamples"; isSound(PoseSamples) in
/// transport/pose_inbox.h checks them.
struct PoseSamples {
  uint64_t source = 0;          ///< random per start of the sender, not 0
  uint64_t time = 0;            ///< ns, sender's clock, of the newest sample
  uint64_t sent_time = 0;       ///< ns, sender's system clock; 0: unknown
  uint32_t groom_id = 0;        ///< 0: every groom that the message reaches
  uint32_t newest = 0;          ///< number of the newest sample; counts up by one a sample, and wraps
  uint32_t epoch = 0;           ///< another one: the motion jumps here, or the clock was set
  uint32_t names_revision = 0;  ///< another one: other names
  std::string names;  ///< of the poses, escaped: poseNames(). Both lists are empty where this revision's
  std::string weight_names;    ///< names were sent before
  std::vector<uint32_t> ages;  ///< per sample, newest first: ns before `time`
  std::vector<float> poses;    ///< per sample and name: position x y z (m), rotation x y z w
  std::vector<float> scales;   ///< per sample and name 3, or none: 1. They apply to joints only
  std::vector<float> weights;  ///< per sample and weight name, of morph targets
  // Set by the receiver, which also normalises the rotations:
  uint64_t arrival_time = 0;  ///< ns, steady clock of the receiver
};
inline constexpr size_t kMaxPoseSamples = 16, kMaxPoseNames = 512, kMaxWeightNames = 256;  ///< per message
inline constexpr size_t kMaxPoseNameBytes = 16384, kMaxWeightNameBytes = 8192;             ///< of all names

/// How the channel encoded the newest frame.
struct EncodingReport {
  std::string codec;       ///< a name of codecList(), transport/codec/codec.h; empty where nothing is encoded
  double max_error = 0;    ///< m, bound that the encoder keeps
  double worst_error = 0;  ///< m, largest error in the frame
  uint64_t frame_bytes = 0;  ///< of all payloads; 0 before the first frame
  /// Strands sent as float32 because their error would have exceeded max_error
  uint64_t strands_sent_finer = 0;
};

/// Parameters of a status, flat as on the wire (transport/parameter_table.h).
struct ParameterTable {
  std::string names;                ///< in order, separated by one space
  std::vector<uint8_t> components;  ///< per parameter: how many of the values belong to it
  std::vector<float> values;
};

/// Measured values of a status, by name (transport/metrics.h).
struct MetricTable {
  std::string names;  ///< in order, separated by one space
  std::vector<double> values;
};

/// A program of another version of the wire. The two exchange nothing: docs/wire.md, "Version".
struct OtherVersion {
  bool is_daemon = false;   ///< it casts; else it wants frames or sends commands
  int first = 0, last = 0;  ///< versions that it may have; a newer one than is known here: both 0

  bool operator==(const OtherVersion&) const = default;
};

/// State of a daemon, published twice a second and in answer to each command.
struct Status {
  uint32_t groom_id = 0;
  uint64_t session = 0;
  std::string groom_name, backend, device;
  uint64_t strands = 0, vertices = 0;
  uint64_t frames = 0;         ///< published so far
  double simulation_time = 0;  ///< s
  double step_ms_median = 0, step_ms_p95 = 0;
  /// Relative to rest length, over all strands, each measured once since the last status
  double mean_stretch = 0;
  double max_stretch = 0;      ///< relative to rest length, maximum since the start or a reset
  double max_penetration = 0;  ///< m, maximum since the start or a reset
  uint64_t non_finite = 0;     ///< vertices, counted when their strands were measured since the last status
  /// Strands restored to their rest shape after an invalid state, since the start or a reset
  uint64_t strands_reset = 0;
  uint32_t readers = 0;  ///< matched subscribers of the guides
  uint32_t writers = 1;  ///< processes that write chunks of each frame
  EncodingReport encoding;
  uint64_t last_command = 0;       ///< id of the newest command carried out or refused
  std::string last_command_error;  ///< empty when it was carried out
  ParameterTable parameters;  ///< that commands can set, with their present values, followed by the other
                              ///< things that commands steer: entriesOf()
  MetricTable metrics;
};

}  // namespace strandcast
