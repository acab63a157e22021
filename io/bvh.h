#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "io/file_report.h"

namespace strandcast {

/// kScale: scale about any axis; its values are ignored.
enum class BvhChannel : uint8_t {
  kXPosition,
  kYPosition,
  kZPosition,
  kXRotation,
  kYRotation,
  kZRotation,
  kScale
};

/// A joint of a clip, or the end of a chain.
struct BvhJoint {
  std::string name;                  ///< "End Site" for the ends of chains
  int parent = -1;                   ///< index of an earlier joint; -1 for a root
  Vec3 offset = Vec3::Zero();        ///< file units, in the parent's frame
  std::vector<BvhChannel> channels;  ///< in the file's order, in which rotations multiply
  size_t first_channel = 0;          ///< index into a frame's values
};

/// A motion clip as stored in its file: file units and axes, degrees.
struct BvhClip {
  std::vector<BvhJoint> joints;  ///< parents before children
  size_t channels = 0;           ///< values per frame
  size_t frames = 0;             ///< 1 or more
  double frame_time = 0;         ///< s
  std::vector<float> values;     ///< frames x channels
  FileReport report;

  /// Index of the first joint called `name`; -1 if none. An empty name finds the first joint whose name
  /// contains "head", ignoring case.
  int find(const std::string& name) const;
  /// Placement of a joint in the clip's frame of reference at a frame. Position channels replace the joint's
  /// offset.
  Pose pose(size_t joint, size_t frame) const;
  /// Position of a joint with all rotations zero and all joints at restOffset(): the skeleton at rest.
  Vec3 restPosition(size_t joint) const;
  /// Offset of a joint from its parent at rest: its OFFSET. If that is 0, as in files that store the skeleton
  /// in position channels, the position channels of the first frame. A root's offset is always its OFFSET.
  Vec3 restOffset(size_t joint) const;
  /// Longest side of the bounding box of all joints at rest, in file units.
  float size() const;
  /// Rotation of the clip's axes that makes Y up. The up axis is Y or Z: the one along which `head` is
  /// farther from the first joint.
  Quat upright(size_t head) const;
  /// Metres per unit with which the skeleton at rest is about as tall as a person: 1, 0.1, 0.01, 0.0254 or
  /// 0.001.
  float guessedUnit() const;
};

/// Reads a BVH (Biovision hierarchy) clip. Keywords match in any case; OFFSET, CHANNELS and children may come
/// in any order. The report lists what is left out or repaired of the frames. Throws Error
/// with `name`, line and remedy on joints that are truncated, malformed, too many or not finite, and when
/// there is no whole frame. Memory use is proportional to the input.
BvhClip readBvh(std::span<const std::byte> bytes, const std::string& name);
/// Reads a file. Throws Error as readFileBytes, too.
BvhClip readBvh(const std::filesystem::path& file);

}  // namespace strandcast
