#include "render/shadow_map.h"

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

ShadowMap::ShadowMap()
    : solid_depth_(GL_DEPTH_COMPONENT32F, kSolidSize, kSolidSize, GL_LINEAR),
      front_(GL_DEPTH_COMPONENT32F, kFrontSize, kFrontSize, GL_LINEAR),
      opacity_(GL_RGBA16F, kOpacitySize, kOpacitySize, GL_LINEAR),
      solid_target_(nullptr, &solid_depth_),
      front_target_(nullptr, &front_),
      opacity_target_(&opacity_, nullptr) {
  setBorder(solid_depth_, 1);
  setBorder(front_, 1);
  setBorder(opacity_, 0);
  glTextureParameteri(solid_depth_.id(), GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTextureParameteri(solid_depth_.id(), GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
}

void ShadowMap::fit(SceneBlock& block, const Box& content) {
  // In steps, and on a grid of texels, so that the maps do not swim while the hair moves.
  constexpr float kStep = 0.05f;  // m
  const float radius =
      content.isEmpty() ? kStep : kStep * std::ceil(0.5f * content.diagonal().norm() / kStep + 0.1f);
  const Vec3 toward_light = block.light.head<3>();
  const Eigen::Matrix4f turn = viewMatrix(toward_light, Vec3::Zero());
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  if (!content.isEmpty()) center = turn.topLeftCorner<3, 3>() * content.center();
  const float texel = 2 * radius / kFrontSize;
  center = (center / texel).array().floor().matrix() * texel;
  Eigen::Matrix4f view = turn;
  view.block<3, 1>(0, 3) = -center;
  Eigen::Matrix4f projection = Eigen::Matrix4f::Identity();
  projection(0, 0) = projection(1, 1) = 1 / radius;
  projection(2, 2) = -1 / radius;
  block.light_view_projection = projection * view;
  block.light.w() = 2 * radius;
  block.sampling.z() = kOpacitySize / (2 * radius);
}

void ShadowMap::beginSolids() const {
  begin(solid_target_, kSolidSize);
  const float far_depth = 1;
  glClearNamedFramebufferfv(solid_target_.id(), GL_DEPTH, 0, &far_depth);
}

void ShadowMap::beginHairFront() const {
  begin(front_target_, kFrontSize);
  const float far_depth = 1;
  glClearNamedFramebufferfv(front_target_.id(), GL_DEPTH, 0, &far_depth);
}

void ShadowMap::beginHairOpacity() const {
  begin(opacity_target_, kOpacitySize);
  const float none[4] = {0, 0, 0, 0};
  glClearNamedFramebufferfv(opacity_target_.id(), GL_COLOR, 0, none);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFunc(GL_ONE, GL_ONE);
  bindTextures();
}

void ShadowMap::end() const {
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

void ShadowMap::bindTextures() const {
  glBindTextureUnit(binding::kSolidDepth, solid_depth_.id());
  glBindTextureUnit(binding::kHairFront, front_.id());
  glBindTextureUnit(binding::kHairOpacity, opacity_.id());
}

}  // namespace strandcast
