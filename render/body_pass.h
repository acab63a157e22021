#pragma once
#include <array>
#include <span>
#include <vector>

#include "gl/program.h"
#include "render/hair_bodies.h"
#include "render/render_settings.h"
#include "render/scene_block.h"
#include "transport/messages.h"

namespace strandcast {

/// Draws the body, the ground and the background.
class BodyPass {
 public:
  BodyPass();
  ~BodyPass();
  BodyPass(const BodyPass&) = delete;
  BodyPass& operator=(const BodyPass&) = delete;

  /// Triangles with indices out of range or corners that are not finite are skipped.
  void setBody(const BodyDescription& body);
  /// Obstacles that carry the body (BodyBinding): such a body is drawn at their poses, not at the head's.
  void setObstacles(std::span<const HairObstacle> obstacles);
  /// Sets the colliders' poses for the following pictures.
  void setColliderPoses(std::span<const PlacedCollider> colliders);
  /// Recompiles the shaders for these lights; initially none.
  void setLights(const LightCounts& lights);
  /// Bounds of the body with its head at rest, or at its colliders' poses, m, world; empty without a body.
  const Box& bounds() const { return bounds_; }

  /// The body in the world, m, with normals.
  TriangleMesh mesh(const Pose& head) const;

  void drawDepth(const Pose& head, size_t light) const;  ///< `light`: index in SceneBlock::lights
  /// Draw into the bound framebuffer, with the bound scene block and shadow maps. `head`: pose of the head.
  void drawBackground() const;
  void drawBody(const Pose& head) const;
  void drawGround() const;

 private:
  struct Vertex {
    float position[3], normal[3], head_weight;
  };

  void drawMesh(const gl::Program& program, const Pose& head) const;
  void bind();
  void computeBounds(std::span<const Vertex> vertices);

  gl::Program background_, ground_, body_, depth_;
  gl::Buffer vertices_, indices_;
  GLuint empty_vertices_ = 0, mesh_ = 0;
  GLsizei index_count_ = 0;
  std::vector<Vertex> rest_;    ///< the body as given
  std::vector<Vertex> placed_;  ///< at its colliders' poses
  std::vector<std::array<uint32_t, 3>> triangles_;
  std::vector<BodyPart> parts_;
  BodyBinding binding_;
  Box bounds_;
};

}  // namespace strandcast
