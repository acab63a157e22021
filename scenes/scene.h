#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "collision/field_cache.h"
#include "core/simulation.h"
#include "groom/procedural_groom.h"
#include "io/groom_file.h"
#include "scenes/head_motion.h"
#include "scenes/part_rules.h"
#include "scenes/scene_primitives.h"
#include "scenes/skinned_body.h"

namespace strandcast {

/// Collision representation of a body mesh.
enum class BodyContact {
  kField,    ///< its signed distance field: accurate
  kSpheres,  ///< spheres fitted into it, shrunk until no hair at rest is inside: quick to make, coarse
  kNone      ///< no contact: hair passes through the body. For looking at a scene without baking a field
};

/// Which strands of groom files are guides, which are simulated. Hair of the artist follows them, or hair
/// grows from them.
struct GuideChoice {
  /// Strands of other files are the guides, and all strands of the groom follow them.
  std::filesystem::path file;
  /// Share of the groom's strands that are guides, spread evenly, 0 to 1; all strands follow them. 0: none is
  /// given.
  double share = 0;
  /// All strands are guides, also where files mark some. Default: where some strands are marked these are the
  /// guides, and the others follow them; else all are guides.
  bool all = false;
};

/// Input of a scene: a named procedural scene, or groom files with an optional body.
struct SceneOptions {
  std::string name = "straight";             ///< one of sceneList(); used when `groom` is empty
  std::vector<std::filesystem::path> groom;  ///< groom files, read into one groom
  std::vector<std::filesystem::path> hairs;  ///< files of hairs that follow the strands of `groom`
  GuideChoice guides;                        ///< default where there are `hairs`: all strands of `groom`
  std::filesystem::path body;                ///< body mesh; empty: none (or the procedural body)
  std::string body_name;                     ///< name in commands; empty: none
  GroomReadOptions units;       ///< of groom files, and of .obj bodies without units of their own
  GroomReadOptions body_units;  ///< of the body file; overrides its format
  float clip_unit_meters = 0;   ///< metres per unit of .bvh clips, of body and head; 0: deduced, see unitOf()
  std::string motion;           ///< see headMotion(); empty: that of the scene
  uint64_t seed = 1;
  int strands = 0;   ///< procedural: strands grown; files: guides chosen; 0: the scene's default, or all
  int vertices = 0;  ///< per strand; 0: unchanged
  float length = 0;  ///< m, procedural only; 0: the scene's default
  std::vector<ScenePrimitive> primitives;  ///< further bodies
  BodyContact body_contact = BodyContact::kField;
  /// Of a glTF body with a skin; empty: the body is rigid and moves with the head.
  std::optional<SkinnedMotion> skinned;
  float body_cell = 0;                                ///< m, of the fields of meshes; 0: defaultFieldCell
  std::filesystem::path field_cache;                  ///< folder of baked fields; empty: no cache
  int body_primitives = 24;                           ///< limit of spheres fitted into a body mesh
  float body_friction = ContactPrimitive().friction;  ///< Coulomb coefficient, of the body and its parts
  std::vector<MaterialRule> materials;                ///< materials of parts
  bool hair_radius_is_set = false;  ///< the user sets hair_radius: no note that materials determine it
  std::vector<PinRule> pins;        ///< stretches of strands that move with bones
  BakeAnnouncement bake_begins;     ///< may be empty; its line names the body
  /// Called with the warnings known before bodies are baked, which may take minutes; these are then not in
  /// Scene::warnings. May be empty.
  std::function<void(const std::string& warning)> warns_early;
};

/// Hairs of the artist, which follow the guides of a scene.
struct SceneHairs {
  StrandSet strands;                  ///< at rest, m, groom frame; in the order of their first guides
  std::vector<HairBinding> bindings;  ///< per strand
  std::string source;                 ///< their files and option, for errors
};

/// Input of a simulation and a renderer, shared by daemon, tests and benchmarks.
struct Scene {
  std::string name;
  Groom groom;       ///< its strands are the guides
  SceneHairs hairs;  ///< none: hair grows from the guides
  /// By StrandSet::parts: stems of the groom files, or the scene's name.
  std::vector<std::string> part_names;
  std::vector<Material> materials;  ///< by part
  std::vector<PinRule> pins;
  TriangleMesh body;                ///< may be empty
  std::vector<float> head_weights;  ///< per body vertex, 1: moves with the head; empty: all move with it
  std::vector<RigidBody> bodies;
  /// The first `named_parts` of `bodies` form the body on which hair grows; `body_name` is its name in
  /// commands. 0 and empty: none.
  size_t named_parts = 0;
  std::string body_name;
  std::map<std::string, BodyId> named_bodies;  ///< other bodies with a name; indices into `bodies`
  /// PrimitiveBody::mesh_hash by name, of bodies made from meshes; bodies without a name share one entry,
  /// with an empty name.
  std::map<std::string, uint64_t> mesh_hashes;
  Vec3 head_pivot = Vec3::Zero();  ///< m, joint of head and neck, for head motions
  HeadMotion motion;               ///< of a skinned body with a clip: relative to the clip's pose of the head
  std::shared_ptr<SkinnedBody> skinned;  ///< null unless the body is skinned; moveTo() moves it
  BodyRig body_rig;                      ///< of the body's file, also of what the scene does not move
  Parameters parameters;
  MeshBodyOptions mesh_bodies;        ///< for bodies that are added later
  std::vector<std::string> notes;     ///< findings and actions while making the scene, one line each
  std::vector<std::string> warnings;  ///< problems, one line each
};

/// A named procedural scene.
struct SceneInfo {
  std::string name, description;
};
/// The named procedural scenes.
const std::vector<SceneInfo>& sceneList();

/// Reports the progress of a long job: its current activity, and the share done, 0 to 1. Returning false
/// stops it.
using Progress = std::function<bool(const std::string& what, double part)>;

/// The options of a procedural scene's groom. Throws Error on an unknown scene.
ProceduralGroomOptions proceduralGroomOf(const SceneOptions& options);

/// The parameters that makeScene() gives a scene, before materials thicker than its hair_radius raise that.
/// Throws Error on an unknown scene.
Parameters sceneParameters(const SceneOptions& options);

/// The strands of a scene with their materials and pins, before the sag-free correction. Throws Error.
StrandModel sceneModel(const Scene& scene);

/// Makes a scene. Throws Error on bad input, on a body without a groom file, and on a length together with a
/// groom file; BakeStopped when `progress` returns false.
Scene makeScene(const SceneOptions& options, const Progress& progress = {});

}  // namespace strandcast
