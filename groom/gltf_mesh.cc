// Triangle meshes from glTF 2.0: every triangle primitive of the scene, placed by its nodes, or by the joints
// of its skin.
#include "groom/gltf_mesh.h"

#include <fmt/format.h>

#include <algorithm>

#include "groom/gltf_document.h"
#include "groom/gltf_primitives.h"
#include "groom/gltf_scene.h"
#include "groom/mesh_file.h"

namespace strandcast {
namespace {

using nlohmann::json;

TriangleMesh placedByNodes(const GltfDocument& document, const std::vector<GltfNode>& nodes) {
  GltfPrimitives primitives(document);
  std::vector<Placement> to_world;
  for (const GltfNode& visit : nodes) {
    const json& node = document.entry("nodes", visit.index, "a scene or node");
    const std::string part = gltfNodePart(visit.index);
    const Placement parent =
        visit.parent < 0 ? Placement::Identity() : to_world[static_cast<size_t>(visit.parent)];
    const std::optional<Placement> matrix = gltfNodeMatrix(document, node, part);
    to_world.push_back(parent * (matrix ? *matrix : gltfNodeTransform(document, node, part).placement()));
    if (const auto mesh = document.unsignedMember(node, "mesh", part)) {
      GltfTransform place = GltfTransform::Identity();
      place.topRows<3>() = to_world.back().matrix().cast<float>();
      primitives.add(*mesh, place, place.topLeftCorner<3, 3>().determinant() < 0, part);
    }
  }
  return primitives.take();
}

}  // namespace

ReadMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name,
                      const std::optional<std::filesystem::path>& folder) {
  const GltfDocument document(bytes, name, folder);
  const std::vector<GltfNode> nodes = sceneNodes(document);
  const bool skinned = std::any_of(nodes.begin(), nodes.end(), [&](const GltfNode& visit) {
    const json& node = document.entry("nodes", visit.index, "a scene or node");
    return node.contains("mesh") && node.contains("skin");
  });
  TriangleMesh mesh = skinned ? skinAtRest(document) : placedByNodes(document, nodes);
  mesh.name = name;
  computeNormals(mesh);
  return {std::move(mesh), {}};
}

ReadMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name) {
  return readGltfMesh(bytes, name, std::nullopt);
}

}  // namespace strandcast
