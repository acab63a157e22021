#pragma once
#include <memory>
#include <optional>

#include "apps/viewer/command_sender.h"
#include "render/camera.h"

namespace strandcast {

/// What dragging with the left button does.
enum class MouseTool { kOrbit, kMoveHead, kTurnHead, kPull, kComb };
inline constexpr const char* kMouseTools[] = {"orbit", "move head", "turn head", "pull", "comb"};

/// How a hand takes hair.
struct HandSettings {
  float radius = 0.006f;       ///< m, of what pulling holds
  float comb_radius = 0.025f;  ///< m, of what combing holds
  float rate = 120;            ///< 1/s
};

/// A place in the picture, 0 to 1 from the left and from the top, and width over height of the picture.
struct PicturePoint {
  float x, y, aspect;
};

/// Where the camera has a point of the world; nothing behind it.
std::optional<PicturePoint> projected(const Camera& camera, const Vec3& point, float aspect);
/// The vertex under the mouse: of those within `reach` (of the picture's height) the nearest to the eye.
std::optional<uint32_t> pickedVertex(const Camera& camera, std::span<const Vec3> vertices,
                                     const PicturePoint& mouse, float reach);
/// Where the mouse is in the plane through `at` that faces the camera.
Vec3 draggedTo(const Camera& camera, const Vec3& at, const PicturePoint& mouse);

/// Turns what the mouse does to hair and head into commands.
class HairTool {
 public:
  /// False where there is nothing to take.
  bool press(MouseTool tool, const HandSettings& hand, const Camera& camera, const GuideFrame& frame,
             const PicturePoint& mouse);
  void drag(const Camera& camera, const PicturePoint& mouse, CommandSender& commands);
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
