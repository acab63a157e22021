#include "io/skinned_mesh.h"

#include <map>
#include <set>

#include "core/error.h"
#include "io/axes_and_units.h"
#include "io/file_bytes.h"
#include "io/gltf_mesh.h"
#include "io/mesh_file.h"

namespace strandcast {

std::vector<Placement> SkinnedMesh::bindingsAt(std::span<const Placement> world,
                                               std::span<const float> weights) const {
  std::vector<Placement> out;
  out.reserve(bindings.size() + target_bindings.size());
  for (const SkinBinding& binding : bindings) out.push_back(world[binding.joint] * binding.inverse_bind);
  for (const auto& [target, binding] : target_bindings) {
    const double change =
        weights.empty() ? 0
                        : static_cast<double>(weights[target]) - static_cast<double>(targets[target].rest);
    Placement moved;
    moved.linear() = change * out[binding].linear();
    moved.translation().setZero();
    out.push_back(moved);
  }
  return out;
}

std::vector<Vec3> SkinnedMesh::blended(std::span<const Placement> world,
                                       std::span<const float> weights) const {
  const std::vector<Placement> moves = bindingsAt(world);
  std::vector<Vec3> shaped;
  if (!weights.empty() && !targets.empty()) {
    shaped = stored;
    for (size_t t = 0; t < targets.size(); ++t)
      if (const float change = weights[t] - targets[t].rest; change != 0)
        for (const auto& [vertex, by] : targets[t].moves) shaped[vertex] += change * by;
  }
  std::vector<Vec3> out;
  out.reserve(stored.size());
  for (size_t v = 0; v < stored.size(); ++v) {
    const Eigen::Vector3d from = (shaped.empty() ? stored : shaped)[v].cast<double>();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& [binding, weight] : influences[v])
      if (weight > 0) sum += static_cast<double>(weight) * (moves[binding] * from);
    out.emplace_back(sum.cast<float>());
  }
  return out;
}

std::vector<float> SkinnedMesh::restWeights() const {
  std::vector<float> weights;
  for (const MorphTarget& target : targets) weights.push_back(target.rest);
  return weights;
}

void SkinnedMesh::bindTargets() {
  target_bindings.clear();
  for (uint32_t t = 0; t < targets.size(); ++t) {
    std::set<uint32_t> moved;
    for (const MorphTarget::Move& move : targets[t].moves)
      for (const auto& [binding, weight] : influences[move.vertex])
        if (weight > 0) moved.insert(binding);
    for (const uint32_t binding : moved) target_bindings.push_back({t, binding});
  }
}

void SkinnedMesh::keepTargets(SkeletonClip& clip) {
  std::vector<MorphTarget> kept;
  std::map<uint32_t, uint32_t> numbers;
  for (MorphChannel& channel : clip.morphs) {
    const auto [known, is_new] = numbers.try_emplace(channel.target, static_cast<uint32_t>(kept.size()));
    if (is_new) kept.push_back(std::move(targets[channel.target]));
    channel.target = known->second;
  }
  targets = std::move(kept);
  bindTargets();
}

SkinnedMesh loadSkinnedMesh(const std::filesystem::path& file, const GroomReadOptions& options,
                            BodyTargets targets) {
  checkUnit(options.unit_meters);
  if (!isGltf(file)) throw Error("this format has no skins", file.string() + ", byte 0", "use .gltf or .glb");
  const std::vector<std::byte> bytes = readFileBytes(file);
  SkinnedMesh skin = readGltfSkin(bytes, file.string(), besideFile(file), {}, targets);
  warnOfGltfUnits(options, skin.report);
  std::array<Vec3, 3> axes{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  rotateToYUp(axes, options.up);
  const double unit = options.unit_meters > 0 ? static_cast<double>(options.unit_meters) : 1;
  for (int c = 0; c < 3; ++c)
    skin.skeleton.root.linear().col(c) = unit * axes[static_cast<size_t>(c)].cast<double>();
  skin.mesh.positions = skin.blended(skin.skeleton.worldTransforms(skin.skeleton.rest()));
  scaleToMeters(skin.mesh.positions, 1, file.string());  // throws Error on positions out of range
  warnOfMeshSize(skin.mesh, static_cast<float>(unit), skin.report);
  computeNormals(skin.mesh);
  return skin;
}

}  // namespace strandcast
