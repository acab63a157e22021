#pragma once
#include <span>
#include <vector>

#include "render/hair_pass.h"
#include "render/shadow_map.h"

namespace strandcast {

/// A piece of a hair in a texel of the opacity map.
struct LightFragment {
  float x, y;           ///< texel
  float depth;          ///< 0 to 1, of the light's depth range
  float optical_depth;  ///< of this piece
};

/// What the maps say about a point.
struct LightAnswer {
  float behind;         ///< m, behind the front of the hair
  float optical_depth;  ///< of the hair between the light and the point
};

/// A groom at rest and the light's maps of it, read back: for validation. Needs a current context.
class LightProbe {
 public:
  /// Of the settings, growth, hair_width, segments and light count.
  LightProbe(const StrandSet& guides, const RenderSettings& settings);

  /// Every piece of hair that an opacity map of so many texels adds up, in no certain order: what is exact
  /// along the light's rays.
  std::vector<LightFragment> fragments(int map_size);
  /// Draws the maps and asks them, by the shaders' own look-up, at points in the light's coordinates (0 to
  /// 1).
  std::vector<LightAnswer> ask(const OpacityLayers& layers, std::span<const Vec3> points);
  /// m, of the light's coordinates from 0 to 1.
  float depthRange() const { return block_.light.w(); }
  /// Tangent of half the angle that the maps of a light with a place take in.
  float slope() const { return 1 / block_.light_view_projection.block<1, 3>(0, 0).norm(); }

 private:
  void bindScene(const ShadowMap& map, const OpacityLayers& layers);

  RenderSettings settings_;
  GuideNodes nodes_;
  HairPass hair_;
  Box box_;
  SceneBlock block_{};
  gl::Buffer scene_;
};

}  // namespace strandcast
