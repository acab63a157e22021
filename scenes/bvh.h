#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "groom/file_report.h"

namespace strandcast {

/// kScale: of any axis; its values are passed over.
enum class BvhChannel : uint8_t {
  kXPosition,
  kYPosition,
  kZPosition,
  kXRotation,
  kYRotation,
  kZRotation,
  kScale
};

struct BvhJoint {
  std::string name;                  ///< "End Site" for the ends of chains
  int parent = -1;                   ///< index of an earlier joint; -1 for a root
  Vec3 offset = Vec3::Zero();        ///< file units, in the parent's frame
  std::vector<BvhChannel> channels;  ///< in the file's order, in which rotations multiply
  size_t first_channel = 0;          ///< of a frame's values
};

/// A motion clip as its file has it: file units and axes, degrees.
struct BvhClip {
  std::vector<BvhJoint> joints;  ///< parents before children
  size_t channels = 0;           ///< values per frame
  size_t frames = 0;             ///< 1 or more
  double frame_time = 0;         ///< s
  std::vector<float> values;     ///< frames x channels
  FileReport report;

  /// Index of the first joint called `name`; with an empty name the first whose name contains "head" in any
  /// case; -1 if none.
  int find(const std::string& name) const;
  /// Placement of a joint in the clip's frame at a frame. Position channels stand in place of the joint's
  /// offset.
  Pose pose(size_t joint, size_t frame) const;
  /// The same with every rotation at zero and every joint at its rest offset: where the skeleton is at rest.
  Vec3 restPosition(size_t joint) const;
  /// A joint's place in its parent's frame at rest: its OFFSET; where that is 0, as in files whose position
  /// channels hold the skeleton, its position channels in the first frame. A root's is its OFFSET.
  Vec3 restOffset(size_t joint) const;
  /// The longest side of the box about all joints at rest, in file units.
  float size() const;
  /// Turns the clip's axes so that Y is up. Clips stand along Y or Z: the axis along which `head` is farther
  /// from the first joint tells which.
  Quat upright(size_t head) const;
  /// Metres per unit such that the skeleton at rest is about as tall as a person: 1, 0.1, 0.01, 0.0254 or
  /// 0.001.
  float guessedUnit() const;
};

/// Reads a BVH (Biovision hierarchy) clip. Keywords are known in any case; OFFSET, CHANNELS and children come
/// in any order. What of the frames is left out or mended (bvh_motion.h) is told in the report. Throws Error
/// with `name`, line and remedy on joints that are truncated, malformed, too many or not finite, and where
/// there is no whole frame. Never allocates more than the input's size justifies.
BvhClip readBvh(std::span<const std::byte> bytes, const std::string& name);
/// Also as readFileBytes.
BvhClip readBvh(const std::filesystem::path& file);

}  // namespace strandcast
