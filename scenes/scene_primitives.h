#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "collision/field_cache.h"
#include "core/contact_primitive.h"
#include "core/simulation.h"
#include "io/groom_file.h"

namespace strandcast {

/// One [[body.primitives]] table: a further body with which hair collides.
struct ScenePrimitive {
  /// For kConvex and kField only `a`, `rotation` and `friction` are used; the geometry comes from `file`.
  ContactPrimitive shape;
  bool follows_head = true;  ///< else it is static, or moves with `joint`
  /// Joint of a skinned body that carries it. It is placed relative to the body at rest. Empty: none.
  std::string joint;
  std::string name;  ///< name in commands, as a body of its own; empty: none
  /// Mesh of a convex body or field, rotated by `rotation`, then translated by `a`.
  std::filesystem::path file;
  /// Units of `file`. Unit 0 and kAuto: metres and Y up for glTF, those of the hair for .obj.
  GroomReadOptions units;
  /// Folder to which `file` is relative and to which it and its buffers are confined (readBeneath). Empty: no
  /// restriction.
  std::filesystem::path beneath;
  float cell = 0;     ///< m, of a field; 0: that of the body
  std::string where;  ///< for errors: file and line
};

/// Options for meshes of further bodies, in a scene and in a running daemon.
struct MeshBodyOptions {
  GroomReadOptions obj_units;   ///< of .obj files without units of their own: those of the hair
  FieldOptions field;           ///< radius of the hair, and cell of meshes without a cell of their own
  std::filesystem::path cache;  ///< folder of baked fields; empty: no cache
};

/// A body made of one or more primitives.
struct PrimitiveBody {
  RigidBody body;
  std::string joint;  ///< joint that carries it; the pose is relative to the joint at rest
  std::string name;   ///< name of its primitive
  /// Hash of the meshes of its shapes, in metres and before placement; 0: it has no mesh.
  uint64_t mesh_hash = 0;
};

/// The bodies made from the primitives of a scene.
struct PrimitiveBodies {
  /// Where shapes need them: one body that follows the head, a static one, one per joint, and one per named
  /// primitive. A named static body has the primitive's position and rotation in its pose, so that a command
  /// can set the pose.
  std::vector<PrimitiveBody> bodies;
  std::vector<std::string> notes, warnings;  ///< a line each
};

/// Throws Error when two primitives have the same name, or one has the name of the body on which hair grows.
void checkNames(const std::vector<ScenePrimitive>& primitives, const std::string& body_name);

/// Reads the meshes of `primitives` and makes their bodies. `body`: the mesh that is drawn, may be empty.
/// Throws Error as loadMesh, convexBody, FieldBaker and checkPrimitive do; BakeStopped.
PrimitiveBodies primitiveBodies(const std::vector<ScenePrimitive>& primitives, const MeshBodyOptions& options,
                                const TriangleMesh& body, const BakeProgress& progress,
                                const BakeAnnouncement& bake_begins = {}, const BakeLimits& limits = {});

}  // namespace strandcast
