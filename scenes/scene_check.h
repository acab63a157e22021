// Checks of a scene before a show: do groom, body and clip fit each other? Nothing is baked for them.
#pragma once
#include <cstddef>
#include <string>

#include "collision/mesh_query.h"
#include "groom/groom_check.h"
#include "scenes/scene.h"

namespace strandcast {

/// A scene as makeScene() reads it, for checks.
struct CheckedScene {
  Scene scene;  ///< all strands of the groom, cleaned, on the body; without contact (BodyContact::kNone)
  StrandSet as_read;  ///< the strands before cleaning, m, Y up
};
/// Reads groom, body and clip. Options about guides, contact and further bodies are ignored. Throws Error as
/// makeScene(), and where no groom file is given; BakeStopped when `progress` returns false.
CheckedScene loadForCheck(SceneOptions options, const Progress& progress = {});

/// All checks below that apply to the scene. `rate`: frames per second of the clip. Throws BakeStopped when
/// `progress` returns false.
CheckReport checkScene(const CheckedScene& checked, const SceneOptions& options, double rate,
                       const Progress& progress = {});

/// m, distances from the skin above which roots are counted.
constexpr float kRootNearSkin = 2e-3f, kRootOffSkin = 10e-3f;
/// m, depth below which a vertex beyond the root does not count as inside: distance fields err by less.
constexpr float kInsideTolerance = 3e-4f;
constexpr double kFastRoot = 10;             ///< m/s, speed of a root above which a clip is doubtful
constexpr double kRootJump = 0.02;           ///< m, change of a root's motion from one frame to the next
constexpr double kSkinStretch = 1.5;         ///< factor on an edge of the skin under a root
constexpr size_t kMaxClipFrames = 1800;      ///< frames of a clip that are looked at
constexpr size_t kMaxStrandsInside = 20000;  ///< strands looked at for vertices inside, evenly chosen

/// The body's surface: size, open and non-manifold edges, winding, shells inside each other. `mesh`: as
/// requireSoundMesh().
CheckReport checkBodyMesh(const TriangleMesh& mesh);

/// Do groom and body have the same scale, axis and place? Where they do not, the remedy is the usual unit and
/// axis with which the roots lie on the body. `query`: of scene.body.
CheckReport checkPlacement(const Scene& scene, const SceneOptions& options, const MeshQuery& query);

/// Distances of roots from the skin. `query`: of scene.body. Marks roots farther than kRootNearSkin.
CheckReport checkRoots(const Scene& scene, const MeshQuery& query);

/// Vertices inside the body that the root does not explain: deeper than the root, or after the strand has
/// come out of the skin. `query`: of scene.body. Marks them.
CheckReport checkHairInside(const Scene& scene, const MeshQuery& query, const Progress& progress = {});

/// The skin under the roots over the clip: joints without motion, carriers of roots, stretch, speeds, jumps.
/// `clip`: as SkinnedMotion::clip; `rate`: frames per second. Precondition: scene.skinned is not null.
CheckReport checkClip(const Scene& scene, const std::string& clip, double rate, const MeshQuery& query,
                      const Progress& progress = {});

}  // namespace strandcast
