#include "render/guide_nodes.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "render/scene_block.h"
#include "render/shaders.h"

namespace strandcast {

void GuideRoots::setGroom(const StrandSet& guides) {
  rest_.clear();
  frames_.clear();
  for (size_t g = 0; g < guides.strands(); ++g) {
    const std::span<const Vec3> points = guides.strand(g);
    rest_.push_back(points.empty() ? Vec3(Vec3::Zero()) : points.front());
    frames_.push_back(rootFrame(points));
  }
  binding_ = BodyBinding(rest_, parts_);
}

void GuideRoots::setObstacles(std::span<const HairObstacle> obstacles) {
  parts_ = bodyParts(obstacles);
  binding_ = BodyBinding(rest_, parts_);
}

float GuideRoots::shareOfParts(size_t guide, const Vec3& root, const Pose& head) const {
  constexpr float kSame = 1e-8f;  // m^2, regularises the share; the root goes with the parts where both
                                  // predictions match
  const Vec3& rest = rest_[guide];
  const float off_head = (root - head.apply(rest)).squaredNorm(),
              off_parts = (root - binding_.position(guide, rest)).squaredNorm();
  return (off_head + kSame) / (off_head + off_parts + kSame);
}

Vec3 GuideRoots::carried(size_t guide, const Vec3& direction, float share, const Pose& head) const {
  const Vec3 with_head = head.rotate(direction);
  const Vec3 with_parts = binding_.normal(guide, rest_[guide], direction);
  const Vec3 result = with_head + share * (with_parts - with_head);
  return result.allFinite() ? result : with_head;
}

Vec3 GuideRoots::normal(size_t guide, const Vec3& root, const Pose& head) const {
  return carried(guide, frames_[guide].normal, shareOfParts(guide, root, head), head);
}

Pose GuideRoots::motion(size_t guide, const Vec3& root, const Pose& head) const {
  const RootFrame& rest = frames_[guide];
  const float share = shareOfParts(guide, root, head);
  Eigen::Matrix3f before, after;
  const Eigen::Vector3f normal = carried(guide, rest.normal, share, head).normalized(),
                        side = carried(guide, rest.binormal, share, head),
                        binormal = (side - normal * normal.dot(side)).normalized();
  before << rest.normal, rest.binormal, rest.normal.cross(rest.binormal);
  after << normal, binormal, normal.cross(binormal);
  const Quat rotation = Quat(Eigen::Matrix3f(after * before.transpose())).normalized();
  if (!rotation.coeffs().allFinite()) return head;
  const Vec3 &place = rest_[guide], with_head = head.apply(place);
  const Vec3 now = with_head + share * (binding_.position(guide, place) - with_head);
  return {now - rotation * place, rotation};
}

namespace {

constexpr unsigned kNodeGroupSize = 32;  // must equal local_size_x of guide_nodes.comp

/// Appends the rest arc length from the root as a fraction of the whole, per vertex; by index where there is
/// no length.
void appendKnots(std::span<const Vec3> points, std::vector<float>& knots) {
  const float length = arcLength(points);
  const bool measurable = std::isfinite(length) && length > 0;
  float run = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    if (i > 0) run += measurable ? (points[i] - points[i - 1]).norm() / length : 1.0f / (points.size() - 1);
    knots.push_back(i + 1 == points.size() ? 1.0f : std::min(run, 1.0f));
  }
  if (!points.empty()) knots[knots.size() - points.size()] = 0;
}

}  // namespace

GuideNodes::GuideNodes(int segments)
    : segments_(segments), program_("guide nodes", {{GL_COMPUTE_SHADER, shaders::kGuideNodesComp}}) {
  setGroom({});
}

void GuideNodes::setGroom(const StrandSet& guides, bool carry_hairs) {
  std::vector<Guide> described(guides.strands());
  std::vector<float> knots;
  knots.reserve(guides.vertices());
  for (size_t g = 0; g < guides.strands(); ++g) {
    const auto points = guides.strand(g);
    appendKnots(points, knots);
    described[g] = {
        guides.offsets[g], static_cast<uint32_t>(points.size()), 0, 0, {}, arcLength(points), {}, {}};
  }
  const size_t node_bytes = guides.strands() * (segments_ + 1) * 3 * sizeof(float[4]);
  GLint64 largest = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &largest);
  if (node_bytes > static_cast<size_t>(largest))
    throw Error("a groom is too large for the OpenGL device",
                std::to_string(guides.strands()) + " guides need a buffer of " + std::to_string(node_bytes) +
                    " bytes, the device allows " + std::to_string(largest),
                "publish fewer guides or render with fewer segments");
  guides_ = std::move(described);
  roots_.setGroom(guides);
  vertices_ = guides.vertices();
  position_buffer_ = gl::Buffer(vertices_ * sizeof(Vec3), nullptr, GL_DYNAMIC_STORAGE_BIT);
  knot_buffer_ = gl::Buffer(std::span<const float>(knots));
  guide_buffer_ = gl::Buffer(std::span<const Guide>(guides_));
  node_buffer_ = gl::Buffer(node_bytes, nullptr, 0);
  carries_hairs_ = carry_hairs && !guides_.empty();
  motion_buffer_ = gl::Buffer(carries_hairs_ ? node_bytes : 0, nullptr, 0);
  if (carries_hairs_) makeRestNodes(guides.positions);
}

void GuideNodes::makeRestNodes(std::span<const Vec3> positions) {
  const auto program = [](const char* name, const char* defines) {
    return std::make_unique<gl::Program>(
        name, std::vector<gl::ShaderStage>{{GL_COMPUTE_SHADER, shaders::kGuideNodesComp, defines}});
  };
  if (!rest_program_) {
    rest_program_ = program("guide nodes at rest", "#define REST\n");
    carrying_program_ = program("guide nodes that carry hair", "#define CARRY\n");
  }
  check(positions);
  position_buffer_.write(positions);
  guide_buffer_.write(std::span<const Guide>(guides_));
  dispatch(*rest_program_);
}

size_t GuideNodes::check(std::span<const Vec3> positions) {
  if (guides_.empty() || positions.size() != vertices_) return 0;
  size_t unusable = 0;
  for (Guide& guide : guides_) {
    const auto points = positions.subspan(guide.first, guide.count);
    guide.usable = guide.count >= 2 && std::all_of(points.begin(), points.end(), [](const Vec3& p) {
                     return p.cwiseAbs().maxCoeff() < 1e6f && p.allFinite();
                   });
    unusable += guide.usable == 0;
  }
  return unusable;
}

size_t GuideNodes::update(std::span<const Vec3> positions, const Pose& head,
                          std::span<const PlacedCollider> colliders) {
  if (guides_.empty() || positions.size() != vertices_) return 0;
  const size_t unusable = check(positions);
  position_buffer_.write(positions);
  Eigen::Matrix4f rotation = Eigen::Matrix4f::Identity();
  const Quat turn = head.rotation.coeffs().allFinite() && head.rotation.norm() > 1e-6f
                        ? head.rotation.normalized()
                        : Quat::Identity();
  rotation.topLeftCorner<3, 3>() = turn.toRotationMatrix();
  roots_.setColliderPoses(colliders);
  for (size_t g = 0; g < guides_.size(); ++g) {
    Guide& guide = guides_[g];
    guide.carried = guide.usable != 0 && roots_.carries(g);
    const Vec3 normal = guide.carried != 0 ? roots_.normal(g, positions[guide.first], {head.position, turn})
                                           : roots_.restNormal(g);
    std::copy(normal.begin(), normal.end(), guide.root_normal);
    if (!carries_hairs_) continue;
    const Pose with_head{head.position, turn};
    const Pose root = guide.carried != 0 ? roots_.motion(g, positions[guide.first], with_head) : with_head;
    std::copy_n(root.rotation.coeffs().data(), 4, guide.root_rotation);
    if (root.position.allFinite()) std::copy(root.position.begin(), root.position.end(), guide.root_position);
  }
  guide_buffer_.write(std::span<const Guide>(guides_));
  const gl::Program& program = carries_hairs_ ? *carrying_program_ : program_;
  program.set("head_rotation", rotation);
  dispatch(program);
  return unusable;
}

void GuideNodes::dispatch(const gl::Program& program) const {
  bind();
  program.set("guide_count", static_cast<unsigned>(guides_.size()));
  program.set("segments", static_cast<unsigned>(segments_));
  program.use();
  glDispatchCompute((static_cast<unsigned>(guides_.size()) + kNodeGroupSize - 1) / kNodeGroupSize, 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

size_t GuideNodes::bytes() const {
  return position_buffer_.bytes() + knot_buffer_.bytes() + guide_buffer_.bytes() + node_buffer_.bytes() +
         motion_buffer_.bytes();
}

void GuideNodes::bind() const {
  position_buffer_.bindStorage(binding::kGuidePositions);
  knot_buffer_.bindStorage(binding::kGuideKnots);
  guide_buffer_.bindStorage(binding::kGuides);
  node_buffer_.bindStorage(binding::kNodes);
  if (carries_hairs_) motion_buffer_.bindStorage(binding::kNodeMotions);
}

}  // namespace strandcast
