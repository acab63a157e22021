#pragma once
#include <vector>

#include "render/framebuffer.h"
#include "render/scene_block.h"

namespace strandcast {

/// What lights see: each of them solids as a depth map and hair as opacity layers behind its front (deep
/// opacity maps, Yuksel and Keyser 2008; render/deep_opacity.h). Use, for each light: fit, then beginSolids,
/// draw, beginHairFront, draw, beginHairOpacity, draw, end; and bindTextures for reading.
class ShadowMaps {
 public:
  static constexpr int kSolidSize = 1024, kFrontSize = 256;  // texels

  /// For so many lights, 0 to kMostLights.
  ShadowMaps(const OpacityLayers& layers, size_t lights);
  size_t lights() const { return solid_targets_.size(); }

  /// Sets the light's matrix, its depth range, the opacity map's scale and the layers so that its maps cover
  /// `content`. A directional light looks at it in parallel. A light with a place looks in perspective at the
  /// ball about it, or, being a spot whose cone is narrower, along its axis; from within or near the ball
  /// through 75 degrees to either side at most, towards which shadows fade out. Depth is measured along
  /// the way it looks. `scale`, 1 or less, of the steps in which the maps grow. Returns how wide they are at
  /// most, m.
  float fit(LightBlock& light, const Box& content, float scale = 1) const;

  /// How far beside a point hair may be that its look-up in the maps still sees, over the maps' width.
  float lookUpReach() const;

  void beginSolids(size_t light) const;
  void beginHairFront(size_t light) const;
  void beginHairOpacity(size_t light) const;            ///< leaves additive blending on
  int opacitySize() const { return layers_.map_size; }  ///< texels a side
  int frontSize() const { return front_size_; }         ///< the same, of the hair's front
  size_t bytes() const;                                 ///< of device memory
  void end() const;
  void bindTextures() const;

 private:
  int slices() const { return (layers_.layers + 1) / 4; }  // of a light

  OpacityLayers layers_;
  int front_size_;
  Texture solid_depth_, front_, opacity_;  // arrays, a light behind the other
  std::vector<Framebuffer> solid_targets_, front_targets_, opacity_targets_;  // a light each
};

}  // namespace strandcast
