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

GltfTransform localTransform(const GltfDocument& document, const json& node, const std::string& part) {
  if (const auto matrix = document.numbers(node, "matrix", 16, part))
    return Eigen::Map<const Eigen::Matrix4f>(matrix->data());  // column-major, as Eigen is
  Eigen::Affine3f local = Eigen::Affine3f::Identity();
  if (const auto t = document.numbers(node, "translation", 3, part))
    local.translate(Eigen::Vector3f((*t)[0], (*t)[1], (*t)[2]));
  if (const auto r = document.numbers(node, "rotation", 4, part)) {
    const Eigen::Quaternionf rotation((*r)[3], (*r)[0], (*r)[1], (*r)[2]);
    if (!(rotation.norm() > 0)) document.fail("the rotation has no length", part);
    local.rotate(rotation.normalized());
  }
  if (const auto s = document.numbers(node, "scale", 3, part))
    local.scale(Eigen::Vector3f((*s)[0], (*s)[1], (*s)[2]));
  return local.matrix();
}

TriangleMesh placedByNodes(const GltfDocument& document, const std::vector<GltfNode>& nodes) {
  GltfPrimitives primitives(document);
  std::vector<GltfTransform> to_world;
  for (const GltfNode& visit : nodes) {
    const json& node = document.entry("nodes", visit.index, "a scene or node");
    const std::string part = gltfNodePart(visit.index);
    const GltfTransform parent = visit.parent < 0 ? GltfTransform(GltfTransform::Identity())
                                                  : to_world[static_cast<size_t>(visit.parent)];
    to_world.emplace_back(parent * localTransform(document, node, part));
    const GltfTransform& place = to_world.back();
    if (const auto mesh = document.unsignedMember(node, "mesh", part))
      primitives.add(*mesh, place, place.topLeftCorner<3, 3>().determinant() < 0, part);
  }
  return primitives.take();
}

}  // namespace

TriangleMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name,
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
  return mesh;
}

TriangleMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name) {
  return readGltfMesh(bytes, name, std::nullopt);
}

}  // namespace strandcast
