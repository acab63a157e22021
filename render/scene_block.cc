#include "render/scene_block.h"

#include <algorithm>
#include <cmath>

namespace strandcast {
namespace {

constexpr float kNear = 0.02f, kFar = 50;  // m

float inRange(float value, float low, float high, float fallback) {
  return std::isfinite(value) ? std::clamp(value, low, high) : fallback;
}

Vec3 color(const Vec3& value, const Vec3& fallback) {
  return value.allFinite() ? Vec3(value.cwiseMax(0.0f).cwiseMin(1.0f)) : fallback;
}

Eigen::Vector4f withW(const Vec3& v, float w) { return {v.x(), v.y(), v.z(), w}; }

HairGrowth clipped(const HairGrowth& growth) {
  const HairGrowth fallback;
  HairGrowth g = growth;
  g.hairs = std::min<size_t>(g.hairs, 4000000);
  for (int i = 0; i < 3; ++i) g.lock_profile[i] = inRange(g.lock_profile[i], 0, 10, fallback.lock_profile[i]);
  const auto clip = [&](float HairGrowth::*value, float low, float high) {
    g.*value = inRange(g.*value, low, high, fallback.*value);
  };
  clip(&HairGrowth::clump_radius, 0, 1);
  clip(&HairGrowth::tip_deviation, 0, 1);
  clip(&HairGrowth::whole_deviation, 0, 1);
  clip(&HairGrowth::curl_radius, 0, 1);
  clip(&HairGrowth::curl_pitch, 1e-3f, 100);
  clip(&HairGrowth::single_strand_part, 0, 1);
  clip(&HairGrowth::clump, 0, 1);
  clip(&HairGrowth::tip_deviation_part, 0, 1);
  clip(&HairGrowth::whole_deviation_part, 0, 1);
  return g;
}

/// The number of layers falls to the next that there is.
OpacityLayers clipped(const OpacityLayers& layers) {
  const OpacityLayers fallback;
  OpacityLayers o = layers;
  o.layers = (std::clamp(o.layers, 3, kMostOpacityLayers) + 1) / 4 * 4 - 1;
  o.depth = inRange(o.depth, 1e-4f, 1e3f, fallback.depth);
  o.map_size = std::clamp(o.map_size, 16, 8192);
  o.filter = std::clamp(o.filter, 0, 4);
  return o;
}

}  // namespace

RenderSettings softwareSettings() {
  RenderSettings settings;
  settings.width = 960;
  settings.height = 540;
  settings.growth.hairs = 12000;
  settings.segments = 20;
  settings.hair_width = 220e-6f;
  return settings;
}

RenderSettings clipped(const RenderSettings& settings) {
  const RenderSettings fallback;
  RenderSettings s = settings;
  s.width = std::clamp(s.width, 16, 16384);
  s.height = std::clamp(s.height, 16, 16384);
  s.samples = std::clamp(s.samples, 1, 8);
  s.supersampling = std::clamp(s.supersampling, 1, 4);
  s.segments = std::clamp(s.segments, 1, 256);
  s.growth = clipped(s.growth);
  s.opacity = clipped(s.opacity);
  s.detail.part = inRange(s.detail.part, 0, 1, fallback.detail.part);
  s.detail.finest_hair = inRange(s.detail.finest_hair, 0, 100, fallback.detail.finest_hair);
  s.detail.longest_segment = inRange(s.detail.longest_segment, 0, 1e4f, fallback.detail.longest_segment);
  s.clearance = inRange(s.clearance, 0, 0.1f, fallback.clearance);
  s.hair_width = inRange(s.hair_width, 1e-7f, 0.1f, fallback.hair_width);
  s.hair_color = color(s.hair_color, fallback.hair_color);
  s.body_color = color(s.body_color, fallback.body_color);
  s.background = color(s.background, fallback.background);
  const float length = s.light_direction.norm();
  const bool directed = std::isfinite(length) && length > 1e-6f;
  s.light_direction =
      directed ? Vec3(s.light_direction / length) : Vec3(fallback.light_direction.normalized());
  return s;
}

SceneBlock makeSceneBlock(const RenderSettings& settings, const Camera& camera) {
  const float fov = inRange(camera.vertical_fov, 0.01f, 3.0f, 0.6f);
  const Vec3 eye = camera.eye.allFinite() ? camera.eye : Vec3(0, 0, 1);
  const Vec3 target = camera.target.allFinite() ? camera.target : Vec3(0, 0, 0);
  const float height = static_cast<float>(settings.height),
              aspect = static_cast<float>(settings.width) / height;
  SceneBlock block{};
  block.view_projection = perspective(fov, aspect, kNear, kFar) * viewMatrix(eye, target);
  block.light_view_projection = Eigen::Matrix4f::Identity();
  block.eye = withW(eye, height / (2 * std::tan(0.5f * fov)));
  block.light = withW(-settings.light_direction, 1);
  block.hair_color = withW(settings.hair_color, settings.hair_width);
  block.body_color = withW(settings.body_color, static_cast<float>(settings.width));
  block.background = withW(settings.background, height);
  block.ground = {0, 0, 0, 1};
  block.sampling = {1, 1, 1, settings.shadows ? 1.0f : 0.0f};
  block.opacity_slices = static_cast<float>((settings.opacity.layers + 1) / 4);
  block.alpha_to_coverage = settings.coverage == HairCoverage::kAlphaToCoverage ? 1.0f : 0.0f;
  block.opacity_filter = static_cast<float>(settings.opacity.filter);
  return block;
}

}  // namespace strandcast
