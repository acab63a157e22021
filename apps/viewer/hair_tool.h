#pragma once
#include <memory>
#include <optional>

#include "apps/viewer/session.h"
#include "render/camera.h"

namespace strandcast {

/// What dragging with the left button does.
enum class MouseTool { kOrbit, kMoveHead, kTurnHead, kPull, kComb };
inline constexpr const char* kMouseTools[] = {"orbit", "move head", "turn head", "pull", "comb"};

/// How the mouse holds hair.
struct HandSettings {
  float radius = 0.006f;       ///< m, reach of a pull
  float comb_radius = 0.025f;  ///< m, reach of a comb
  float rate = 120;            ///< 1/s, rate of the pull
};

/// The vertex under the mouse: the nearest to the eye of those within `reach`, in heights of the picture.
std::optional<uint32_t> pickedVertex(const Camera& camera, std::span<const Vec3> vertices,
                                     const PicturePoint& mouse, float reach);
/// The mouse position in the plane through `at` that faces the camera, m, world.
Vec3 draggedTo(const Camera& camera, const Vec3& at, const PicturePoint& mouse);

/// Turns mouse drags on hair and head into commands.
class HairTool {
 public:
  /// Starts a drag; false where there is nothing to grasp.
  bool press(MouseTool tool, const HandSettings& hand, const Camera& camera, const GuideFrame& frame,
             const PicturePoint& mouse);
  /// Sends the command for the present mouse position of a drag.
  void drag(const Camera& camera, const PicturePoint& mouse, CommandSender& commands);
  /// Ends the drag; releases pulled hair.
  void release(CommandSender& commands);
  bool isHolding() const { return holding_; }
  const Vec3& hand() const { return to_; }  ///< m, world

 private:
  void pull(CommandSender& commands) const;

  bool holding_ = false;
  MouseTool tool_ = MouseTool::kOrbit;
  HandSettings settings_;
  Vec3 from_ = Vec3::Zero(), to_ = Vec3::Zero();
  PicturePoint start_{};
  Pose head_;
};

}  // namespace strandcast
