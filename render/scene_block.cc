#include "render/scene_block.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace strandcast {
namespace {

constexpr float kNear = 0.02f, kFar = 50;  // m

float inRange(float value, float low, float high, float fallback) {
  return std::isfinite(value) ? std::clamp(value, low, high) : fallback;
}

Eigen::Vector4f withW(const Vec3& v, float w) { return {v.x(), v.y(), v.z(), w}; }

LightBlock blockOf(const Light& light) {
  LightBlock block{};
  block.view_projection = Eigen::Matrix4f::Identity();
  const ConeCosines cone = coneCosines(light);
  block.way = withW(-light.direction, 1);
  block.place = withW(light.position, light.kind == LightKind::kDirectional ? 0.0f : 1.0f);
  block.cone = {cone.inner, cone.outer, 1, 0};
  block.power = withW(Vec3(light.intensity * light.color), 0);
  return block;
}

}  // namespace

SceneBlock makeSceneBlock(const RenderSettings& settings, const Camera& camera) {
  const float fov = inRange(camera.vertical_fov, 0.01f, 3.0f, 0.6f);
  const Vec3 eye = camera.eye.allFinite() ? camera.eye : Vec3(0, 0, 1);
  const Vec3 target = camera.target.allFinite() ? camera.target : Vec3(0, 0, 0);
  const float height = static_cast<float>(settings.height),
              aspect = static_cast<float>(settings.width) / height;
  SceneBlock block{};
  block.view_projection = perspective(fov, aspect, kNear, kFar) * viewMatrix(eye, target);
  block.eye = withW(eye, height / (2 * std::tan(0.5f * fov)));
  block.hair_color = withW(settings.hair_color, settings.hair_width);
  block.body_color = withW(settings.body_color, static_cast<float>(settings.width));
  block.background = withW(settings.background, height);
  block.ground = {0, 0, 0, 1};
  std::vector<Light> lights = settings.lights;
  std::ranges::stable_partition(lights, std::identity(), &Light::casts_shadow);
  std::ranges::transform(lights, block.lights, blockOf);
  block.sampling = {1, 1, 0, 0};
  block.opacity_slices = static_cast<float>((settings.opacity.layers + 1) / 4);
  block.alpha_to_coverage = settings.coverage == HairCoverage::kAlphaToCoverage ? 1.0f : 0.0f;
  block.opacity_filter = static_cast<float>(settings.opacity.filter);
  return block;
}

}  // namespace strandcast
