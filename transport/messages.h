#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "core/parameters.h"
#include "core/strand_set.h"
#include "core/triangle_mesh.h"

namespace strandcast {

/// A groom as a renderer needs it: sent once, kept for those who come late.
struct GroomDescription {
  uint32_t groom_id = 0;
  uint64_t session = 0;   ///< of the daemon's start; another session means everything is new
  uint32_t revision = 0;  ///< of the topology; frames name the revision they fit
  std::string name;
  float hair_radius = 40e-6f;  ///< m
  StrandSet guides;            ///< rest shape, metres, groom frame
};

/// The surface that the hair grows on and falls over.
struct BodyDescription {
  uint32_t groom_id = 0;
  uint64_t session = 0;
  uint32_t revision = 0;            ///< of the groom that it was announced with (set by Publisher::announce)
  TriangleMesh mesh;                ///< metres, groom frame
  std::vector<float> head_weights;  ///< per position, 0 to 1: 1 moves with the head, 0 stays; empty = all 1
};

/// All guides at one instant.
struct GuideFrame {
  uint32_t groom_id = 0;
  uint64_t session = 0;
  uint32_t revision = 0;
  uint64_t frame = 0;           ///< from 1, counts up by one per published frame
  double simulation_time = 0;   ///< s
  uint64_t publish_time = 0;    ///< ns, system clock of the daemon
  Pose head;                    ///< of the head, relative to rest
  std::vector<Vec3> positions;  ///< world, m, natural order of the groom's guides
  // Of the receiver:
  uint64_t arrival_time = 0;       ///< ns, steady clock of the receiver, when it was complete
  uint32_t strands_concealed = 0;  ///< that were lost on the way and are put where they probably are
};

enum class CommandKind : uint32_t {
  kSetParameter = 0,
  kHeadPose = 1,
  kHeadMotion = 2,
  kReset = 3,
  kShutdown = 4,
  kPause = 5,
  kStep = 6,
  kPull = 7
};

struct Command {
  uint32_t groom_id = 0;
  uint64_t id = 0;  ///< chosen by the sender, not 0; echoed in Status::last_command
  CommandKind kind = CommandKind::kReset;
  std::string name;  ///< parameter, or name of a head motion
  /// Parameter components; head pose: position x y z, rotation x y z w; pause: 1, or 0 to go on; step: how
  /// many; pull: where a hand closes, x y z and radius, where it is, x y z, and rate (Simulation::pullHair),
  /// or nothing to let go.
  std::vector<double> values;
};

/// What the channel made of the newest frame.
struct EncodingReport {
  std::string codec;         ///< as of codecList(), transport/codec/codec.h; empty where nothing is encoded
  double max_error = 0;      ///< m, that the encoder keeps to
  double worst_error = 0;    ///< m, that it found
  uint64_t frame_bytes = 0;  ///< of all payloads; 0 before the first frame
  uint64_t strands_sent_finer = 0;  ///< because their error would have been larger
};

struct Status {
  uint32_t groom_id = 0;
  uint64_t session = 0;
  std::string groom_name, backend, device;
  uint64_t strands = 0, vertices = 0;
  uint64_t frames = 0;         ///< published
  double simulation_time = 0;  ///< s
  double step_ms_median = 0, step_ms_p95 = 0;
  double mean_stretch = 0, max_stretch = 0;  ///< of the newest frame, relative
  double max_penetration = 0;                ///< m, deepest since the start
  uint64_t non_finite = 0;                   ///< vertices in the newest frame
  uint64_t strands_reset = 0;  ///< put back to their rest shape because they went wrong, since the start
  uint32_t readers = 0;        ///< matched subscribers of the guides
  EncodingReport encoding;
  uint64_t last_command = 0;       ///< id of the newest command carried out or refused
  std::string last_command_error;  ///< empty when it was carried out
};

}  // namespace strandcast
