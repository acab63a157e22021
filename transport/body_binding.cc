#include "transport/body_binding.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace strandcast {

std::vector<BodyPart> bodyParts(const ColliderSet& set) {
  std::vector<BodyPart> parts;
  for (const Collider& collider : set.colliders) {
    if (collider.follows_head) continue;
    for (const ContactPrimitive& shape : collider.shapes)
      if (isBodyPart(shape)) parts.push_back({collider.id, shape.field});
  }
  return parts;
}

BodyBinding::BodyBinding(std::span<const Vec3> positions, std::span<const BodyPart> parts) {
  std::vector<const DistanceField*> fields;
  for (const BodyPart& part : parts.first(std::min(parts.size(), kMaxPlacedColliders))) {
    colliders_.push_back(part.collider);
    fields.push_back(part.field.get());
  }
  if (fields.empty()) return;
  poses_.resize(fields.size());
  bends_.resize(fields.size());
  offsets_.push_back(0);
  std::vector<Share> near;
  for (const Vec3& point : positions) {
    near.clear();
    float sum = 0, nearest = std::numeric_limits<float>::max();
    uint32_t nearest_field = 0;
    for (uint32_t i = 0; i < fields.size(); ++i) {
      const float cells = std::fabs(fields[i]->at(point).distance) / fields[i]->grid.cell;
      if (cells < nearest) nearest_field = i;
      nearest = std::min(nearest, cells);
      const float weight = 1 - 2 * cells;  // 0 at half a cell: farther away it is another surface
      if (!(weight > 0)) continue;
      near.push_back({i, weight});
      sum += weight;
    }
    if (near.empty() && nearest < 4) {
      near.push_back({nearest_field, 1});
      sum = 1;
    }
    for (const Share& share : near) shares_.push_back({share.collider, share.weight / sum});
    offsets_.push_back(shares_.size());
  }
}

void BodyBinding::setColliderPoses(std::span<const PlacedCollider> colliders) {
  for (size_t i = 0; i < colliders_.size(); ++i)
    for (const PlacedCollider& placed : colliders) {
      if (placed.id != colliders_[i]) continue;
      poses_[i] = placed.pose;
      bends_[i] = placed.bend;
    }
}

uint32_t BodyBinding::mainCollider(size_t vertex) const {
  const auto begin = shares_.begin() + static_cast<ptrdiff_t>(offsets_[vertex]),
             end = shares_.begin() + static_cast<ptrdiff_t>(offsets_[vertex + 1]);
  const auto most =
      std::max_element(begin, end, [](const Share& a, const Share& b) { return a.weight < b.weight; });
  return colliders_[most->collider];
}

Vec3 BodyBinding::position(size_t vertex, const Vec3& rest) const {
  Vec3 sum = Vec3::Zero();
  for (size_t i = offsets_[vertex]; i < offsets_[vertex + 1]; ++i)
    sum += shares_[i].weight * poses_[shares_[i].collider].apply(bends_[shares_[i].collider].placed(rest));
  return sum;
}

Vec3 BodyBinding::normal(size_t vertex, const Vec3& rest, const Vec3& normal) const {
  Vec3 sum = Vec3::Zero();
  for (size_t i = offsets_[vertex]; i < offsets_[vertex + 1]; ++i) {
    const SurfaceBend& bend = bends_[shares_[i].collider];
    const Vec3 bent = bend.normal(bend.placed(rest), normal).normalized();
    sum += shares_[i].weight * poses_[shares_[i].collider].rotate(bent);
  }
  return sum;
}

}  // namespace strandcast
