#include "render/body_binding.h"

#include <algorithm>
#include <cmath>

namespace strandcast {

BodyBinding::BodyBinding(std::span<const Vec3> positions, std::span<const HairObstacle> obstacles) {
  std::vector<const DistanceField*> fields;
  for (const HairObstacle& obstacle : obstacles) {
    if (!obstacle.canBend() || obstacle.shape.a != Vec3(Vec3::Zero())) continue;
    colliders_.push_back(obstacle.collider);
    fields.push_back(obstacle.shape.field.get());
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
      const float weight = 1 - 2 * cells;  // half a cell away it is another surface
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

void BodyBinding::place(std::span<const PlacedCollider> colliders) {
  for (size_t i = 0; i < colliders_.size(); ++i)
    for (const PlacedCollider& placed : colliders) {
      if (placed.id != colliders_[i]) continue;
      poses_[i] = placed.pose;
      bends_[i] = placed.bend;
    }
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
