#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "core/triangle_mesh.h"
#include "groom/gltf_limits.h"
#include "groom/groom_file.h"

namespace strandcast {

/// A triangle mesh of a file, with what its reader has to say of it.
struct ReadMesh {
  TriangleMesh mesh;
  FileReport report;
};

/// Beginnings of the names of groups that are no part of a body, as MakeHuman has them.
inline const std::vector<std::string> kSkippedGroups{"helper-", "joint-"};

/// Whether a file is glTF 2.0 by its extension: .gltf or .glb.
bool isGltf(const std::filesystem::path& file);

/// Units and axis to read a mesh with: each as `given` for it where it is; else of an .obj file as `obj`. A
/// glTF file is in metres with Y up, whatever .obj files are in.
GroomReadOptions meshUnits(const std::filesystem::path& file, const GroomReadOptions& given,
                           const GroomReadOptions& obj);

/// Tells `report` where what is given for a glTF file is not what its format says: metres, Y up.
void warnOfGltfUnits(const GroomReadOptions& given, FileReport& report);

/// Tells `report` where a mesh in metres, of a file in this unit, is below 1 mm or above 20 m large.
void warnOfMeshSize(const TriangleMesh& mesh, float unit_meters, FileReport& report);

/// Reads a triangle mesh from .obj or glTF 2.0 (.gltf, .glb) by extension, in metres, Y up, with normals.
/// Throws Error (file, line, byte offset or part, remedy) on bad input. Without `unit_meters` a glTF file is
/// in metres, as its specification says, and the unit of an .obj file is guessed as a groom's is: pass
/// GroomReport::unit_meters to give an .obj body the scale of its hair (meshUnits). Warns of a size that no
/// body has. The buffers that a .gltf names are read from its own folder and nowhere else. With `beneath`,
/// `file` is relative to that folder: it and its buffers are read beneath it and nowhere else, whatever links
/// there are (readBeneath).
ReadMesh loadMesh(const std::filesystem::path& file, const GroomReadOptions& options,
                  const std::vector<std::string>& skip_groups = kSkippedGroups,
                  const std::filesystem::path& beneath = {});

/// The same from memory, in the file's units and axes; `name` stands for the file in errors and names the
/// mesh. The fuzzers' entry points. Triangles with a corner twice are left out; there is at least one
/// triangle.
///
/// OBJ: polygons are cut into triangles, see PolygonCutter. Faces under a `g` or `o` name that starts with
/// one of `skip_groups`, of fewer than three different corners or with a position that is not finite are left
/// out, and so are vertices that no triangle uses. An index beyond the file's vertices is an Error.
ReadMesh readObjMesh(std::span<const std::byte> bytes, const std::string& name,
                     const std::vector<std::string>& skip_groups = {});
/// glTF: all triangle lists, strips and fans of the default scene, with morph targets at their weights at
/// rest, placed by their nodes and the instances of these, or, where there is a skin, by the joints at rest
/// (as readGltfSkin(), whose demands they must meet, but for clips). External buffers, compressed meshes and
/// required extensions that are not read are refused; images are never opened. docs/formats.md has the rest.
ReadMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name,
                      const GltfLimits& limits = {});

}  // namespace strandcast
