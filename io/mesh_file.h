#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "io/groom_file.h"

namespace strandcast {

/// Limits on what one glTF file may expand to, however often its scene repeats a mesh and its clips their
/// data. A file above a limit is refused: without limits a few kilobytes could exhaust the memory. Genuine
/// bodies stay far below.
struct GltfLimits {
  uint64_t primitives = 2'000'000;
  uint64_t vertices = 20'000'000;
  uint64_t triangles = 40'000'000;
  uint64_t instances = 1'000'000;          ///< of nodes with EXT_mesh_gpu_instancing
  uint64_t target_vertices = 200'000'000;  ///< summed over the morph targets that are applied or played
  uint64_t clip_values = 100'000'000;      ///< numbers of all clips
  uint64_t accessor_bytes = 256'000'000;   ///< of one accessor that is sparse or has no bufferView
};

/// Names of what moves the mesh of a file besides its place, each once, whether it is read or not.
struct BodyRig {
  std::vector<std::string> joints;   ///< all nodes of the scene, where one of its meshes has a skin
  std::vector<std::string> targets;  ///< morph targets of its meshes
};

/// A triangle mesh read from a file, with the report of its reader.
struct ReadMesh {
  TriangleMesh mesh;
  FileReport report;
  BodyRig rig = {};  ///< empty but for glTF
};

/// Prefixes of the names of groups that are not part of a body (MakeHuman's convention).
inline const std::vector<std::string> kSkippedGroups{"helper-", "joint-"};

/// Whether the extension of a file is that of glTF 2.0: .gltf or .glb.
bool isGltf(const std::filesystem::path& file);

/// Units and axis with which to read a mesh. Values set in `given` apply to each file. An .obj file takes the
/// others from `obj`. A glTF file is in metres with Y up, whatever the .obj files are in.
GroomReadOptions meshUnits(const std::filesystem::path& file, const GroomReadOptions& given,
                           const GroomReadOptions& obj);

/// Warns in `report` when options given for a glTF file contradict its format: metres, Y up.
void warnOfGltfUnits(const GroomReadOptions& given, FileReport& report);

/// Warns in `report` when a mesh is below 1 mm or above 20 m large. `mesh` is in metres; `unit_meters` is the
/// unit of its file.
void warnOfMeshSize(const TriangleMesh& mesh, float unit_meters, FileReport& report);

/// Reads a triangle mesh from .obj or glTF 2.0 (.gltf, .glb) by extension, in metres, Y up, with normals.
/// Throws Error (file, line, byte offset or part, remedy) on bad input. Warns of a size that no body has.
///
/// Without `unit_meters` a glTF file is in metres, as its specification says. The unit of an .obj file is
/// then guessed like that of a groom; pass GroomReport::unit_meters to give an .obj body the scale of its
/// hair (meshUnits).
///
/// The buffers that a .gltf names are read from its own folder only. With `beneath`, `file` is relative to
/// that folder, and the file and its buffers are confined to it, links included (readBeneath).
ReadMesh loadMesh(const std::filesystem::path& file, const GroomReadOptions& options,
                  const std::vector<std::string>& skip_groups = kSkippedGroups,
                  const std::filesystem::path& beneath = {});

/// Readers from memory, in the file's units and axes; `name` stands for the file in errors and names the
/// mesh. The fuzzers' entry points. Triangles that use a vertex twice are left out. The result has at least
/// one triangle.
///
/// OBJ: polygons are cut into triangles, see PolygonCutter. Faces are left out that belong to a `g` or `o`
/// name with a prefix in `skip_groups`, have fewer than three different corners, or a position that is not
/// finite. Vertices that no triangle uses are left out, too. An index beyond the file's vertices is an Error.
ReadMesh readObjMesh(std::span<const std::byte> bytes, const std::string& name,
                     const std::vector<std::string>& skip_groups = {});
/// glTF: reads all triangle lists, strips and fans of the default scene, with morph targets at their weights
/// at rest. Meshes are placed by their nodes and instances, or, where there is a skin, by the joints at rest;
/// the file must then meet the demands of readGltfSkin(), except for clips. External buffers, compressed
/// meshes and unsupported required extensions are refused. Images are never opened. docs/formats.md has the
/// rest.
ReadMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name,
                      const GltfLimits& limits = {});

}  // namespace strandcast
