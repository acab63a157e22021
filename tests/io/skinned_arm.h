#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast::samples {

/// A tube along Y with round ends and a chain of joints, bent by a clip: an arm, or a neck with a head.
struct ArmOptions {
  std::vector<std::string> joints{"upper", "lower"};
  float radius = 0.04f;    ///< m
  float bone = 0.25f;      ///< m, from joint to joint, and from the last to the tip
  float blend = 0.06f;     ///< m, half the stretch about a joint over which weights change
  float spacing = 0.008f;  ///< m, between rings; half the length of edges gives the most regular mesh
  int sectors = 32;
  float degrees = 60;  ///< by which the clip "bend" rotates each joint but the first about Z
  float seconds = 1;   ///< of the bend, and of the way back
  std::string interpolation = "LINEAR";  ///< or STEP or CUBICSPLINE
  bool narrow_weights = false;           ///< 8 bits, not floats
  /// m. Displacement along X by a morph target, "bulge", of the skin around the middle of the last bone, on
  /// the +X side. The clip "swell" raises its weight to 1 within `seconds`, and lowers it to 0 in the same
  /// time. 0: no target.
  float bulge = 0;
  float bulge_at_rest = 0;  ///< the target's weight at rest
  bool skinned = true;      ///< else the mesh has no skin and its node, "figure", no joints
};

/// As .glb; as .gltf with its buffer in a data URI; as .gltf for tests to damage (armWith).
std::vector<std::byte> armGlb(const ArmOptions& options = {});
std::vector<std::byte> armGltf(const ArmOptions& options = {});
/// As armGltf, with the first `from`, which must exist, replaced by `to`.
std::vector<std::byte> armWith(const ArmOptions& options, const std::string& from, const std::string& to);
/// A tube of few vertices: what the fuzzers start from.
ArmOptions smallArm();
/// Displacement by the target of an arm with a bulge of the point that is at `p` without it, m.
Vec3 bulgeAt(const ArmOptions& options, const Vec3& p);

}  // namespace strandcast::samples
