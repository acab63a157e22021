#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/file_report.h"
#include "io/gltf_document.h"
#include "io/skeleton.h"

namespace strandcast {

/// A node of a scene.
struct GltfNode {
  uint64_t index;          ///< of the document's nodes
  int parent;              ///< index of the parent in the result of sceneNodes(); -1 for a root
  bool is_visible = true;  ///< neither the node nor an ancestor is hidden (KHR_node_visibility)
};

/// The nodes of the default scene, else of the first scene; of a file without scenes, of all trees. Parents
/// come before their children. Reports hidden meshes and other scenes to `report`. Throws Error when the
/// nodes do not form a tree.
std::vector<GltfNode> sceneNodes(const GltfDocument& document, GltfReport& report);

/// "nodes[7]", for errors.
std::string gltfNodePart(uint64_t node);

/// The matrix of a node relative to its parent; empty when the node has none. Throws Error naming `part`.
std::optional<Placement> gltfNodeMatrix(const GltfDocument& document, const nlohmann::json& node,
                                        const std::string& part);
/// The translation, rotation and scale of a node relative to its parent. Throws Error naming `part`.
JointTransform gltfNodeTransform(const GltfDocument& document, const nlohmann::json& node,
                                 const std::string& part);

/// Placements of the copies of a node's mesh, relative to the node (EXT_mesh_gpu_instancing). One identity
/// transform for a node without the extension. Throws Error.
std::vector<JointTransform> gltfInstances(const GltfDocument& document, const nlohmann::json& node,
                                          const std::string& part);

/// Whether the node has the extension EXT_mesh_gpu_instancing.
bool hasInstances(const nlohmann::json& node);

}  // namespace strandcast
