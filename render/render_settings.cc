#include "render/render_settings.h"

#include <algorithm>
#include <cmath>

namespace strandcast {

std::array<float, kMaxOpacityLayers + 1> layerEnds(const OpacityLayers& layers, float depth) {
  std::array<double, kMaxOpacityLayers + 1> ends{};
  double size = 1, next = 1, sum = 0;
  for (int k = 0; k < layers.layers; ++k) {
    ends[k] = sum += size;
    switch (layers.sizes) {
      case LayerSizes::kConstant:
        break;
      case LayerSizes::kLinear:
        size += 1;
        break;
      case LayerSizes::kPowerOfTwo:
        size *= 2;
        break;
      case LayerSizes::kFibonacci: {
        const double after = size + next;
        size = next;
        next = after;
        break;
      }
    }
  }
  std::array<float, kMaxOpacityLayers + 1> metres{};
  for (int k = 0; k <= kMaxOpacityLayers; ++k)
    metres[k] = k < layers.layers ? static_cast<float>(depth * ends[k] / sum) : metres[k - 1] + 1;
  return metres;
}

std::string lightDefines(const LightCounts& counts) {
  return "#define LIGHTS " + std::to_string(counts.lights) + "\n#define CASTERS " +
         std::to_string(counts.casters) + "\n";
}

Vec3 exposureGains(const RenderSettings& settings) {
  const Vec3& white = settings.white_balance;
  return std::exp2(settings.exposure) * Vec3(white.y() / white.x(), 1, white.y() / white.z());
}

namespace {

float inRange(float value, float low, float high, float fallback) {
  return std::isfinite(value) ? std::clamp(value, low, high) : fallback;
}

Vec3 color(const Vec3& value, const Vec3& fallback) {
  return value.allFinite() ? Vec3(value.cwiseMax(0.0f).cwiseMin(1.0f)) : fallback;
}

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

/// Rounds the number of layers down to a supported one.
OpacityLayers clipped(const OpacityLayers& layers) {
  const OpacityLayers fallback;
  OpacityLayers o = layers;
  o.layers = (std::clamp(o.layers, 3, kMaxOpacityLayers) + 1) / 4 * 4 - 1;
  o.depth = inRange(o.depth, 1e-4f, 1e3f, fallback.depth);
  o.map_size = std::clamp(o.map_size, 16, 8192);
  o.filter = std::clamp(o.filter, 0, 4);
  return o;
}

/// Normalises the direction.
Light clipped(const Light& light) {
  const Light fallback;
  Light l = light;
  const float length = l.direction.norm();
  const bool directed = std::isfinite(length) && length > 1e-6f;
  l.direction = directed ? Vec3(l.direction / length) : Vec3(fallback.direction.normalized());
  for (int i = 0; i < 3; ++i) l.position[i] = inRange(l.position[i], -1000, 1000, fallback.position[i]);
  l.color = color(l.color, fallback.color);
  l.intensity = inRange(l.intensity, 0, 1e4f, fallback.intensity);
  l.cone = inRange(l.cone, 0.01f, 1.5f, fallback.cone);
  l.cone_edge = inRange(l.cone_edge, 0, 1, fallback.cone_edge);
  l.width = inRange(l.width, 1e-3f, 100, fallback.width);
  l.height = inRange(l.height, 1e-3f, 100, fallback.height);
  return l;
}

}  // namespace

const char* nameOf(RenderPass pass) {
  constexpr const char* kNames[] = {"guides", "growth", "solid-shadow", "hair-shadow", "background",
                                    "body",   "ground", "hair",         "marks",       "resolve"};
  return kNames[static_cast<size_t>(pass)];
}

std::vector<RenderPass> allPasses() {
  std::vector<RenderPass> passes;
  for (int i = 0; i <= static_cast<int>(kLastPass); ++i) passes.push_back(static_cast<RenderPass>(i));
  return passes;
}

LightCounts countsOf(const RenderSettings& settings) {
  const auto casters = std::ranges::count(settings.lights, true, &Light::casts_shadow);
  return {settings.lights.size(), settings.shadows ? static_cast<size_t>(casters) : 0};
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
  s.detail.hysteresis = inRange(s.detail.hysteresis, 0, 1, fallback.detail.hysteresis);
  s.detail.longest_segment = inRange(s.detail.longest_segment, 0, 1e4f, fallback.detail.longest_segment);
  s.clearance = inRange(s.clearance, 0, 0.1f, fallback.clearance);
  s.hair_width = inRange(s.hair_width, 1e-7f, 0.1f, fallback.hair_width);
  s.hair_color = color(s.hair_color, fallback.hair_color);
  s.body_color = color(s.body_color, fallback.body_color);
  s.background = color(s.background, fallback.background);
  s.exposure = inRange(s.exposure, -20, 20, fallback.exposure);
  s.white_balance = color(s.white_balance, fallback.white_balance).cwiseMax(0.01f);
  std::vector<RenderPass> passes;
  for (const RenderPass pass : s.passes)
    if (pass <= kLastPass && std::find(passes.begin(), passes.end(), pass) == passes.end())
      passes.push_back(pass);
  s.passes = std::move(passes);
  if (s.lights.size() > kMaxLights) s.lights.resize(kMaxLights);
  for (Light& light : s.lights) light = clipped(light);
  return s;
}

}  // namespace strandcast
