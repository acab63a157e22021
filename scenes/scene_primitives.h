#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/contact_primitive.h"
#include "core/simulation.h"
#include "groom/groom_file.h"
#include "scenes/field_cache.h"

namespace strandcast {

/// What one [[body.primitives]] table says: a further body that hair collides with.
struct ScenePrimitive {
  /// Of kConvex and kField only `a`, `rotation` and `friction`: what they consist of is made of `file`.
  ContactPrimitive shape;
  bool follows_head = true;  ///< else it stands
  /// Mesh of a convex body or of a field, which is turned by `rotation`, then moved by `a`.
  std::filesystem::path file;
  float cell = 0;     ///< m, of a field; 0 = the body's
  std::string where;  ///< for errors: file and line
};

/// How the meshes of primitives are read.
struct MeshUnits {
  GroomReadOptions read;
  float obj_meters = 0;  ///< unit of an .obj where `read` has none: that of its hair; 0 = guessed
};

/// How meshes of further bodies become them, in a scene and in a daemon that casts it.
struct MeshBodyOptions {
  MeshUnits units;
  FieldOptions field;           ///< the hair's radius, and the cell of meshes that have none of their own
  std::filesystem::path cache;  ///< folder of baked fields; empty = every time anew
};

/// What is made of the primitives of a scene.
struct PrimitiveBodies {
  std::vector<RigidBody> bodies;  ///< one that follows the head, one that stands, where there are such shapes
  std::vector<std::string> notes, warnings;  ///< a line each
};

/// Reads the meshes of `primitives`. `body`: the mesh that is drawn, may be empty.
/// Throws Error as loadMesh, convexBody, FieldBaker and checkPrimitive do; BakeStopped.
PrimitiveBodies primitiveBodies(const std::vector<ScenePrimitive>& primitives, const MeshBodyOptions& options,
                                const TriangleMesh& body, const BakeProgress& progress,
                                const BakeAnnouncement& bake_begins = {}, const BakeLimits& limits = {});

}  // namespace strandcast
