#include "groom/skinned_mesh.h"

#include "core/error.h"
#include "groom/axes_and_units.h"
#include "groom/file_bytes.h"
#include "groom/gltf_mesh.h"
#include "groom/mesh_file.h"

namespace strandcast {

std::vector<Placement> SkinnedMesh::bindingsAt(std::span<const Placement> world) const {
  std::vector<Placement> out;
  out.reserve(bindings.size());
  for (const SkinBinding& binding : bindings) out.push_back(world[binding.joint] * binding.inverse_bind);
  return out;
}

std::vector<Vec3> SkinnedMesh::blended(std::span<const Placement> world) const {
  const std::vector<Placement> moves = bindingsAt(world);
  std::vector<Vec3> out;
  out.reserve(stored.size());
  for (size_t v = 0; v < stored.size(); ++v) {
    const Eigen::Vector3d from = stored[v].cast<double>();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& [binding, weight] : influences[v])
      if (weight > 0) sum += static_cast<double>(weight) * (moves[binding] * from);
    out.emplace_back(sum.cast<float>());
  }
  return out;
}

SkinnedMesh loadSkinnedMesh(const std::filesystem::path& file, const GroomReadOptions& options) {
  checkUnit(options.unit_meters);
  if (!isGltf(file)) throw Error("this format has no skins", file.string() + ", byte 0", "use .gltf or .glb");
  const std::vector<std::byte> bytes = readFileBytes(file);
  SkinnedMesh skin = readGltfSkin(bytes, file.string(), file.parent_path());
  warnOfGltfUnits(options, skin.report);
  std::array<Vec3, 3> axes{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  turnYUp(axes, options.up);
  const double unit = options.unit_meters > 0 ? static_cast<double>(options.unit_meters) : 1;
  for (int c = 0; c < 3; ++c)
    skin.skeleton.root.linear().col(c) = unit * axes[static_cast<size_t>(c)].cast<double>();
  skin.mesh.positions = skin.blended(skin.skeleton.place(skin.skeleton.rest()));
  scaleToMeters(skin.mesh.positions, 1, file.string());  // checks their size
  computeNormals(skin.mesh);
  return skin;
}

}  // namespace strandcast
