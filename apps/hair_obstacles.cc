#include "apps/hair_obstacles.h"

#include <spdlog/spdlog.h>

#include <memory>

#include "apps/channel.h"
#include "apps/console.h"
#include "apps/interrupt.h"
#include "collision/field_cache.h"
#include "core/error.h"

namespace strandcast {
namespace {

constexpr float kCell = 0.003f;  // m; grown hair may show through a body's edge by at most a tenth of it

/// The triangles whose corners belong to the head, or those whose corners do not.
TriangleMesh partOf(const BodyDescription& body, bool head) {
  TriangleMesh part = body.mesh;
  const bool weighted = body.head_weights.size() == body.mesh.positions.size();
  std::erase_if(part.triangles, [&](const std::array<uint32_t, 3>& triangle) {
    float weight = 0;
    for (const uint32_t corner : triangle) weight += weighted ? body.head_weights[corner] / 3 : 1.0f / 3;
    return (weight >= 0.5f) != head;
  });
  return part;
}

std::vector<HairObstacle> bakedObstacles(const BodyDescription& body) {
  std::vector<HairObstacle> obstacles;
  const FieldCache cache(fieldCacheWithProgress());
  for (const bool head : {true, false}) {
    const TriangleMesh part = partOf(body, head);
    if (part.triangles.empty()) continue;
    FieldOptions options;
    options.cell = kCell;
    ProgressBar bar;
    try {
      ContactPrimitive shape;
      shape.kind = PrimitiveKind::kField;
      const auto progress = [&](const std::string& what, double done) {
        bar.show("body: " + what, done);
        return !g_interrupted;
      };
      const char* name = head ? "the head" : "the standing bodies";
      SceneField baked = fieldOf(part, options, cache, progress, bakesOf(announceBakes(bar), name));
      for (const std::string& warning : baked.warnings) spdlog::warn("{}: {}", name, warning);
      shape.field = std::make_shared<DistanceField>(std::move(baked.field));
      obstacles.push_back({std::move(shape), head, kNoCollider, Pose{}});
    } catch (const Error& error) {
      spdlog::warn("grown hair may enter a part of the body: {}", error.what());
    }
  }
  return obstacles;
}

}  // namespace

std::vector<HairObstacle> hairObstacles(const ColliderSet* colliders, const BodyDescription& body) {
  std::vector<HairObstacle> obstacles;
  bool is_whole = colliders != nullptr && !colliders->colliders.empty();
  if (colliders) {
    for (const Collider& collider : colliders->colliders) {
      is_whole &= collider.is_whole;
      for (const ContactPrimitive& shape : collider.shapes)
        obstacles.push_back({shape, collider.follows_head, collider.id, Pose{}});
    }
  }
  if (is_whole) return obstacles;
  for (HairObstacle& baked : bakedObstacles(body)) obstacles.push_back(std::move(baked));
  return obstacles;
}

}  // namespace strandcast
