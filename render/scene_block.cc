#include "render/scene_block.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace strandcast {
namespace {

constexpr float kFarOverNear = 20000;                   // limit, for a depth buffer of 24 bits
constexpr float kNearestFar = 1e-4f, kFarthest = 1e7f;  // m

float clampedOr(float value, float low, float high, float fallback) {
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

Camera clipped(const Camera& camera) {
  Camera c = camera;
  c.vertical_fov = clampedOr(c.vertical_fov, 0.01f, 3.0f, 0.6f);
  if (!c.eye.allFinite()) c.eye = Vec3(0, 0, 1);
  if (!c.target.allFinite()) c.target = Vec3(0, 0, 0);
  if (!c.up.allFinite()) c.up = Vec3::UnitY();
  return c;
}

DepthRange depthRange(const Camera& camera, float aspect, std::span<const Box> boxes) {
  float nearest = std::numeric_limits<float>::infinity(), farthest = 0;
  for (const Box& box : boxes) {
    if (box.isEmpty()) continue;
    nearest = std::min(nearest, box.exteriorDistance(camera.eye));
    const Eigen::Vector3f off = (camera.eye - box.center()).cwiseAbs() + 0.5f * box.sizes();
    farthest = std::max(farthest, off.norm());
  }
  if (farthest == 0) return {};
  // The nearest point may be in a corner of the picture, where the distance along the view axis is smaller.
  const float slope = std::tan(0.5f * camera.vertical_fov);
  const float corner = 1 / std::sqrt(1 + slope * slope * (1 + aspect * aspect));
  const float far = clampedOr(1.05f * farthest, kNearestFar, kFarthest, kFarthest);
  return {clampedOr(0.5f * corner * nearest, far / kFarOverNear, 0.5f * far, far / kFarOverNear), far};
}

SceneBlock makeSceneBlock(const RenderSettings& settings, const Camera& wanted, const DepthRange& range) {
  const Camera camera = clipped(wanted);
  const float height = static_cast<float>(settings.height),
              aspect = static_cast<float>(settings.width) / height;
  SceneBlock block{};
  block.view_projection =
      perspective(camera.vertical_fov, aspect, range.near, range.far) * viewMatrix(camera);
  block.eye = withW(camera.eye, height / (2 * std::tan(0.5f * camera.vertical_fov)));
  block.hair_color = withW(settings.hair_color, settings.hair_width);
  block.body_color = withW(settings.body_color, static_cast<float>(settings.width));
  block.background = withW(settings.background, height);
  block.ground = {0, 0, 0, 1};
  std::vector<Light> lights = settings.lights;
  std::ranges::stable_partition(lights, std::identity(), &Light::casts_shadow);
  std::ranges::transform(lights, block.lights, blockOf);
  block.exposure = withW(exposureGains(settings), 0);
  block.sampling = {1, 1, 1, 0};
  block.opacity_slices = static_cast<float>((settings.opacity.layers + 1) / 4);
  block.alpha_to_coverage = settings.coverage == HairCoverage::kAlphaToCoverage ? 1.0f : 0.0f;
  block.opacity_filter = static_cast<float>(settings.opacity.filter);
  return block;
}

}  // namespace strandcast
