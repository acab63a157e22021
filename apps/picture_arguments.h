#pragma once
#include <string>
#include <vector>

#include "apps/picture_settings.h"

namespace strandcast {

/// What a command line says of a picture, in its order. Settings of lights are of the light that was named
/// last: the first "light" is the kind of the first light, which is then the only one, and each one after it
/// adds another. They win over a preset wherever it stands.
class PictureArguments {
 public:
  explicit PictureArguments(PictureOptions& options) : options_(options), lights_(options.settings.lights) {}

  /// Error on values out of range and on too many lights.
  void set(const PictureSetting& setting, const std::vector<double>& values);
  /// Error where the file cannot be read.
  void readPreset(const std::string& file);

 private:
  void placeLights();

  struct Given {
    const PictureSetting* setting;
    std::vector<double> values;
  };
  PictureOptions& options_;
  std::vector<Light> lights_;  // but for what was given
  std::vector<Given> given_;   // of lights
};

}  // namespace strandcast
