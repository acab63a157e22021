#pragma once
#include <cstdint>
#include <memory>

#include "io/image.h"
#include "render/camera.h"
#include "render/hair_bodies.h"
#include "render/picture_geometry.h"
#include "render/render_settings.h"
#include "transport/messages.h"

namespace strandcast {

/// A pass and its device time in the newest picture, ms.
struct PassTime {
  RenderPass pass;
  double ms;
};

/// Statistics since construction, unless stated otherwise.
struct RenderStatistics {
  uint64_t frames_drawn = 0;
  int samples = 1;  ///< per pixel, as the device rounds it
  uint64_t frames_ignored =
      0;              ///< frames that did not match the groom; the guides of the previous frame were drawn
  size_t guides = 0;  ///< of the groom
  size_t guides_unusable = 0;  ///< of the newest frame: guides that are not finite; hairs that follow them
                               ///< are not drawn
  size_t hairs_grown = 0;      ///< of the groom, with the bound ones
  size_t hairs_bound = 0;      ///< of these
  size_t hairs_drawn = 0;      ///< in the newest picture, after level of detail and culling
  size_t hairs_computed = 0;   ///< in the newest picture: drawn hairs, and those that only cast shadows into
                               ///< it
  size_t groups = 0, groups_seen = 0;  ///< groups of hair, and those that may be in the picture
  int segments_drawn = 0;              ///< per hair grown from a seed
  size_t device_bytes = 0;             ///< of guides, grown hair and shadow maps
  std::vector<PassTime> passes;        ///< in their order of execution
  double guides_ms = 0, growth_ms = 0, shadow_ms = 0, body_ms = 0, hair_ms = 0,
         resolve_ms = 0;  ///< ms; sums of the passes: shadow_ms of both shadow passes, body_ms of body,
                          ///< ground, background and marks
};

/// Grows hair from guides and draws it over the body, with a ground, lights and their shadow maps. Needs a
/// current OpenGL 4.5 context for its whole life. Lighting is linear, tone mapped by 1 - exp(-x), stored as
/// sRGB.
class Renderer {
 public:
  explicit Renderer(const RenderSettings& settings);  ///< throws Error where a shader does not compile
  ~Renderer();
  /// Takes effect with the next picture. Recreates only what depends on changed settings.
  void setSettings(const RenderSettings& settings);
  const RenderSettings& settings() const;  ///< clamped
  /// Grows the hair: chooses the guides that each hair follows. Call again when the groom changes. An empty
  /// groom draws no hair, and one without kFromSeed in its growth none from the seed. Forgets bound hairs.
  void setGroom(const GroomDescription& groom);
  /// Hairs that are bound to the groom's guides, drawn beside those that its growth and `seeded` let grow
  /// from the seed. Without hairs there are none. Throws Error where they do not fit the groom.
  void setHairs(const HairDescription& hairs);
  /// m, distance of hairs from their guides, mean over all hairs.
  float hairReach() const;
  /// A mesh without triangles draws no body.
  void setBody(const BodyDescription& body);
  /// Sets the obstacles of grown hair: penetration into them is resolved or marked. Initially none. Throws
  /// Error on an invalid shape.
  void setObstacles(std::vector<HairObstacle> obstacles);
  /// What a picture of the frame shows, with hair as draw() grows it, but all of it, with all its segments.
  /// Precondition: GrowthPath::kCompute.
  PictureGeometry geometry(const GuideFrame& frame);
  /// Draws into the renderer's own framebuffer. Leaves the default framebuffer bound.
  void draw(const GuideFrame& frame, const Camera& camera);
  /// Reads back the newest picture.
  Image read();
  /// Scales the newest picture into a rectangle of the default framebuffer; pixels, from the lower left
  /// corner.
  void present(int left, int below, int width, int height);
  /// Waits for the newest picture.
  RenderStatistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace strandcast
