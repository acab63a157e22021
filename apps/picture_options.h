#pragma once
#include "apps/picture_settings.h"
#include "render/renderer.h"

namespace CLI {
class App;
}

namespace strandcast {

/// Adds every picture setting as an option with help, and --preset.
void addPictureOptions(CLI::App& app, PictureOptions& options);

/// The box that pictures frame: the guides' bounds grown by `hair_reach` metres on all sides, and the body
/// around them.
Box pictureBox(const GroomDescription& groom, const BodyDescription& body, float hair_reach = 0);
/// Passes groom and body to the renderer and clears its obstacles.
void setScene(Renderer& renderer, const GroomDescription& groom, const BodyDescription& body);
/// Whether obstacles change the picture: the penetration of grown hair into them is resolved or marked, or
/// they carry a skinned body.
bool needsObstacles(const PictureOptions& options, const ColliderSet* colliders);
/// Passes the obstacles that the picture needs to the renderer; none where it needs none.
void setObstacles(Renderer& renderer, const PictureOptions& options, const ColliderSet* colliders,
                  const BodyDescription& body);
/// The camera that looks at `box` as the options say.
Camera pictureCamera(const PictureOptions& options, const Box& box);

}  // namespace strandcast
