#pragma once
#include <vector>

#include "render/framebuffer.h"
#include "render/scene_block.h"

namespace strandcast {

/// The shadow maps of lights: for each of them solids as a depth map and hair as opacity layers behind its
/// front (deep opacity maps, Yuksel and Keyser 2008; OpacityLayers). Use, for each light: fit, then
/// beginSolids, draw, beginHairFront, draw, beginHairOpacity, draw, end; and bindTextures for reading.
class ShadowMaps {
 public:
  static constexpr int kSolidSize = 1024, kFrontSize = 256;  // texels per side

  /// `lights`: 0 to kMaxLights.
  ShadowMaps(const OpacityLayers& layers, size_t lights);
  size_t lights() const { return solid_targets_.size(); }

  /// Sets the light's matrix, depth range, opacity map scale and layers so that its maps cover `content`. A
  /// directional light has a parallel projection. A light with a position has a perspective one around the
  /// bounding ball of `content`, or along its axis for a spot with a narrower cone. From within or near the
  /// ball, the view is limited to 75 degrees to either side, and shadows fade out towards its edge. Depth is
  /// measured along the view axis. `scale`, at most 1: factor of the quantisation steps of the maps' size.
  /// Returns an upper bound on their width, m.
  float fit(LightBlock& light, const Box& content, float scale = 1) const;

  /// Largest distance beside a point at which hair affects its look-up, over the maps' width.
  float lookupRadius() const;

  void beginSolids(size_t light) const;
  void beginHairFront(size_t light) const;
  void beginHairOpacity(size_t light) const;            ///< leaves additive blending enabled
  int opacitySize() const { return layers_.map_size; }  ///< texels per side
  int frontSize() const { return front_size_; }         ///< texels per side of the front of the hair
  size_t bytes() const;                                 ///< device memory
  void end() const;
  void bindTextures() const;

 private:
  int slices() const { return (layers_.layers + 1) / 4; }  // per light

  OpacityLayers layers_;
  int front_size_;
  Texture solid_depth_, front_, opacity_;  // array textures, one layer (or run of slices) per light
  std::vector<Framebuffer> solid_targets_, front_targets_, opacity_targets_;  // one per light
};

}  // namespace strandcast
