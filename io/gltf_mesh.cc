// Triangle meshes from glTF 2.0: all triangle primitives of the scene, placed by its nodes or by the joints
// of its skin.
#include "io/gltf_mesh.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/gltf_document.h"
#include "io/gltf_extensions.h"
#include "io/gltf_primitives.h"
#include "io/gltf_scene.h"
#include "io/mesh_file.h"

namespace strandcast {
namespace {

using nlohmann::json;

TriangleMesh placedByNodes(const GltfDocument& document, const std::vector<GltfNode>& nodes,
                           GltfReport& report) {
  GltfPrimitives primitives(document, report);
  GltfMorphs morphs(document, report);
  std::vector<Placement> to_world;
  for (const GltfNode& visit : nodes) {
    const json& node = document.entry("nodes", visit.index, "a scene or node");
    const std::string part = gltfNodePart(visit.index);
    const Placement parent =
        visit.parent < 0 ? Placement::Identity() : to_world[static_cast<size_t>(visit.parent)];
    const std::optional<Placement> matrix = gltfNodeMatrix(document, node, part);
    to_world.push_back(parent * (matrix ? *matrix : gltfNodeTransform(document, node, part).placement()));
    const auto mesh = document.unsignedMember(node, "mesh", part);
    if (!mesh || !visit.is_visible) continue;
    const GltfMorph morph = morphs.of(node, *mesh, part);
    const bool is_copied = hasInstances(node);
    const std::vector<JointTransform> instances = gltfInstances(document, node, part);
    if (instances.empty()) report.leaveOut("meshes of no instance", part);
    for (const JointTransform& instance : instances) {
      GltfTransform place = GltfTransform::Identity();
      const Placement at = is_copied ? to_world.back() * instance.placement() : to_world.back();
      place.topRows<3>() = at.matrix().cast<float>();
      primitives.add(*mesh, morph, place, place.topLeftCorner<3, 3>().determinant() < 0, part);
    }
  }
  return primitives.take();
}

}  // namespace

ReadMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name,
                      const ReadBeside& read_beside, const GltfLimits& limits) {
  const GltfDocument document(bytes, name, read_beside, limits);
  GltfReport report, of_nodes;
  tellOfAsset(document, of_nodes);
  const std::vector<GltfNode> nodes = sceneNodes(document, of_nodes);
  const bool skinned = std::any_of(nodes.begin(), nodes.end(), [&](const GltfNode& visit) {
    const json& node = document.entry("nodes", visit.index, "a scene or node");
    return node.contains("mesh") && node.contains("skin");
  });
  TriangleMesh mesh = skinned ? skinAtRest(document, report) : placedByNodes(document, nodes, of_nodes);
  mesh.name = name;
  computeNormals(mesh);
  return {std::move(mesh), (skinned ? report : of_nodes).report()};
}

ReadMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name, const GltfLimits& limits) {
  return readGltfMesh(bytes, name, ReadBeside(), limits);
}

}  // namespace strandcast
