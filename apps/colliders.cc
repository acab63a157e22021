#include "apps/colliders.h"

namespace strandcast {

std::vector<Collider> collidersOf(const Simulation& simulation) {
  std::vector<Collider> colliders;
  for (const BodyId id : simulation.bodyIds()) {
    const RigidBody& body = simulation.body(id);
    if (!body.primitives.empty())
      colliders.push_back({static_cast<uint32_t>(id), body.follows_head, true, body.primitives});
  }
  return colliders;
}

std::vector<PlacedCollider> placedColliders(const Simulation& simulation) {
  std::vector<PlacedCollider> placed;
  for (const BodyId id : simulation.bodyIds()) {
    const RigidBody& body = simulation.body(id);
    if (!body.primitives.empty() && !body.follows_head)
      placed.push_back({static_cast<uint32_t>(id), simulation.bodyPose(id), simulation.bodyBend(id)});
  }
  return placed;
}

}  // namespace strandcast
