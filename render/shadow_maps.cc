#include "render/shadow_maps.h"

#include <algorithm>
#include <cmath>

namespace strandcast {
namespace {

void begin(const Framebuffer& target, int size) {
  glBindFramebuffer(GL_FRAMEBUFFER, target.id());
  glViewport(0, 0, size, size);
}

void beginDepth(const Framebuffer& target, int size) {
  begin(target, size);
  const float far_depth = 1;
  glClearNamedFramebufferfv(target.id(), GL_DEPTH, 0, &far_depth);
}

void setBorder(const Texture& texture, float value) {
  const float border[4] = {value, value, value, value};
  glTextureParameterfv(texture.id(), GL_TEXTURE_BORDER_COLOR, border);
}

/// The view of a light. Depth, the third row, is -1 to 1 before any division.
struct LightView {
  Eigen::Matrix4f projection;
  float range;     ///< m, depth range
  float width;     ///< m, width of the maps; 1 m from a light with a position
  float widest;    ///< m, largest width within their range
  float fade = 0;  ///< outer fraction of the maps over which shadows fade out
};

// Sizes are quantised, so that the maps do not swim while the hair moves.
constexpr float kLargestStep = 0.05f;  // m
constexpr float kWidestView = 1.3f;    // rad
constexpr float kNearest = 0.01f;      // m, times the scale: near plane of a light with a position, which
                                       // casts no shadow nearer
constexpr float kFade = 0.4f;          // of half a map that does not cover everything: its outer 10 degrees

LightView parallelView(const LightBlock& light, const Box& content, float scale, int texels) {
  const float step = kLargestStep * scale;
  const float radius =
      content.isEmpty() ? step : step * std::ceil(0.5f * content.diagonal().norm() / step + 0.1f);
  const Eigen::Matrix4f turn = viewMatrix(light.way.head<3>(), Vec3::Zero());
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  if (!content.isEmpty()) center = turn.topLeftCorner<3, 3>() * content.center();
  const float texel = 2 * radius / static_cast<float>(texels);  // the centre is snapped to a grid of texels
  center = (center / texel).array().floor().matrix() * texel;
  Eigen::Matrix4f view = turn;
  view.block<3, 1>(0, 3) = -center;
  Eigen::Matrix4f projection = Eigen::Matrix4f::Identity();
  projection(0, 0) = projection(1, 1) = 1 / radius;
  projection(2, 2) = -1 / radius;
  return {projection * view, 2 * radius, 2 * radius, 2 * radius};
}

/// `margin`: reach of look-ups beside the lit bounds, over the maps' width.
LightView perspectiveView(const LightBlock& light, const Box& content, float scale, float margin) {
  const float step = kLargestStep * scale, nearest = kNearest * scale;
  const Vec3 eye = light.place.head<3>(), axis = -light.way.head<3>();
  Vec3 center = Vec3(eye + axis);
  float radius = step;
  if (!content.isEmpty()) {
    center = Vec3((content.center() / step).array().round().matrix() * step);
    radius = step * std::ceil(0.5f * content.diagonal().norm() / step + 1);
  }
  const float distance = (center - eye).norm();
  float half = distance > radius ? std::min(std::asin(radius / distance), kWidestView) : kWidestView;
  Vec3 target = distance > 1e-3f ? center : Vec3(eye + axis);
  const float cone = std::acos(std::clamp(light.cone.y(), -1.0f, 1.0f));
  if (cone < half) {
    half = cone;
    target = Vec3(eye + axis);
  }
  const float fade = half < kWidestView ? 0 : kFade;
  const Vec3 looks = (target - eye).normalized();
  const float middle = (center - eye).dot(looks);
  const float near = std::max(middle - radius, nearest), far = std::max(middle + radius, near + step);
  const float slope = std::tan(half) * (1 + 2 * margin);
  Eigen::Matrix4f projection = Eigen::Matrix4f::Zero();
  projection(0, 0) = projection(1, 1) = 1 / slope;
  projection(2, 2) = -2 / (far - near);
  projection(2, 3) = -(far + near) / (far - near);
  projection(3, 2) = -1;
  return {projection * viewMatrix(eye, target), far - near, 2 * slope, 2 * slope * far, fade};
}

}  // namespace

ShadowMaps::ShadowMaps(const OpacityLayers& layers, size_t lights)
    : layers_(layers), front_size_(std::min(kFrontSize, layers.map_size)) {
  if (lights == 0) return;
  const int count = static_cast<int>(lights);
  solid_depth_ = Texture(GL_DEPTH_COMPONENT32F, kSolidSize, kSolidSize, GL_LINEAR, count);
  front_ = Texture(GL_DEPTH_COMPONENT32F, front_size_, front_size_, GL_LINEAR, count);
  opacity_ = Texture(GL_RGBA16F, layers.map_size, layers.map_size, GL_LINEAR, count * slices());
  for (int light = 0; light < count; ++light) {
    solid_targets_.push_back(Framebuffer::ofDepth(solid_depth_, light));
    front_targets_.push_back(Framebuffer::ofDepth(front_, light));
    opacity_targets_.push_back(Framebuffer::ofColors(opacity_, light * slices(), slices()));
  }
  setBorder(solid_depth_, 1);
  setBorder(front_, 1);
  setBorder(opacity_, 0);
  glTextureParameteri(solid_depth_.id(), GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTextureParameteri(solid_depth_.id(), GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
}

float ShadowMaps::fit(LightBlock& light, const Box& content, float scale) const {
  const LightView view = light.place.w() > 0 ? perspectiveView(light, content, scale, lookupRadius())
                                             : parallelView(light, content, scale, front_size_);
  light.view_projection = view.projection;
  light.way.w() = view.range;
  light.cone.z() = static_cast<float>(layers_.map_size) / view.width;
  light.cone.w() = view.fade;
  const float depth = layers_.beyond == BeyondLayers::kReach ? view.range : layers_.depth;
  const auto ends = layerEnds(layers_, depth);
  const float last = layers_.beyond == BeyondLayers::kLastLayer ? 1e9f : ends[layers_.layers - 1];
  for (int k = 0; k <= kMaxOpacityLayers; ++k) {
    light.layer_ends[k] = ends[k];
    light.layer_limits[k] = k + 1 < layers_.layers ? ends[k] : last;
  }
  return view.widest;
}

float ShadowMaps::lookupRadius() const {
  return 2.0f / static_cast<float>(front_size_) +
         static_cast<float>(layers_.filter + 2) / static_cast<float>(layers_.map_size);
}

void ShadowMaps::beginSolids(size_t light) const { beginDepth(solid_targets_[light], kSolidSize); }

void ShadowMaps::beginHairFront(size_t light) const { beginDepth(front_targets_[light], front_size_); }

void ShadowMaps::beginHairOpacity(size_t light) const {
  const Framebuffer& target = opacity_targets_[light];
  begin(target, layers_.map_size);
  const float none[4] = {0, 0, 0, 0};
  for (int slice = 0; slice < slices(); ++slice)
    glClearNamedFramebufferfv(target.id(), GL_COLOR, slice, none);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFunc(GL_ONE, GL_ONE);
  // The front is bound for reading; it is not the render target here.
  glBindTextureUnit(binding::kHairFront, front_.id());
  glBindTextureUnit(binding::kHairOpacity, 0);
}

void ShadowMaps::end() const {
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

size_t ShadowMaps::bytes() const {
  const auto square = [](int side) { return static_cast<size_t>(side) * static_cast<size_t>(side); };
  return lights() * (4 * square(kSolidSize) + 4 * square(front_size_) +
                     8 * square(layers_.map_size) * static_cast<size_t>(slices()));
}

void ShadowMaps::bindTextures() const {
  glBindTextureUnit(binding::kSolidDepth, solid_depth_.id());
  glBindTextureUnit(binding::kHairFront, front_.id());
  glBindTextureUnit(binding::kHairOpacity, opacity_.id());
}

}  // namespace strandcast
