#pragma once
#include <array>
#include <span>
#include <vector>

#include "gl/program.h"
#include "render/hair_bodies.h"
#include "render/light.h"
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

  /// Triangles whose indices are out of range or whose corners are not finite are left out.
  void setBody(const BodyDescription& body);
  /// A body that these carry (BodyBinding) is drawn where they are, and not where the head is.
  void setObstacles(std::span<const HairObstacle> obstacles);
  /// For the pictures from now on.
  void place(std::span<const PlacedCollider> colliders);
  /// Which are none at first.
  void setLights(const LightCounts& lights);
  /// Of the body with its head at rest, or where its colliders are; empty without a body.
  const Box& bounds() const { return bounds_; }

  void drawDepth(const Pose& head, size_t light) const;  ///< from a light of SceneBlock::lights
  void drawBackground() const;
  void drawBody(const Pose& head) const;
  void drawGround() const;

 private:
  struct Vertex {
    float position[3], normal[3], head_weight;
  };

  void drawMesh(const gl::Program& program, const Pose& head) const;
  void bind();
  void findBounds(std::span<const Vertex> vertices);

  gl::Program background_, ground_, body_, depth_;
  gl::Buffer vertices_, indices_;
  GLuint empty_vertices_ = 0, mesh_ = 0;
  GLsizei index_count_ = 0;
  std::vector<Vertex> rest_;  ///< of the body as it was given
  std::vector<std::array<uint32_t, 3>> triangles_;
  std::vector<BodyPart> parts_;
  BodyBinding binding_;
  Box bounds_;
};

}  // namespace strandcast
