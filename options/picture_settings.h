#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/parameters.h"
#include "render/render_settings.h"

namespace strandcast {

/// Picture settings shared by `render`, `compare` and `view`: appearance and camera.
struct PictureOptions {
  RenderSettings settings;             ///< with at least one light
  size_t light = 0;                    ///< index of the light that settings of lights apply to
  double azimuth = 25, elevation = 5;  ///< degrees, see orbit()
  double zoom = 1;
  std::filesystem::path density_map, thickness_map, importance_map;  ///< empty = none
  std::filesystem::path curl_example;                                ///< a groom file; empty = none
  size_t curl_strand = 0;                                            ///< index in curl_example

  /// Settings given by options, not by presets: name ("light-cone") and, for settings of lights, the light's
  /// index.
  std::vector<std::pair<std::string, size_t>> given;
};

/// One picture setting, as options, presets and the viewer's panel use it. Its values are numbers, the index
/// of a choice, or a file.
struct PictureSetting {
  ParameterInfo info;  ///< "hair-width" is the option --hair-width; for a file only name and help are used
  std::string group;
  std::vector<std::string> choices{};  ///< names of the values 0, 1, ...
  std::function<std::vector<double>(const PictureOptions&)> get{};
  std::function<void(PictureOptions&, const std::vector<double>&)> set{};  ///< does not check the values
  std::filesystem::path PictureOptions::*file = nullptr;
  bool of_light = false;      ///< "light" is its kind, others start with "light-"
  bool is_direction = false;  ///< a direction of any length but 0
};
/// All settings; those of a group are contiguous.
const std::vector<PictureSetting>& pictureSettings();
/// Finds a setting. Throws Error, naming `where`, on an unknown name, with the nearest known one.
const PictureSetting& pictureSetting(const std::string& name, const std::string& where);

/// Throws Error, naming `where`, on a wrong number of values or a value out of range.
void setPicture(PictureOptions& options, const PictureSetting& setting, const std::vector<double>& values,
                const std::string& where);
/// The index of a named choice as a value. Throws Error, naming `where`, on an unknown one.
std::vector<double> choiceNamed(const PictureSetting& setting, const std::string& choice,
                                const std::string& where);

/// Adds a default light and selects it. Throws Error, naming `where`, beyond kMaxLights.
void addLight(PictureOptions& options, const std::string& where);

/// The settings with the maps that the options name loaded. Throws Error where one cannot be read.
RenderSettings renderSettings(const PictureOptions& options);

}  // namespace strandcast
