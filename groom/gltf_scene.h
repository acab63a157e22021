#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "groom/gltf_document.h"

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

}  // namespace strandcast
