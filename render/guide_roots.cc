#include "render/guide_roots.h"

#include "render/hair_growth.h"

namespace strandcast {

void GuideRoots::setGroom(const StrandSet& guides) {
  rest_.clear();
  normals_.clear();
  for (size_t g = 0; g < guides.strands(); ++g) {
    const std::span<const Vec3> points = guides.strand(g);
    rest_.push_back(points.empty() ? Vec3(Vec3::Zero()) : points.front());
    normals_.push_back(rootFrame(points).normal);
  }
  binding_ = BodyBinding(rest_, parts_);
}

void GuideRoots::setObstacles(std::span<const HairObstacle> obstacles) {
  parts_ = bodyParts(obstacles);
  binding_ = BodyBinding(rest_, parts_);
}

Vec3 GuideRoots::normal(size_t guide, const Vec3& root, const Pose& head) const {
  constexpr float kSame = 1e-8f;  // m^2, regularises the share; the root goes with the parts where both
                                  // predictions match
  const Vec3 &rest = rest_[guide], with_head = head.rotate(normals_[guide]);
  const Vec3 with_parts = binding_.normal(guide, rest, normals_[guide]);
  const float off_head = (root - head.apply(rest)).squaredNorm(),
              off_parts = (root - binding_.position(guide, rest)).squaredNorm();
  const float share = (off_head + kSame) / (off_head + off_parts + kSame);
  const Vec3 normal = with_head + share * (with_parts - with_head);
  return normal.allFinite() ? normal : with_head;
}

}  // namespace strandcast
