#include "scenes/scene_primitives.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "core/error.h"
#include "core/hash.h"
#include "io/mesh_file.h"

namespace strandcast {
namespace {

/// m. Offset of a field's own frame from that of its collider; the field is placed back by as much. Clients
/// draw body vertices with the field on which they lie in its own frame (docs/wire.md). This collider is no
/// part of the body: the offset keeps its field away from those vertices.
constexpr float kAside = 16;

void setAside(ContactPrimitive& shape) {
  DistanceField field = *shape.field;
  field.grid.origin[1] += kAside;
  shape.field = std::make_shared<const DistanceField>(std::move(field));
  shape.a.y() -= kAside;
}

/// Moves the shape to the origin of its body, without rotation. Returns the pose that restores its placement.
Pose extractPose(ContactPrimitive& shape) {
  Pose pose;
  std::swap(pose.position, shape.a);
  if (shape.kind == PrimitiveKind::kCapsule || shape.kind == PrimitiveKind::kTaperedCapsule)
    shape.b -= pose.position;
  else if (shape.kind != PrimitiveKind::kPlane)
    std::swap(pose.rotation, shape.rotation);
  return pose;
}

/// Reads the mesh of a primitive and places it as it is while the head, or the joint, is at rest. Fields of
/// colliders that do not follow the head have neither translation nor rotation in them (docs/wire.md), so the
/// mesh itself is transformed first. `hash` receives the mesh before that.
TriangleMesh placedMesh(const ScenePrimitive& primitive, const GroomReadOptions& obj_units,
                        PrimitiveBodies& made, ContentHash& hash) {
  ReadMesh from = loadMesh(primitive.file, meshUnits(primitive.file, primitive.units, obj_units),
                           kSkippedGroups, primitive.beneath);
  appendReport(primitive.file, from.report, made.notes, made.warnings);
  TriangleMesh mesh = std::move(from.mesh);
  hash.add(mesh.positions.data(), mesh.positions.size() * sizeof(mesh.positions[0]));
  hash.add(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
  for (Vec3& p : mesh.positions) p = Vec3(primitive.shape.rotation * p + primitive.shape.a);
  return mesh;
}

ContactPrimitive madeOf(const ScenePrimitive& primitive, PrimitiveKind kind) {
  ContactPrimitive shape;
  shape.kind = kind;
  shape.friction = primitive.shape.friction;
  return shape;
}

ContactPrimitive convexShape(const ScenePrimitive& primitive, const TriangleMesh& given,
                             PrimitiveBodies& made) {
  ContactPrimitive shape = madeOf(primitive, PrimitiveKind::kConvex);
  const auto [mesh, repair] = orientSurface(given);
  for (const std::string& line : repair.lines())
    made.warnings.push_back(fmt::format("{}: {}", primitive.file.filename().string(), line));
  try {
    shape.convex = std::make_shared<const ConvexBody>(convexBody(mesh));
  } catch (const Error& error) {
    throw Error(error.what(), primitive.where, "kind = \"mesh\" takes meshes that are not convex");
  }
  return shape;
}

/// Warns when body vertices lie on a static field. A renderer takes such vertices for parts of a skinned body
/// (transport/body_binding.h) and draws them where the field is.
void warnOfTouching(const TriangleMesh& body, const DistanceField& field, const std::string& name,
                    std::vector<std::string>& warnings) {
  const float near = 4 * field.grid.cell;
  const auto touching = std::count_if(body.positions.begin(), body.positions.end(),
                                      [&](const Vec3& p) { return std::fabs(field.at(p).distance) < near; });
  if (touching > 0)
    warnings.push_back(
        fmt::format("{} vertices of the body are within {:.3g} mm of {}, which does not follow the head: "
                    "they are drawn there when the head moves; keep them apart, or let it follow the head",
                    touching, 1e3 * static_cast<double>(near), name));
}

/// The body for this primitive; created if needed.
PrimitiveBody& bodyFor(const ScenePrimitive& primitive, std::vector<PrimitiveBody>& bodies) {
  const bool follows_head = primitive.joint.empty() && primitive.follows_head;
  const auto shared = std::find_if(bodies.begin(), bodies.end(), [&](const PrimitiveBody& known) {
    return known.name.empty() && known.joint == primitive.joint && known.body.follows_head == follows_head;
  });
  if (primitive.name.empty() && shared != bodies.end()) return *shared;
  return bodies.emplace_back(PrimitiveBody{{{}, follows_head}, primitive.joint, primitive.name});
}

}  // namespace

void checkNames(const std::vector<ScenePrimitive>& primitives, const std::string& body_name) {
  std::map<std::string, std::string> named{{body_name, "[body]"}};  // name -> where it is defined
  for (const ScenePrimitive& primitive : primitives) {
    if (primitive.name.empty()) continue;
    const auto [first, is_new] = named.try_emplace(primitive.name, primitive.where);
    if (!is_new)
      throw Error("two bodies are called '" + primitive.name + "'", primitive.where,
                  fmt::format("give it a unique name: the other is {}", first->second));
  }
}

PrimitiveBodies primitiveBodies(const std::vector<ScenePrimitive>& primitives, const MeshBodyOptions& options,
                                const TriangleMesh& body, const BakeProgress& progress,
                                const BakeAnnouncement& bake_begins, const BakeLimits& limits) {
  PrimitiveBodies made;
  made.bodies = {{{{}, true}, "", ""}, {}};  // following the head, and static: always the first two
  for (size_t i = 0; i < primitives.size(); ++i) {
    ScenePrimitive primitive = primitives[i];
    const std::string name = primitive.file.filename().string();
    const bool stands = primitive.joint.empty() && !primitive.follows_head;
    const bool is_apart = stands && !primitive.name.empty();
    const Pose pose = is_apart ? extractPose(primitive.shape) : Pose{};
    ContactPrimitive shape = primitive.shape;
    ContentHash hash;
    if (shape.kind == PrimitiveKind::kConvex) {
      shape = convexShape(primitive, placedMesh(primitive, options.obj_units, made, hash), made);
    } else if (shape.kind == PrimitiveKind::kField) {
      FieldOptions own = options.field;
      if (primitive.cell > 0) own.cell = primitive.cell;
      SceneField baked = fieldOf(
          placedMesh(primitive, options.obj_units, made, hash), own, FieldCache(options.cache),
          [&](const std::string& what, double part) {
            const double done = static_cast<double>(i) + part;
            return !progress ||
                   progress(fmt::format("{}: {}", name, what), done / static_cast<double>(primitives.size()));
          },
          bakesOf(bake_begins, name), limits);
      (baked.trouble.empty() ? made.notes : made.warnings).push_back(name + ": " + baked.note);
      shape = madeOf(primitive, PrimitiveKind::kField);
      shape.field = std::make_shared<const DistanceField>(std::move(baked.field));
      for (const std::string& warning : baked.warnings)
        made.warnings.push_back(fmt::format("{}: {}", name, warning));
      if (is_apart || !primitive.joint.empty())
        setAside(shape);
      else if (stands)
        warnOfTouching(body, *shape.field, name, made.warnings);
    }
    checkPrimitive(shape, primitive.where);
    PrimitiveBody& of = bodyFor(primitive, made.bodies);
    of.body.primitives.push_back(std::move(shape));
    of.body.pose = pose;
    if (primitive.file.empty()) continue;
    hash.add(of.mesh_hash);  // of previous files
    of.mesh_hash = hash.value();
  }
  std::erase_if(made.bodies, [](const PrimitiveBody& none) { return none.body.primitives.empty(); });
  return made;
}

}  // namespace strandcast
