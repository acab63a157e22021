// What a picture shows: groom, body, obstacles and camera by its options.
#pragma once
#include <vector>

#include "options/picture_settings.h"
#include "render/hair_bodies.h"
#include "render/renderer.h"
#include "transport/messages.h"

namespace strandcast {

/// The obstacles that a renderer keeps grown hair out of. They are `colliders`, the bodies that the daemon's
/// guides collide with. Where there are none (null or empty, as for a recording), or one lacks its field, the
/// published body replaces or completes them. It is baked as distance fields of two parts: one follows the
/// head, one stays. The bake shows a progress bar and uses the user's cache. Empty, with a warning, for a
/// body that no field can be baked of. Ctrl-C stops it: throws BakeStopped.
std::vector<HairObstacle> hairObstacles(const ColliderSet* colliders, const BodyDescription& body);

/// The box that pictures frame: the guides' bounds grown by `hair_reach` metres on all sides, and the body
/// around them.
Box pictureBox(const GroomDescription& groom, const BodyDescription& body, float hair_reach = 0);
/// Passes groom, body and bound hairs (null: none) to the renderer and clears its obstacles. Throws Error
/// where the hairs do not fit the groom.
void setScene(Renderer& renderer, const GroomDescription& groom, const BodyDescription& body,
              const HairDescription* hairs = nullptr);
/// Whether obstacles change the picture: the penetration of grown hair into them is resolved or marked, or
/// they carry a skinned body.
bool needsObstacles(const PictureOptions& options, const ColliderSet* colliders);
/// Passes the obstacles that the picture needs to the renderer; none where it needs none.
void setObstacles(Renderer& renderer, const PictureOptions& options, const ColliderSet* colliders,
                  const BodyDescription& body);
/// The camera that looks at `box` as the options say.
Camera pictureCamera(const PictureOptions& options, const Box& box);
/// What Subscriber::setPictures() takes: the diameter of the bounding sphere of a frame's hair in a picture
/// `height` pixels high. Hair beside the picture counts, too: its shadow may be in it. 0 without hair; places
/// that are not finite are left out.
float pixelsOfHair(const Camera& camera, const GuideFrame& frame, int height);

}  // namespace strandcast
