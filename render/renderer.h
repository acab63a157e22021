#pragma once
#include <cstdint>
#include <memory>

#include "render/camera.h"
#include "render/hair_bodies.h"
#include "render/image.h"
#include "render/render_settings.h"
#include "transport/messages.h"

namespace strandcast {

/// A pass, and how long the device took for it in the newest picture, ms.
struct PassTime {
  RenderPass pass;
  double ms;
};

/// What the renderer did, since it was made unless said.
struct RenderStatistics {
  uint64_t frames_drawn = 0;
  int samples = 1;  ///< per pixel, as the device has them
  uint64_t frames_ignored =
      0;              ///< frames that did not fit the groom; the guides of the frame before were drawn
  size_t guides = 0;  ///< of the groom
  size_t guides_unusable = 0;  ///< of the newest frame: not finite, so hairs that follow them are left out
  size_t hairs_grown = 0;      ///< of the groom
  size_t hairs_drawn = 0;      ///< in the newest picture: others stand for those left out
  size_t hairs_computed = 0;   ///< for it: those drawn, and those that only cast shadows into it
  size_t groups = 0, groups_seen = 0;  ///< of hair, and those that may be in it
  int segments_drawn = 0;              ///< per hair
  size_t device_bytes = 0;             ///< of the guides, the grown hair and the shadow maps
  std::vector<PassTime> passes;        ///< in the order in which they were done
  double guides_ms = 0, growth_ms = 0, shadow_ms = 0, body_ms = 0, hair_ms = 0,
         resolve_ms = 0;  ///< the same, those of shadows, and of body, ground and background, added up
};

/// Grows hair from guides and draws it over the body, with a ground, lights and their shadow maps. Needs a
/// current OpenGL 4.5 context for its whole life. Work in linear light, tone mapped by 1 - exp(-x), stored as
/// sRGB.
class Renderer {
 public:
  explicit Renderer(const RenderSettings& settings);  ///< throws Error when a shader does not build
  ~Renderer();
  /// From the next picture on. Makes anew only what depends on what has changed.
  void setSettings(const RenderSettings& settings);
  const RenderSettings& settings() const;  ///< clipped
  /// Chooses which guides each hair follows. Call again when the groom changes. An empty groom draws no hair.
  void setGroom(const GroomDescription& groom);
  /// m, that hair of the groom may stand from its guides, the mean of all.
  float hairReach() const;
  /// A mesh without triangles draws no body.
  void setBody(const BodyDescription& body);
  /// Bodies that grown hair is kept out of, or that are marked where it is not; none at first. Throws Error
  /// where a shape is not sound.
  void setObstacles(std::vector<HairObstacle> obstacles);
  /// Draws into the renderer's own framebuffer. Leaves the default framebuffer bound.
  void draw(const GuideFrame& frame, const Camera& camera);
  /// Copies the last picture out.
  Image read();
  /// Copies the last picture to a part of the default framebuffer, stretched to its size; pixels, from the
  /// left and from below.
  void present(int left, int below, int width, int height);
  /// Waits for the newest picture.
  RenderStatistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace strandcast
