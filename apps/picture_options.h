#pragma once
#include "apps/picture_settings.h"
#include "render/renderer.h"

namespace CLI {
class App;
}

namespace strandcast {

/// Every setting of pictures as an option, with help, and --preset.
void addPictureOptions(CLI::App& app, PictureOptions& options);

/// The box that pictures frame: of the hair, `hair_reach` metres to all sides of its guides, and of the body
/// around it.
Box pictureBox(const GroomDescription& groom, const BodyDescription& body, float hair_reach = 0);
/// Tells the renderer what it draws; it has no obstacles then.
void setScene(Renderer& renderer, const GroomDescription& groom, const BodyDescription& body);
/// Whether a picture is other with obstacles than without: hair is kept out of them, is marked in them, or
/// they carry a skinned body.
bool needsObstacles(const PictureOptions& options, const ColliderSet* colliders);
/// Gives the renderer those that the picture needs, or none.
void setObstacles(Renderer& renderer, const PictureOptions& options, const ColliderSet* colliders,
                  const BodyDescription& body);
/// Looks at `box` from where the options say.
Camera pictureCamera(const PictureOptions& options, const Box& box);

}  // namespace strandcast
