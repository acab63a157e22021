#include "options/picture_options.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "core/error.h"
#include "options/number_range.h"
#include "options/presets.h"

namespace strandcast {
namespace {

std::string helpOf(const PictureSetting& setting) {
  return setting.info.unit.empty() ? setting.info.help
                                   : fmt::format("[{}] {}", setting.info.unit, setting.info.help);
}

std::string defaultOf(const PictureSetting& setting, const PictureOptions& options) {
  const std::vector<double> values = setting.get(options);
  return setting.choices.empty() ? fmt::format("{:g}", fmt::join(values, " "))
                                 : setting.choices[static_cast<size_t>(values[0])];
}

/// Runs `act` and converts its Error into CLI11's.
template <class Act>
void asOption(const Act& act) {
  try {
    act();
  } catch (const Error& error) {
    throw CLI::ValidationError(error.what());
  }
}

using Arguments = std::shared_ptr<PictureArguments>;

void addNumbers(CLI::Option_group& group, const PictureSetting& setting, const PictureOptions& options,
                const Arguments& arguments) {
  group
      .add_option_function<std::vector<double>>(
          "--" + setting.info.name,
          [arguments, &setting](const std::vector<double>& values) {
            asOption([&] { arguments->set(setting, values); });
          },
          helpOf(setting))
      ->expected(setting.info.components)
      ->check(inRange({setting.info.low, setting.info.high, setting.info.whole, setting.info.unit}))
      ->type_name(setting.info.whole ? "INT" : "NUMBER")
      ->default_str(defaultOf(setting, options))
      ->trigger_on_parse(setting.of_light);
}

void addChoice(CLI::Option_group& group, const PictureSetting& setting, const PictureOptions& options,
               const Arguments& arguments) {
  const auto set = [arguments, &setting](const std::string& word) {
    asOption([&] { arguments->set(setting, choiceNamed(setting, word, "--" + setting.info.name)); });
  };
  group.add_option_function<std::string>("--" + setting.info.name, set, helpOf(setting))
      ->check(CLI::IsMember(setting.choices))
      ->type_name("NAME")
      ->default_str(defaultOf(setting, options))
      ->trigger_on_parse(setting.of_light);
}

}  // namespace

void addPictureOptions(CLI::App& app, PictureOptions& options) {
  const std::map<std::string, std::string> kGroups{
      {"Picture", "size, sampling, level of detail and colours"},
      {"Camera", "direction and distance of the view"},
      {"Growth", "hairs grown from the guides"},
      {"Light", fmt::format("lights: each --light after the first adds one, {} at most; the options after a "
                            "--light apply to it",
                            kMaxLights)},
      {"Shadow", "deep opacity maps of the hair and a depth map of the body"},
      {"Marks", "overlays for debugging"}};
  const auto arguments = std::make_shared<PictureArguments>(options);
  app.add_option_function<std::string>(
         "--preset", [arguments](const std::string& file) { asOption([&] { arguments->readPreset(file); }); },
         "TOML file as the viewer saves it, of which the table [picture] is read; options override it")
      ->trigger_on_parse()
      ->type_name("FILE");
  CLI::Option_group* group = nullptr;
  std::string name;
  for (const PictureSetting& setting : pictureSettings()) {
    if (name != setting.group) group = app.add_option_group(setting.group, kGroups.at(setting.group));
    name = setting.group;
    if (setting.file != nullptr)
      group->add_option("--" + setting.info.name, options.*setting.file, setting.info.help)
          ->type_name("FILE");
    else if (setting.choices.empty())
      addNumbers(*group, setting, options, arguments);
    else
      addChoice(*group, setting, options, arguments);
  }
}

void PictureArguments::set(const PictureSetting& setting, const std::vector<double>& values) {
  if (!setting.of_light) {
    options_.given.emplace_back(setting.info.name, 0);
    return setPicture(options_, setting, values, "--" + setting.info.name);
  }
  given_.push_back({&setting, values});
  placeLights();
}

void PictureArguments::readPreset(const std::string& file) {
  options_.settings.lights = lights_;
  strandcast::readPreset(file, options_);
  lights_ = options_.settings.lights;
  placeLights();
}

void PictureArguments::placeLights() {
  options_.settings.lights = lights_;
  options_.light = 0;
  bool named = false;
  std::erase_if(options_.given, [](const auto& given) { return given.first.starts_with("light"); });
  for (const auto& [setting, values] : given_) {
    const std::string option = "--" + setting->info.name;
    if (setting->info.name == "light") {
      if (named)
        addLight(options_, option);
      else
        options_.settings.lights.resize(1);
      named = true;
    }
    setPicture(options_, *setting, values, option);
    options_.given.emplace_back(setting->info.name, options_.light);
  }
  options_.light = 0;
}

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
bool isNoRectangle(const O&, const Light& light) { return light.kind != LightKind::kRectangle; }
constexpr const char *kNoShadows = "--shadows is off", *kNoSpot = "the light is no spot",
                     *kNoRectangle = "the light is no rectangle";

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
    {"light-width", isNoRectangle, kNoRectangle},
    {"light-height", isNoRectangle, kNoRectangle},
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
