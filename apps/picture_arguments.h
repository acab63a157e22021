#pragma once
#include <string>
#include <vector>

#include "apps/picture_settings.h"

namespace strandcast {

/// Applies a command line's picture options in their order. Options of lights apply to the light named last.
/// The first "light" sets the kind of the first light, which is then the only one; each further one adds a
/// light. Options of lights override a preset regardless of their order.
class PictureArguments {
 public:
  explicit PictureArguments(PictureOptions& options) : options_(options), lights_(options.settings.lights) {}

  /// Throws Error on values out of range and on too many lights.
  void set(const PictureSetting& setting, const std::vector<double>& values);
  /// Throws Error where the file cannot be read.
  void readPreset(const std::string& file);

 private:
  void placeLights();

  struct Given {
    const PictureSetting* setting;
    std::vector<double> values;
  };
  PictureOptions& options_;
  std::vector<Light> lights_;  // before the options of lights
  std::vector<Given> given_;   // options of lights
};

}  // namespace strandcast
