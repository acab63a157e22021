#pragma once
#include <filesystem>
#include <vector>

#include "render/renderer.h"

namespace CLI {
class App;
}

namespace strandcast {

/// What `render`, `compare` and `view` have in common: how the picture looks and from where.
struct PictureOptions {
  RenderSettings settings;
  double azimuth = 25, elevation = 5;  ///< degrees; 0 looks at the face
  double zoom = 1;
  std::vector<float> hair_color;                     ///< red green blue, linear; empty = the settings' own
  std::vector<float> lock_profile;                   ///< root, middle, tip; empty = the settings' own
  bool keep_out = false;                             ///< grown hair of the body
  std::filesystem::path density_map, thickness_map;  ///< empty = none
};
void addPictureOptions(CLI::App& app, PictureOptions& options);
/// The settings with every option laid over them. Throws Error where a map cannot be read.
RenderSettings renderSettings(const PictureOptions& options);

/// The box that pictures frame: of the hair, and of the body around it.
Box pictureBox(const GroomDescription& groom, const BodyDescription& body);
/// Tells the renderer what it draws.
void setPicture(Renderer& renderer, const GroomDescription& groom, const BodyDescription& body);
/// Keeps grown hair out of what it is to be kept out of, where that is asked for: hairObstacles().
void setObstacles(Renderer& renderer, const PictureOptions& options, const ColliderSet* colliders,
                  const BodyDescription& body);
/// Looks at `box` from where the options say.
Camera pictureCamera(const PictureOptions& options, const Box& box);

}  // namespace strandcast
