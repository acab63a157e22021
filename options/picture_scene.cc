#include "options/picture_scene.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "collision/field_cache.h"
#include "core/error.h"
#include "options/console.h"
#include "options/scene_loading.h"

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

Box pictureBox(const GroomDescription& groom, const BodyDescription& body, float hair_reach) {
  Box box;
  for (const Vec3& p : groom.guides.positions) box.extend(Eigen::Vector3f(p));
  const Eigen::Vector3f beside = Eigen::Vector3f::Constant(hair_reach);
  Box hair;
  if (!box.isEmpty()) hair = Box(box.min() - beside, box.max() + beside);
  if (body.mesh.empty()) return hair;
  // The box includes the head under short hair, but not a whole figure, which would shrink the hair to a dot.
  Box around(box.min() - box.sizes() * 0.35f, box.max() + box.sizes() * 0.35f);
  return hair.merged(around.intersection(body.mesh.bounds()));
}

void setScene(Renderer& renderer, const GroomDescription& groom, const BodyDescription& body,
              const HairDescription* hairs) {
  renderer.setObstacles({});
  renderer.setGroom(groom);
  if (hairs != nullptr) renderer.setHairs(*hairs);
  renderer.setBody(body);
}

namespace {

/// Whether colliders are parts of a skinned body, which the renderer draws at the colliders' poses.
bool haveBodyParts(const ColliderSet* colliders) {
  if (colliders == nullptr) return false;
  for (const Collider& collider : colliders->colliders)
    for (const ContactPrimitive& shape : collider.shapes)
      if (shape.field && !collider.follows_head) return true;
  return false;
}

}  // namespace

bool needsObstacles(const PictureOptions& options, const ColliderSet* colliders) {
  const RenderSettings& settings = options.settings;
  return settings.keep_out || settings.marks.needBodies() || haveBodyParts(colliders);
}

void setObstacles(Renderer& renderer, const PictureOptions& options, const ColliderSet* colliders,
                  const BodyDescription& body) {
  std::vector<HairObstacle> obstacles;
  if (needsObstacles(options, colliders)) obstacles = hairObstacles(colliders, body);
  renderer.setObstacles(std::move(obstacles));
}

Camera pictureCamera(const PictureOptions& options, const Box& box) {
  const auto radians = [](double degrees) { return static_cast<float>(degrees * std::numbers::pi / 180); };
  return orbit(box, radians(options.azimuth), radians(options.elevation), static_cast<float>(options.zoom));
}

float pixelsOfHair(const Camera& camera, const GuideFrame& frame, int height) {
  constexpr float kMaxPixels = 1e6f;
  Box hair;
  for (const Vec3& position : frame.positions)
    if (position.allFinite()) hair.extend(position);
  if (hair.isEmpty()) return 0;
  return std::min(heightsInPicture(camera, hair) * static_cast<float>(height), kMaxPixels);
}

}  // namespace strandcast
