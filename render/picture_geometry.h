#pragma once
#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

class HairPass;
struct RenderSettings;

/// What a renderer shows of a frame, read back from the device: the input of path tracing. World, m.
struct PictureGeometry {
  /// All hairs that the renderer grows, whatever its level of detail, root to tip, one after another.
  std::vector<uint32_t> offsets{0};  ///< first vertex per hair, and the end; hairs + 1
  std::vector<Vec3> positions;
  std::vector<Vec3> tangents;  ///< unit, towards the tip; per vertex
  std::vector<float> widths;   ///< m, above 0; per vertex
  /// Per hair, linear colour at root and tip, 0 to 1 (hairTint() of kernels/picture.h).
  std::vector<std::array<Vec3, 2>> colors;
  TriangleMesh body;  ///< as it is posed, with normals
  Vec3 ground_center = Vec3::Zero();
  float ground_radius = 0;

  size_t hairs() const { return offsets.size() - 1; }
};

/// Adds the hairs that a pass grew last with all nodes, but for those with an unusable guide or a vertex that
/// is not finite, and repeated vertices. A tip that narrows to nothing keeps kTipWidth of the hair's width.
void addGrownHair(const HairPass& pass, const RenderSettings& settings, PictureGeometry& geometry);

constexpr float kTipWidth = 0.02f;

}  // namespace strandcast
