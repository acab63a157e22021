// Options of pictures on the command line, and which of them have no effect beside others.
#pragma once
#include <string>
#include <vector>

#include "options/picture_settings.h"

namespace CLI {
class App;
}

namespace strandcast {

/// Adds every picture setting as an option with help, and --preset.
void addPictureOptions(CLI::App& app, PictureOptions& options);

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

/// A line for each picture option without effect beside the others, by the table in
/// picture_options.cc:
/// "--light-cone is not used: the light is no spot".
std::vector<std::string> unusedPictureOptions(const PictureOptions& options);
/// Logs these lines.
void warnOfUnusedPictureOptions(const PictureOptions& options);

}  // namespace strandcast
