#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "groom/gltf_document.h"
#include "groom/gltf_report.h"
#include "groom/skeleton.h"

namespace strandcast {

/// A node of a scene.
struct GltfNode {
  uint64_t index;          ///< of the document's nodes
  int parent;              ///< place of its parent in sceneNodes(); -1 for a root
  bool is_visible = true;  ///< neither it nor what it hangs on is hidden (KHR_node_visibility)
};

/// The nodes of the default scene, or the first; of a file without scenes, of all trees. Parents come before
/// their children. Throws Error when the nodes make no tree. `report` is told of hidden meshes and of other
/// scenes.
std::vector<GltfNode> sceneNodes(const GltfDocument& document, GltfReport& report);

/// "nodes[7]", for errors.
std::string gltfNodePart(uint64_t node);

/// What places a node in its parent: its matrix, which few have,
std::optional<Placement> gltfNodeMatrix(const GltfDocument& document, const nlohmann::json& node,
                                        const std::string& part);
/// or its translation, rotation and scale. Throw Error naming `part`.
JointTransform gltfNodeTransform(const GltfDocument& document, const nlohmann::json& node,
                                 const std::string& part);

/// Where the copies of a node's mesh are within the node (EXT_mesh_gpu_instancing): one that is the node
/// itself where it has no such extension. Throws Error.
std::vector<JointTransform> gltfInstances(const GltfDocument& document, const nlohmann::json& node,
                                          const std::string& part);

/// Whether it has that extension.
bool hasInstances(const nlohmann::json& node);

}  // namespace strandcast
