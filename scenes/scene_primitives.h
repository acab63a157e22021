#pragma once
#include <cstdint>
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
  bool follows_head = true;  ///< else it stands, or goes with `joint`
  /// Of a skinned body: it goes with it from where it is placed, which is as the body is at rest. Empty =
  /// none.
  std::string joint;
  std::string name;  ///< that commands know it by, as a body of its own; empty = none
  /// Mesh of a convex body or of a field, which is turned by `rotation`, then moved by `a`.
  std::filesystem::path file;
  /// Of that file; unit 0 and kAuto = metres and Y up of glTF, of .obj those of the hair.
  GroomReadOptions units;
  /// Folder that `file` is relative to and that it and its buffers are read beneath (readBeneath); empty =
  /// they may be anywhere.
  std::filesystem::path beneath;
  float cell = 0;     ///< m, of a field; 0 = the body's
  std::string where;  ///< for errors: file and line
};

/// How meshes of further bodies become them, in a scene and in a daemon that casts it.
struct MeshBodyOptions {
  GroomReadOptions obj_units;   ///< of .obj files that have none of their own: those of the hair
  FieldOptions field;           ///< the hair's radius, and the cell of meshes that have none of their own
  std::filesystem::path cache;  ///< folder of baked fields; empty = every time anew
};

/// A body that is made of one or more primitives.
struct PrimitiveBody {
  RigidBody body;
  std::string joint;  ///< that it goes with; its pose is from where that is at rest
  std::string name;   ///< of the one that it is made of
  /// Hash of the meshes that its shapes are made of, in metres and as their files have them; 0 = of none.
  uint64_t mesh_hash = 0;
};

/// What is made of the primitives of a scene.
struct PrimitiveBodies {
  /// Where there are such shapes, one that follows the head, one that stands, and one for each joint; and
  /// each that has a name. That one, where it stands, has its origin and its axes in its pose: a move takes
  /// it to where it is told.
  std::vector<PrimitiveBody> bodies;
  std::vector<std::string> notes, warnings;  ///< a line each
};

/// Throws Error where two primitives have one name, or one that of the body which hair grows on.
void checkNames(const std::vector<ScenePrimitive>& primitives, const std::string& body_name);

/// Reads the meshes of `primitives`. `body`: the mesh that is drawn, may be empty.
/// Throws Error as loadMesh, convexBody, FieldBaker and checkPrimitive do; BakeStopped.
PrimitiveBodies primitiveBodies(const std::vector<ScenePrimitive>& primitives, const MeshBodyOptions& options,
                                const TriangleMesh& body, const BakeProgress& progress,
                                const BakeAnnouncement& bake_begins = {}, const BakeLimits& limits = {});

}  // namespace strandcast
