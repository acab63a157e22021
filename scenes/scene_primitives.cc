#include "scenes/scene_primitives.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "groom/mesh_file.h"

namespace strandcast {
namespace {

/// The mesh where it stands while the head is at rest. Fields of colliders that do not follow the head are
/// neither moved nor turned in them (docs/wire.md), so the mesh is, before anything is made of it.
TriangleMesh placedMesh(const ScenePrimitive& primitive, const MeshUnits& units) {
  GroomReadOptions read = units.read;
  if (read.unit_meters <= 0 && !isGltf(primitive.file)) read.unit_meters = units.obj_meters;
  TriangleMesh mesh = loadMesh(primitive.file, read);
  for (Vec3& p : mesh.positions) p = Vec3(primitive.shape.rotation * p + primitive.shape.a);
  return mesh;
}

ContactPrimitive madeOf(const ScenePrimitive& primitive, PrimitiveKind kind) {
  ContactPrimitive shape;
  shape.kind = kind;
  shape.friction = primitive.shape.friction;
  return shape;
}

ContactPrimitive convexShape(const ScenePrimitive& primitive, const TriangleMesh& mesh) {
  ContactPrimitive shape = madeOf(primitive, PrimitiveKind::kConvex);
  try {
    shape.convex = std::make_shared<const ConvexBody>(convexBody(mesh));
  } catch (const Error& error) {
    throw Error(error.what(), primitive.where, "kind = \"mesh\" takes meshes that are not convex");
  }
  return shape;
}

/// A renderer draws the vertices of the body that lie on a field which does not follow the head where that is
/// (render/body_binding.h), as parts of a skinned body.
void warnOfTouching(const TriangleMesh& body, const DistanceField& field, const std::string& name,
                    std::vector<std::string>& warnings) {
  const float near = 4 * field.grid.cell;
  const auto touching = std::count_if(body.positions.begin(), body.positions.end(),
                                      [&](const Vec3& p) { return std::fabs(field.at(p).distance) < near; });
  if (touching > 0)
    warnings.push_back(fmt::format(
        "{} vertices of the body are within {:.3g} mm of {}, which does not follow the head: they "
        "are drawn there when the head moves; keep them apart, or let it follow the head",
        touching, 1e3 * static_cast<double>(near), name));
}

}  // namespace

PrimitiveBodies primitiveBodies(const std::vector<ScenePrimitive>& primitives, const MeshBodyOptions& options,
                                const TriangleMesh& body, const BakeProgress& progress,
                                const BakeAnnouncement& bake_begins, const BakeLimits& limits) {
  PrimitiveBodies made;
  RigidBody head{{}, true}, standing;
  for (size_t i = 0; i < primitives.size(); ++i) {
    const ScenePrimitive& primitive = primitives[i];
    const std::string name = primitive.file.filename().string();
    ContactPrimitive shape = primitive.shape;
    if (shape.kind == PrimitiveKind::kConvex) {
      shape = convexShape(primitive, placedMesh(primitive, options.units));
    } else if (shape.kind == PrimitiveKind::kField) {
      FieldOptions own = options.field;
      if (primitive.cell > 0) own.cell = primitive.cell;
      SceneField baked = fieldOf(
          placedMesh(primitive, options.units), own, FieldCache(options.cache),
          [&](const std::string& what, double part) {
            const double done = static_cast<double>(i) + part;
            return !progress ||
                   progress(fmt::format("{}: {}", name, what), done / static_cast<double>(primitives.size()));
          },
          bakesOf(bake_begins, name), limits);
      (baked.trouble.empty() ? made.notes : made.warnings).push_back(name + ": " + baked.note);
      shape = madeOf(primitive, PrimitiveKind::kField);
      shape.field = std::make_shared<const DistanceField>(std::move(baked.field));
      if (!shape.field->hasInside()) made.warnings.push_back(fmt::format("{}: {}", name, kNoInside));
      if (!primitive.follows_head) warnOfTouching(body, *shape.field, name, made.warnings);
    }
    checkPrimitive(shape, primitive.where);
    (primitive.follows_head ? head : standing).primitives.push_back(std::move(shape));
  }
  for (RigidBody* some : {&head, &standing})
    if (!some->primitives.empty()) made.bodies.push_back(std::move(*some));
  return made;
}

}  // namespace strandcast
