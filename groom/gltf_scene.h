#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "groom/gltf_document.h"
#include "groom/skeleton.h"

namespace strandcast {

/// A node of a scene.
struct GltfNode {
  uint64_t index;  ///< of the document's nodes
  int parent;      ///< place of its parent in sceneNodes(); -1 for a root
};

/// The nodes of the default scene, or the first; of a file without scenes, of all trees. Parents come before
/// their children. Throws Error when the nodes make no tree.
std::vector<GltfNode> sceneNodes(const GltfDocument& document);

/// "nodes[7]", for errors.
std::string gltfNodePart(uint64_t node);

/// What places a node in its parent: its matrix, which few have,
std::optional<Placement> gltfNodeMatrix(const GltfDocument& document, const nlohmann::json& node,
                                        const std::string& part);
/// or its translation, rotation and scale. Throw Error naming `part`.
JointTransform gltfNodeTransform(const GltfDocument& document, const nlohmann::json& node,
                                 const std::string& part);

}  // namespace strandcast
