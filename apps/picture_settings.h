#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/parameters.h"
#include "render/render_settings.h"

namespace strandcast {

/// What `render`, `compare` and `view` have in common: how the picture looks and from where.
struct PictureOptions {
  RenderSettings settings;             ///< with one light or more
  size_t light = 0;                    ///< the one that settings of lights are of
  double azimuth = 25, elevation = 5;  ///< degrees, see orbit()
  double zoom = 1;
  std::filesystem::path density_map, thickness_map, importance_map;  ///< empty = none
  std::filesystem::path curl_example;                                ///< a groom file; empty = none
  size_t curl_strand = 0;                                            ///< of it

  /// Settings that options gave, not presets, by name ("light-cone"); of lights the light's number too.
  std::vector<std::pair<std::string, size_t>> given;
};

/// One setting of a picture, as options, presets and the viewer's panel know it. Its values are numbers, or
/// the index of a choice, or a file.
struct PictureSetting {
  ParameterInfo info;  ///< "hair-width" is the option --hair-width; of a file only name and help count
  std::string group;
  std::vector<std::string> choices{};  ///< names of the values 0, 1, ...
  std::function<std::vector<double>(const PictureOptions&)> get{};
  std::function<void(PictureOptions&, const std::vector<double>&)> set{};  ///< unchecked
  std::filesystem::path PictureOptions::*file = nullptr;
  bool of_light = false;  ///< "light" is its kind, others have "light-" in front
  bool is_way = false;    ///< of any length but 0
};
/// Settings of a group follow each other.
const std::vector<PictureSetting>& pictureSettings();
/// Error, naming `where`, on an unknown name, with the nearest known one.
const PictureSetting& pictureSetting(const std::string& name, const std::string& where);

/// Error, naming `where`, on a wrong number of values or one out of range.
void setPicture(PictureOptions& options, const PictureSetting& setting, const std::vector<double>& values,
                const std::string& where);
/// The index of a choice as numbers have it. Error, naming `where`, on an unknown one.
std::vector<double> choiceNamed(const PictureSetting& setting, const std::string& choice,
                                const std::string& where);

/// Adds a light as lights are by default and turns to it. Error, naming `where`, beyond kMostLights.
void addLight(PictureOptions& options, const std::string& where);

/// The settings with the maps that the options name. Throws Error where one cannot be read.
RenderSettings renderSettings(const PictureOptions& options);

}  // namespace strandcast
