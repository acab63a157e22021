#pragma once
#include <span>
#include <vector>

#include "render/hair_pass.h"
#include "render/shadow_maps.h"

namespace strandcast {

/// A fragment of a hair in a texel of the opacity map.
struct LightFragment {
  float x, y;           ///< texels
  float depth;          ///< 0 to 1, in the light's depth range
  float optical_depth;  ///< of this fragment
};

/// The maps' values at a point.
struct LightAnswer {
  float behind;         ///< m, behind the front of the hair
  float optical_depth;  ///< of the hair between the light and the point
};

/// A groom at rest and the light's maps of it, read back for validation. Needs a current context.
class LightProbe {
 public:
  /// Uses the settings growth, hair_width, segments and lights; all lights cast shadows.
  LightProbe(const StrandSet& guides, const RenderSettings& settings);

  /// Every hair fragment that an opacity map of `map_size` texels accumulates, in unspecified order: the
  /// exact data along the light's rays.
  std::vector<LightFragment> fragments(int map_size, size_t light = 0);
  /// Draws the maps of all lights and evaluates those of `light`, by the shaders' own look-up, at points in
  /// its coordinates (0 to 1).
  std::vector<LightAnswer> ask(const OpacityLayers& layers, std::span<const Vec3> points, size_t light = 0);
  /// m, for the light's depth coordinate from 0 to 1.
  float depthRange(size_t light = 0) const { return block_.lights[light].way.w(); }
  /// Tangent of half the view angle of the maps of a light with a position.
  float slope(size_t light = 0) const {
    return 1 / block_.lights[light].view_projection.block<1, 3>(0, 0).norm();
  }

 private:
  void bindScene(const ShadowMaps& maps, const OpacityLayers& layers);

  RenderSettings settings_;
  GuideNodes nodes_;
  HairPass hair_;
  Box box_;
  SceneBlock block_{};
  gl::Buffer scene_;
};

}  // namespace strandcast
