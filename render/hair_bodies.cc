#include "render/hair_bodies.h"

#include <string>

#include "core/error.h"
#include "render/scene_block.h"
#include "render/shaders.h"

namespace strandcast {
namespace {

constexpr size_t kBodyGroupSize = 64;  // must equal local_size_x of hair_bodies.comp
constexpr float kMaxStretch = 1e6f;    // largest stretch of a valid bend; a larger one counts as damaged

}  // namespace

std::vector<BodyPart> bodyParts(std::span<const HairObstacle> obstacles) {
  std::vector<BodyPart> parts;
  for (const HairObstacle& obstacle : obstacles)
    if (obstacle.canBend() && isBodyPart(obstacle.shape))
      parts.push_back({obstacle.collider, obstacle.shape.field});
  return parts;
}

HairBodies::HairBodies() : program_("hair bodies", {{GL_COMPUTE_SHADER, shaders::kHairBodiesComp}}) {
  hair_buffer_ = gl::Buffer(0, nullptr, 0);
  setObstacles({});
}

void HairBodies::setObstacles(std::vector<HairObstacle> obstacles) {
  for (size_t i = 0; i < obstacles.size(); ++i)
    checkPrimitive(obstacles[i].shape, "obstacle " + std::to_string(i) + " of the hair");
  ++revision_;
  obstacles_ = std::move(obstacles);
  at_rest_ = obstacles_;
  shapes_.clear();
  first_words_.clear();
  bend_words_.clear();
  for (const HairObstacle& obstacle : obstacles_) {
    first_words_.push_back(shapes_.add(obstacle.shape));
    bend_words_.push_back(obstacle.canBend() ? shapes_.addBend() : 0);
  }
  word_buffer_ = gl::Buffer(std::span<const uint32_t>(shapes_.words));
  body_buffer_ = gl::Buffer(obstacles_.size() * sizeof(MovingPrimitive), nullptr, GL_DYNAMIC_STORAGE_BIT);
  place(Pose{});
}

void HairBodies::place(const Pose& head, std::span<const PlacedCollider> colliders) {
  head_ = head;
  for (HairObstacle& obstacle : obstacles_) {
    for (const PlacedCollider& collider : colliders) {
      if (collider.id != obstacle.collider || obstacle.follows_head) continue;
      obstacle.pose = collider.pose;
      obstacle.bend = collider.bend;
    }
  }
  write(head, obstacles_, false);
}

bool HairBodies::holdsHair(size_t i) const {
  const HairObstacle& rest = at_rest_[i];
  const Pose& now = obstacles_[i].pose;
  return rest.follows_head || (rest.canBend() && isBodyPart(rest.shape)) ||
         (now.position == rest.pose.position && now.rotation.coeffs() == rest.pose.rotation.coeffs());
}

void HairBodies::placeAgain() { write(head_, obstacles_, false); }

size_t HairBodies::placeAtRest() { return write(Pose{}, at_rest_, true); }

/// Returns the number of bodies. `only_holding`: those alone that hair may be in at rest.
size_t HairBodies::write(const Pose& head, std::span<const HairObstacle> obstacles, bool only_holding) {
  std::vector<MovingPrimitive> placed;
  for (size_t i = 0; i < obstacles.size(); ++i) {
    const HairObstacle& obstacle = obstacles[i];
    if (only_holding && !holdsHair(i)) continue;
    const Pose pose = obstacle.follows_head ? head : obstacle.pose;
    placed.push_back(moved(obstacle.shape, pose, pose, 1, first_words_[i]));
    if (bend_words_[i] == 0) continue;
    const MovingBend bend = bendOf(obstacle.shape, obstacle.bend, obstacle.bend);
    if (!(bend.stretch < kMaxStretch)) continue;
    applyBend(placed.back(), bend, bend_words_[i]);
    word_buffer_.write(std::span<const MovingBend>(&bend, 1), bend_words_[i] * sizeof(uint32_t));
  }
  if (!placed.empty()) body_buffer_.write(std::span<const MovingPrimitive>(placed));
  return placed.size();
}

void HairBodies::computeClosing(size_t hairs, int segments) {
  const size_t bytes = hairs * static_cast<size_t>(segments + 2) * sizeof(float);
  GLint64 largest = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &largest);
  if (bytes > static_cast<size_t>(largest))
    throw Error("too much hair to keep it out of bodies",
                std::to_string(hairs) + " hairs of " + std::to_string(segments) +
                    " segments need a buffer of " + std::to_string(bytes) + " bytes, the device allows " +
                    std::to_string(largest),
                "grow fewer hairs or segments, or let hair go into bodies");
  if (bytes > hair_buffer_.bytes()) hair_buffer_ = gl::Buffer(bytes, nullptr, 0);
  bind();
  program_.set("hair_count", static_cast<unsigned>(hairs));
  program_.use();
  glDispatchCompute(static_cast<GLuint>((hairs + kBodyGroupSize - 1) / kBodyGroupSize), 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void HairBodies::bind() const {
  body_buffer_.bindStorage(binding::kBodies);
  word_buffer_.bindStorage(binding::kBodyWords);
  hair_buffer_.bindStorage(binding::kHairBodies);
}

size_t HairBodies::bytes() const {
  return body_buffer_.bytes() + word_buffer_.bytes() + hair_buffer_.bytes();
}

}  // namespace strandcast
