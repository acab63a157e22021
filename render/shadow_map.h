#pragma once
#include "render/framebuffer.h"
#include "render/scene_block.h"

namespace strandcast {

/// The light's view: solids as a depth map, hair as opacity layers behind its front (deep opacity maps,
/// Yuksel and Keyser 2008; render/deep_opacity.h). Use: fit,
/// then beginSolids, draw, beginHairFront, draw, beginHairOpacity, draw, and bindTextures for reading.
class ShadowMap {
 public:
  static constexpr int kSolidSize = 1024, kFrontSize = 256;  // texels

  explicit ShadowMap(const OpacityLayers& layers);
  /// Sets the light's matrix, its depth range, the opacity map's scale and the layers in `block` so that the
  /// maps cover `content`. A directional light looks at it in parallel. A light with a place looks in
  /// perspective at the ball about it, or, being a spot whose cone is narrower, along its axis; from within
  /// or near the ball through 75 degrees to either side at most, beside which there are no shadows. Depth is
  /// measured along the way it looks. Returns how wide the maps are at most, m.
  float fit(SceneBlock& block, const Box& content) const;

  /// How far beside a point hair may be that its look-up in the maps still sees, over the maps' width.
  float lookUpReach() const;

  void beginSolids() const;
  void beginHairFront() const;
  void beginHairOpacity() const;                        ///< leaves additive blending on
  int opacitySize() const { return layers_.map_size; }  ///< texels a side
  size_t bytes() const;                                 ///< of device memory
  void end() const;
  void bindTextures() const;

 private:
  OpacityLayers layers_;
  Texture solid_depth_;
  int front_size_;
  Texture front_, opacity_;
  Framebuffer solid_target_, front_target_, opacity_target_;
};

}  // namespace strandcast
