#include "apps/picture_arguments.h"

#include "apps/presets.h"

namespace strandcast {

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

}  // namespace strandcast
