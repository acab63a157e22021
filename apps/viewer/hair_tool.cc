#include "apps/viewer/hair_tool.h"

#include <cmath>
#include <limits>

namespace strandcast {
namespace {

constexpr float kReach = 0.05f;        // radius around the mouse, in heights of the picture
constexpr float kTurn = 3;             // rad, for a drag over the picture's height
constexpr float kCombAnew = 0.7f;      // fraction of its radius, after which a comb grasps the hair at its
                                       // new position
constexpr float kFarthestHead = 0.6f;  // m

}  // namespace

std::optional<uint32_t> pickedVertex(const Camera& camera, std::span<const Vec3> vertices,
                                     const PicturePoint& mouse, float reach) {
  std::optional<uint32_t> picked;
  float nearest = std::numeric_limits<float>::infinity();
  for (uint32_t v = 0; v < vertices.size(); ++v) {
    const auto place = projected(camera, vertices[v], mouse.aspect);
    if (!place) continue;
    const float off = std::hypot((place->x - mouse.x) * mouse.aspect, place->y - mouse.y);
    // Weights the distance to the eye by that to the mouse, so that a vertex at the edge of the reach wins
    // only where it is much nearer.
    const float cost = (vertices[v] - camera.eye).norm() * (1 + 2 * off);
    if (off > reach || !(cost < nearest)) continue;
    nearest = cost;
    picked = v;
  }
  return picked;
}

Vec3 draggedTo(const Camera& camera, const Vec3& at, const PicturePoint& mouse) {
  const Eigen::Matrix4f view = viewMatrix(camera);
  const float depth = -(view * Eigen::Vector4f(at.x(), at.y(), at.z(), 1)).z();
  const float slope = std::tan(0.5f * camera.vertical_fov);
  const Eigen::Vector3f eye((2 * mouse.x - 1) * slope * mouse.aspect * depth,
                            (1 - 2 * mouse.y) * slope * depth, -depth);
  const Eigen::Matrix3f turn = view.topLeftCorner<3, 3>();
  return camera.eye + Vec3(turn.transpose() * eye);
}

bool HairTool::press(MouseTool tool, const HandSettings& hand, const Camera& camera, const GuideFrame& frame,
                     const PicturePoint& mouse) {
  holding_ = false;
  if (tool == MouseTool::kOrbit) return false;
  tool_ = tool;
  settings_ = hand;
  start_ = mouse;
  head_ = frame.head;
  if (tool == MouseTool::kPull || tool == MouseTool::kComb) {
    const auto vertex = pickedVertex(camera, frame.positions, mouse, kReach);
    if (!vertex) return false;
    from_ = frame.positions[*vertex];
  } else {
    from_ = head_.position;
  }
  to_ = from_;
  return holding_ = true;
}

void HairTool::drag(const Camera& camera, const PicturePoint& mouse, CommandSender& commands) {
  if (!holding_) return;
  if (tool_ == MouseTool::kPull || tool_ == MouseTool::kComb) {
    to_ = draggedTo(camera, from_, mouse);
    pull(commands);
    if (tool_ == MouseTool::kComb && (to_ - from_).norm() > kCombAnew * settings_.comb_radius) from_ = to_;
    return;
  }
  Pose pose = head_;
  if (tool_ == MouseTool::kMoveHead) {
    const Vec3 way = draggedTo(camera, from_, mouse) - draggedTo(camera, from_, start_);
    pose.position += way * std::min(1.0f, kFarthestHead / std::max(way.norm(), 1e-6f));
  } else {
    const Eigen::Vector3f across = viewMatrix(camera).block<1, 3>(0, 0).transpose();  // to the right
    const Eigen::Quaternionf turn(
        Eigen::AngleAxisf(kTurn * (mouse.x - start_.x) * mouse.aspect, Eigen::Vector3f::UnitY()) *
        Eigen::AngleAxisf(kTurn * (mouse.y - start_.y), across));
    pose.rotation = (Quat(turn) * head_.rotation).normalized();
  }
  const auto& p = pose.position;
  const auto& q = pose.rotation;
  commands.send(CommandKind::kHeadPose, "", {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
}

void HairTool::pull(CommandSender& commands) const {
  const float radius = tool_ == MouseTool::kComb ? settings_.comb_radius : settings_.radius;
  commands.send(CommandKind::kPull, "",
                {from_.x(), from_.y(), from_.z(), radius, to_.x(), to_.y(), to_.z(), settings_.rate});
}

void HairTool::release(CommandSender& commands) {
  if (holding_ && (tool_ == MouseTool::kPull || tool_ == MouseTool::kComb))
    commands.send(CommandKind::kPull, "", {});
  holding_ = false;
}

}  // namespace strandcast
