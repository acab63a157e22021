#include "apps/unused_picture_options.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace strandcast {
namespace {

// An option `name` that has no effect where `is_unused`. A setting of lights is tested with its own light.
struct UnusedOption {
  const char* name;
  bool (*is_unused)(const PictureOptions&, const Light&);
  const char* reason;
};

using O = PictureOptions;
bool hasNoShadows(const O& o, const Light&) { return !o.settings.shadows; }
bool isNoSpot(const O&, const Light& light) { return light.kind != LightKind::kSpot; }
bool isTessellated(const O& o, const Light&) { return o.settings.growth_path == GrowthPath::kTessellator; }
constexpr const char *kNoShadows = "--shadows is off", *kNoSpot = "the light is no spot";

// clang-format off
constexpr UnusedOption kRules[] = {
    {"filter", [](const O& o, const Light&) { return o.settings.supersampling == 1; },
     "--supersampling is 1"},
    {"geometry", isTessellated, "--growth tessellator draws lines"},
    {"mark-inside", isTessellated, "it needs --growth compute"},
    {"clump", [](const O& o, const Light&) { return o.settings.growth.interpolation != Interpolation::kCombined; },
     "it needs --interpolation combined"},
    {"curl-pitch", [](const O& o, const Light&) { return o.settings.growth.curl_radius == 0; },
     "--curl-radius is 0"},
    {"curl-strand", [](const O& o, const Light&) { return o.curl_example.empty(); },
     "there is no --curl-example"},
    {"clearance", [](const O& o, const Light&) { return !o.settings.keep_out; }, "--keep-out is off"},
    {"light-direction", [](const O&, const Light& light) { return light.kind == LightKind::kPoint; },
     "a point light shines in all directions"},
    {"light-position", [](const O&, const Light& light) { return light.kind == LightKind::kDirectional; },
     "a directional light is infinitely far away"},
    {"light-cone", isNoSpot, kNoSpot},
    {"light-edge", isNoSpot, kNoSpot},
    {"light-shadow", hasNoShadows, kNoShadows},
    {"shadow-layers", hasNoShadows, kNoShadows},
    {"layer-sizes", hasNoShadows, kNoShadows},
    {"beyond-layers", hasNoShadows, kNoShadows},
    {"shadow-depth", hasNoShadows, kNoShadows},
    {"shadow-map", hasNoShadows, kNoShadows},
    {"shadow-filter", hasNoShadows, kNoShadows},
    {"shadow-depth", [](const O& o, const Light&) { return o.settings.opacity.beyond == BeyondLayers::kReach; },
     "--beyond-layers reach extends to the back of the hair"},
};
// clang-format on

}  // namespace

std::vector<std::string> unusedPictureOptions(const PictureOptions& options) {
  std::vector<std::string> lines;
  for (const auto& [name, light] : options.given)
    for (const UnusedOption& rule : kRules)
      if (name == rule.name && rule.is_unused(options, options.settings.lights.at(light)))
        lines.push_back(fmt::format("--{} is not used: {}", name, rule.reason));
  return lines;
}

void warnOfUnusedPictureOptions(const PictureOptions& options) {
  for (const std::string& line : unusedPictureOptions(options)) spdlog::warn("{}", line);
}

}  // namespace strandcast
