#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/simulation.h"
#include "groom/groom_file.h"
#include "groom/procedural_groom.h"
#include "scenes/field_cache.h"
#include "scenes/head_motion.h"
#include "scenes/part_materials.h"
#include "scenes/part_pins.h"
#include "scenes/scene_primitives.h"
#include "scenes/skinned_body.h"

namespace strandcast {

/// What stands for a body mesh in collisions.
enum class BodyContact {
  kField,   ///< its signed distance field: the body as it is
  kSpheres  ///< spheres fitted into it, shrunk out of the hair at rest: quick to make, coarse
};

/// What a scene is made from: a named procedural scene, or groom files with an optional body.
struct SceneOptions {
  std::string name = "straight";             ///< one of sceneList(); used when `groom` is empty
  std::vector<std::filesystem::path> groom;  ///< groom files, read into one groom
  std::filesystem::path body;                ///< body mesh; empty = none (or the procedural body)
  std::string body_name;                     ///< that commands know it by; empty = none
  GroomReadOptions units;       ///< of groom files, and of .obj bodies that have none of their own
  GroomReadOptions body_units;  ///< of the body file, whatever its format says; as GroomReadOptions
  float clip_unit_meters = 0;   ///< metres per unit of .bvh clips, of body and head; 0 = found, see unitOf()
  std::string motion;           ///< see headMotion(); empty = the scene's own
  uint64_t seed = 1;
  int strands = 0;   ///< procedural: strands grown; files: guides chosen; 0 = the scene's own, all
  int vertices = 0;  ///< per strand; 0 = as they are
  float length = 0;  ///< m, procedural only; 0 = the scene's own
  std::vector<ScenePrimitive> primitives;  ///< further bodies
  BodyContact body_contact = BodyContact::kField;
  /// Of a glTF body with a skin; empty = it is rigid and moves with the head.
  std::optional<SkinnedMotion> skinned;
  float body_cell = 0;                                ///< m, of the fields of meshes; 0 = defaultFieldCell
  std::filesystem::path field_cache;                  ///< folder of baked fields; empty = every time anew
  int body_primitives = 24;                           ///< spheres at most, fitted into a body mesh
  float body_friction = ContactPrimitive().friction;  ///< Coulomb coefficient, of the body and its parts
  std::vector<MaterialRule> materials;                ///< what the hair of its parts is made of
  bool hair_radius_is_set = false;                    ///< by the user: materials do not say it
  std::vector<PinRule> pins;                          ///< what of its parts moves with bones
  BakeAnnouncement bake_begins;                       ///< may be empty; its line names the body
  /// Told what there is to warn of before bodies are baked, which may take minutes; such lines are then not
  /// in Scene::warnings. May be empty.
  std::function<void(const std::string& warning)> warns_early;
};

/// All that a simulation and a renderer need, made once and shared by daemon, tests and benchmarks.
struct Scene {
  std::string name;
  Groom groom;
  std::vector<std::string>
      part_names;                   ///< by StrandSet::parts: stems of the groom files, or the scene's name
  std::vector<Material> materials;  ///< by part
  std::vector<PinRule> pins;
  TriangleMesh body;                ///< may be empty
  std::vector<float> head_weights;  ///< per body vertex, 1 = moves with the head; empty = all do
  std::vector<RigidBody> bodies;
  /// The first of `bodies` are the one that hair grows on, which commands know by a name; 0 and empty = none.
  size_t named_parts = 0;
  std::string body_name;
  std::map<std::string, BodyId> named_bodies;  ///< others with a name; indices into bodies
  /// PrimitiveBody::mesh_hash of those that are made of meshes; of all without a name in one.
  std::map<std::string, uint64_t> mesh_hashes;
  Vec3 head_pivot = Vec3::Zero();  ///< m, joint of head and neck, for head motions
  HeadMotion motion;               ///< of a skinned body with a clip: relative to where the clip has the head
  std::shared_ptr<SkinnedBody> skinned;  ///< null unless the body is skinned: moveTo() moves it
  Parameters parameters;
  MeshBodyOptions mesh_bodies;        ///< of bodies that are to be added to it
  std::vector<std::string> notes;     ///< what was found and done while making it, a line each
  std::vector<std::string> warnings;  ///< likewise, what did not go well
};

struct SceneInfo {
  std::string name, description;
};
const std::vector<SceneInfo>& sceneList();

/// Tells how far a long job has come: what it does now, and the part done, 0 to 1; false stops it.
using Progress = std::function<bool(const std::string& what, double part)>;

/// The hair that a procedural scene grows. Throws Error on an unknown scene.
ProceduralGroomOptions proceduralGroomOf(const SceneOptions& options);

/// The strands of a scene with their materials and pins, as they are made: not sag-free. Throws Error.
StrandModel sceneModel(const Scene& scene);

/// Throws Error on bad input, a body without a groom file and a length with one among it, BakeStopped when
/// `progress` says so.
Scene makeScene(const SceneOptions& options, const Progress& progress = {});

}  // namespace strandcast
