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

void ShadowMap::fit(SceneBlock& block, const Box& content) const {
  // In steps, and on a grid of texels, so that the maps do not swim while the hair moves.
  constexpr float kStep = 0.05f;  // m
  const float radius =
      content.isEmpty() ? kStep : kStep * std::ceil(0.5f * content.diagonal().norm() / kStep + 0.1f);
  const Vec3 toward_light = block.light.head<3>();
  const Eigen::Matrix4f turn = viewMatrix(toward_light, Vec3::Zero());
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  if (!content.isEmpty()) center = turn.topLeftCorner<3, 3>() * content.center();
  const float texel = 2 * radius / static_cast<float>(front_size_);
  center = (center / texel).array().floor().matrix() * texel;
  Eigen::Matrix4f view = turn;
  view.block<3, 1>(0, 3) = -center;
  Eigen::Matrix4f projection = Eigen::Matrix4f::Identity();
  projection(0, 0) = projection(1, 1) = 1 / radius;
  projection(2, 2) = -1 / radius;
  block.light_view_projection = projection * view;
  block.light.w() = 2 * radius;
  block.sampling.z() = static_cast<float>(layers_.map_size) / (2 * radius);
  const float depth = layers_.beyond == BeyondLayers::kReach ? 2 * radius : layers_.depth;
  const auto ends = layerEnds(layers_, depth);
  const float last = layers_.beyond == BeyondLayers::kLastLayer ? 1e9f : ends[layers_.layers - 1];
  for (int k = 0; k <= kMostOpacityLayers; ++k) {
    block.layer_ends[k] = ends[k];
    block.layer_limits[k] = k + 1 < layers_.layers ? ends[k] : last;
  }
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
