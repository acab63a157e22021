#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "core/triangle_mesh.h"

namespace strandcast::samples {

/// A tube along Y with round ends and a chain of joints in it, bent by its clip: an arm, or a neck with a
/// head.
struct ArmOptions {
  std::vector<std::string> joints{"upper", "lower"};
  float radius = 0.04f;    ///< m
  float bone = 0.25f;      ///< m, from joint to joint, and from the last to the tip
  float blend = 0.06f;     ///< m, half of the stretch about a joint on which weights go over
  float spacing = 0.008f;  ///< m, between rings; 0.5 about the length of edges is as even as it gets
  int sectors = 32;
  float degrees = 60;                    ///< that the clip "bend" turns every joint but the first, about Z
  float seconds = 1;                     ///< to there, and as long back
  std::string interpolation = "LINEAR";  ///< or STEP or CUBICSPLINE
  bool narrow_weights = false;           ///< 8 bits, not floats
  /// m, by which a morph target, "bulge", moves the skin along X about the middle of the last bone, on the
  /// side of +X; the clip "swell" gives it the weight 1 within `seconds`, and 0 as long after. 0 = no such
  /// target.
  float bulge = 0;
  float bulge_at_rest = 0;  ///< its weight then
  bool skinned = true;      ///< else the mesh has no skin and its node, "figure", no joints
};

/// As .glb; as .gltf with its buffer in a data URI; and the JSON of that, for tests to damage.
std::vector<std::byte> armGlb(const ArmOptions& options = {});
std::vector<std::byte> armGltf(const ArmOptions& options = {});
/// As armGltf, with `from`, which must be there, replaced.
std::vector<std::byte> armWith(const ArmOptions& options, const std::string& from, const std::string& to);
/// A tube of few vertices: what the fuzzers start from.
ArmOptions smallArm();
/// How far the target of an arm with a bulge moves what is at `p` at rest without it, m.
Vec3 bulgeAt(const ArmOptions& options, const Vec3& p);

}  // namespace strandcast::samples
