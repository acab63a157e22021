#include "render/shadow_map.h"

#include <algorithm>
#include <cmath>

namespace strandcast {
namespace {

void begin(const Framebuffer& target, int size) {
  glBindFramebuffer(GL_FRAMEBUFFER, target.id());
  glViewport(0, 0, size, size);
}

void setBorder(const Texture& texture, float value) {
  const float border[4] = {value, value, value, value};
  glTextureParameterfv(texture.id(), GL_TEXTURE_BORDER_COLOR, border);
}

/// What the light sees. Depth, the third row, is -1 to 1 before any division.
struct LightView {
  Eigen::Matrix4f projection;
  float range;   ///< m, of depth
  float width;   ///< m, of the maps; of a light with a place 1 m from it
  float widest;  ///< m, in their range
};

// In steps, so that the maps do not swim while the hair moves.
constexpr float kStep = 0.05f;       // m
constexpr float kWidestView = 1.3f;  // rad
constexpr float kNearest = 0.01f;    // m, in which a light with a place casts no shadow

LightView parallelView(const SceneBlock& block, const Box& content, int texels) {
  const float radius =
      content.isEmpty() ? kStep : kStep * std::ceil(0.5f * content.diagonal().norm() / kStep + 0.1f);
  const Eigen::Matrix4f turn = viewMatrix(block.light.head<3>(), Vec3::Zero());
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  if (!content.isEmpty()) center = turn.topLeftCorner<3, 3>() * content.center();
  const float texel = 2 * radius / static_cast<float>(texels);  // on a grid of which they lie
  center = (center / texel).array().floor().matrix() * texel;
  Eigen::Matrix4f view = turn;
  view.block<3, 1>(0, 3) = -center;
  Eigen::Matrix4f projection = Eigen::Matrix4f::Identity();
  projection(0, 0) = projection(1, 1) = 1 / radius;
  projection(2, 2) = -1 / radius;
  return {projection * view, 2 * radius, 2 * radius, 2 * radius};
}

/// `margin`: how far look-ups reach beside what is lit, over the maps' width.
LightView perspectiveView(const SceneBlock& block, const Box& content, float margin) {
  const Vec3 eye = block.light_place.head<3>(), axis = -block.light.head<3>();
  Vec3 center = Vec3(eye + axis);
  float radius = kStep;
  if (!content.isEmpty()) {
    center = Vec3((content.center() / kStep).array().round().matrix() * kStep);
    radius = kStep * std::ceil(0.5f * content.diagonal().norm() / kStep + 1);
  }
  const float distance = (center - eye).norm();
  float half = distance > radius ? std::min(std::asin(radius / distance), kWidestView) : kWidestView;
  Vec3 target = distance > 1e-3f ? center : Vec3(eye + axis);
  const float cone = std::acos(std::clamp(block.light_cone.y(), -1.0f, 1.0f));
  if (cone < half) {
    half = cone;
    target = Vec3(eye + axis);
  }
  const Vec3 looks = (target - eye).normalized();
  const float middle = (center - eye).dot(looks);
  const float near = std::max(middle - radius, kNearest), far = std::max(middle + radius, near + kStep);
  const float slope = std::tan(half) * (1 + 2 * margin);
  Eigen::Matrix4f projection = Eigen::Matrix4f::Zero();
  projection(0, 0) = projection(1, 1) = 1 / slope;
  projection(2, 2) = -2 / (far - near);
  projection(2, 3) = -(far + near) / (far - near);
  projection(3, 2) = -1;
  return {projection * viewMatrix(eye, target), far - near, 2 * slope, 2 * slope * far};
}

}  // namespace

ShadowMap::ShadowMap(const OpacityLayers& layers)
    : layers_(layers),
      solid_depth_(GL_DEPTH_COMPONENT32F, kSolidSize, kSolidSize, GL_LINEAR),
      front_size_(std::min(kFrontSize, layers.map_size)),
      front_(GL_DEPTH_COMPONENT32F, front_size_, front_size_, GL_LINEAR),
      opacity_(GL_RGBA16F, layers.map_size, layers.map_size, GL_LINEAR, (layers.layers + 1) / 4),
      solid_target_(nullptr, &solid_depth_),
      front_target_(nullptr, &front_),
      opacity_target_(opacity_) {
  setBorder(solid_depth_, 1);
  setBorder(front_, 1);
  setBorder(opacity_, 0);
  glTextureParameteri(solid_depth_.id(), GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTextureParameteri(solid_depth_.id(), GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
}

float ShadowMap::fit(SceneBlock& block, const Box& content) const {
  const LightView view = block.light_place.w() > 0 ? perspectiveView(block, content, lookUpReach())
                                                   : parallelView(block, content, front_size_);
  block.light_view_projection = view.projection;
  block.light.w() = view.range;
  block.sampling.z() = static_cast<float>(layers_.map_size) / view.width;
  const float depth = layers_.beyond == BeyondLayers::kReach ? view.range : layers_.depth;
  const auto ends = layerEnds(layers_, depth);
  const float last = layers_.beyond == BeyondLayers::kLastLayer ? 1e9f : ends[layers_.layers - 1];
  for (int k = 0; k <= kMostOpacityLayers; ++k) {
    block.layer_ends[k] = ends[k];
    block.layer_limits[k] = k + 1 < layers_.layers ? ends[k] : last;
  }
  return view.widest;
}

float ShadowMap::lookUpReach() const {
  return 2.0f / static_cast<float>(front_size_) +
         static_cast<float>(layers_.filter + 2) / static_cast<float>(layers_.map_size);
}

void ShadowMap::beginSolids() const {
  begin(solid_target_, kSolidSize);
  const float far_depth = 1;
  glClearNamedFramebufferfv(solid_target_.id(), GL_DEPTH, 0, &far_depth);
}

void ShadowMap::beginHairFront() const {
  begin(front_target_, front_size_);
  const float far_depth = 1;
  glClearNamedFramebufferfv(front_target_.id(), GL_DEPTH, 0, &far_depth);
}

void ShadowMap::beginHairOpacity() const {
  begin(opacity_target_, layers_.map_size);
  const float none[4] = {0, 0, 0, 0};
  for (int slice = 0; slice < (layers_.layers + 1) / 4; ++slice)
    glClearNamedFramebufferfv(opacity_target_.id(), GL_COLOR, slice, none);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFunc(GL_ONE, GL_ONE);
  // The front is read, what is drawn is not.
  glBindTextureUnit(binding::kHairFront, front_.id());
  glBindTextureUnit(binding::kHairOpacity, 0);
}

void ShadowMap::end() const {
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

size_t ShadowMap::bytes() const {
  const auto square = [](size_t side) { return side * side; };
  return 4 * square(kSolidSize) + 4 * square(static_cast<size_t>(front_size_)) +
         8 * square(static_cast<size_t>(layers_.map_size)) * static_cast<size_t>((layers_.layers + 1) / 4);
}

void ShadowMap::bindTextures() const {
  glBindTextureUnit(binding::kSolidDepth, solid_depth_.id());
  glBindTextureUnit(binding::kHairFront, front_.id());
  glBindTextureUnit(binding::kHairOpacity, opacity_.id());
}

}  // namespace strandcast
