#pragma once
#include <Eigen/Core>
#include <span>

#include "gl/buffer.h"
#include "render/camera.h"
#include "render/render_settings.h"

namespace strandcast {

/// Binding points shared by all programs of this folder.
namespace binding {
constexpr GLuint kScene = 0, kGrowth = 1;  // uniform blocks
constexpr GLuint kGuidePositions = 0, kGuideKnots = 1, kGuides = 2, kNodes = 3, kHairs = 4, kHairVertices = 5,
                 kBodies = 6, kBodyWords = 7, kHairBodies = 8, kProbe = 9, kProbeAnswer = 10, kHairList = 11,
                 kNodeMotions = 12, kBoundHairs = 13,
                 kBoundVertices = 14;                                // storage buffers
constexpr GLuint kSolidDepth = 0, kHairFront = 1, kHairOpacity = 2;  // textures
}  // namespace binding

/// A light in shaders; LightBlock of shaders/scene.glsl, field for field.
struct LightBlock {
  Eigen::Matrix4f view_projection;  ///< of its shadow maps; z as after the division by w (shaders/light.glsl)
  Eigen::Vector4f way;    ///< unit, towards a directional light, or against the axis of another; w: depth
                          ///< range of its shadow maps, m
  Eigen::Vector4f place;  ///< m, world; w: 1 for a light with a position, 0 for a directional one
  Eigen::Vector4f cone;   ///< coneCosines(); z: texels per metre of its opacity map, at 1 m from a light with
                          ///< a position; w: outer fraction of its maps over which shadows fade out
  Eigen::Vector4f power;  ///< intensity times colour; w: unused
  float layer_ends[kMaxOpacityLayers + 1];    ///< m behind the front of the hair, as layerEnds()
  float layer_limits[kMaxOpacityLayers + 1];  ///< m: hair up to this depth counts in the layer
};

/// Scene parameters in shaders; the std140 block of shaders/scene.glsl, field for field.
struct SceneBlock {
  Eigen::Matrix4f view_projection;
  Eigen::Vector4f eye;          ///< m; w: pixels per metre at 1 m
  Eigen::Vector4f hair_color;   ///< linear; w: hair width, m
  Eigen::Vector4f body_color;   ///< linear; w: picture width, pixels
  Eigen::Vector4f background;   ///< linear; w: picture height, pixels
  Eigen::Vector4f ground;       ///< centre x, height y, centre z; w: radius, all m
  Eigen::Vector4f sampling;     ///< samples per pixel; line width, pixels; z: factor of fixed lengths, at
                                ///< most 1; w: unused
  float opacity_slices = 1;     ///< slices per light, of four layers each
  float opacity_filter = 0;     ///< OpacityLayers::filter
  float alpha_to_coverage = 0;  ///< 1 or 0
  float unused = 0;
  Eigen::Vector4f exposure;       ///< exposureGains(); w: unused
  LightBlock lights[kMaxLights];  ///< those that cast shadows first
};
static_assert(sizeof(LightBlock) == 256 && sizeof(SceneBlock) == 192 + kMaxLights * sizeof(LightBlock));

/// `camera` with values clamped to what can be drawn.
Camera clipped(const Camera& camera);

/// Distances of the clip planes along the view, m.
struct DepthRange {
  float near = 0.02f, far = 50;
};
/// The range that contains all boxes, with the near plane as close as the depth precision allows. `aspect`:
/// width over height of the picture.
DepthRange depthRange(const Camera& camera, float aspect, std::span<const Box> boxes);

/// Fills in everything but what ShadowMaps::fit and the renderer set.
SceneBlock makeSceneBlock(const RenderSettings& settings, const Camera& camera, const DepthRange& range = {});

}  // namespace strandcast
