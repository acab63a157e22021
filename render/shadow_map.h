#pragma once
#include "render/framebuffer.h"
#include "render/scene_block.h"

namespace strandcast {

/// The light's view: solids as a depth map, hair as opacity layers behind its front (deep opacity maps,
/// Yuksel and Keyser 2008). The front map is coarse, so that single hairs do not make steps in it. Use: fit,
/// then beginSolids, draw, beginHairFront, draw, beginHairOpacity, draw, and bindTextures for reading.
class ShadowMap {
 public:
  static constexpr int kSolidSize = 1024, kFrontSize = 64, kOpacitySize = 512;  // texels

  ShadowMap();
  /// Sets the light's matrix, its depth range and the opacity map's scale in `block` so that the maps cover
  /// `content`.
  static void fit(SceneBlock& block, const Box& content);

  void beginSolids() const;
  void beginHairFront() const;
  void beginHairOpacity() const;  ///< leaves additive blending on
  void end() const;
  void bindTextures() const;

 private:
  Texture solid_depth_, front_, opacity_;
  Framebuffer solid_target_, front_target_, opacity_target_;
};

}  // namespace strandcast
