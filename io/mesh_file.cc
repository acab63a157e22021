#include "io/mesh_file.h"

#include <fmt/format.h>

#include "core/error.h"
#include "io/axes_and_units.h"
#include "io/file_bytes.h"
#include "io/gltf_mesh.h"

namespace strandcast {

bool isGltf(const std::filesystem::path& file) {
  const std::string extension = lowerExtension(file);
  return extension == ".glb" || extension == ".gltf";
}

GroomReadOptions meshUnits(const std::filesystem::path& file, const GroomReadOptions& given,
                           const GroomReadOptions& obj) {
  GroomReadOptions out = given;
  if (isGltf(file)) return out;
  if (out.unit_meters <= 0) out.unit_meters = obj.unit_meters;
  if (out.up == UpAxis::kAuto) out.up = obj.up;
  return out;
}

void warnOfGltfUnits(const GroomReadOptions& given, FileReport& report) {
  if (given.unit_meters > 0 && !isSameUnit(given.unit_meters, 1))
    report.warnings.push_back(
        fmt::format("glTF is in metres, a unit of {:g} m is taken as given", given.unit_meters));
  if (given.up == UpAxis::kX || given.up == UpAxis::kZ)
    report.warnings.push_back(fmt::format("in glTF Y is up, {} is taken as given", nameOf(given.up)));
}

void warnOfMeshSize(const TriangleMesh& mesh, float unit_meters, FileReport& report) {
  if (const float size = mesh.bounds().sizes().maxCoeff(); isUnlikelySize(size))
    report.warnings.push_back(
        fmt::format("with a unit of {:g} m it is {:.3g} m large: give its unit", unit_meters, size));
}

ReadBeside besideFile(const std::filesystem::path& file, const std::filesystem::path& beneath) {
  return [=](const std::filesystem::path& relative) {
    const std::filesystem::path named = file.parent_path() / relative;
    return beneath.empty() ? readFileBytes(named) : readBeneath(beneath, named);
  };
}

ReadMesh loadMesh(const std::filesystem::path& file, const GroomReadOptions& options,
                  const std::vector<std::string>& skip_groups, const std::filesystem::path& beneath) {
  checkUnit(options.unit_meters);
  const bool is_gltf = isGltf(file);
  if (!is_gltf && lowerExtension(file) != ".obj")
    throw Error("this is no known mesh format", file.string() + ", byte 0", "use .obj, .gltf or .glb");
  const std::vector<std::byte> bytes = beneath.empty() ? readFileBytes(file) : readBeneath(beneath, file);
  ReadMesh read = is_gltf ? readGltfMesh(bytes, file.string(), besideFile(file, beneath))
                          : readObjMesh(bytes, file.string(), skip_groups);
  if (is_gltf) warnOfGltfUnits(options, read.report);
  TriangleMesh& mesh = read.mesh;
  rotateToYUp(mesh.positions, options.up);
  float unit = options.unit_meters;
  if (unit == 0 && is_gltf) unit = 1;
  if (unit == 0) {
    unit = guessUnit(mesh.bounds());
    const float size = mesh.bounds().sizes().maxCoeff();
    read.report.warnings.push_back(fmt::format(
        "the unit is guessed: {:g} m, which makes the body {:.3g} m large; give its unit to be sure", unit,
        unit * size));
  }
  scaleToMeters(mesh.positions, unit, file.string());
  warnOfMeshSize(mesh, unit, read.report);
  computeNormals(mesh);
  return read;
}

}  // namespace strandcast
