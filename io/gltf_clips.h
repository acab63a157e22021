#pragma once
#include <cstdint>
#include <map>
#include <utility>

#include "io/gltf_primitives.h"
#include "io/gltf_report.h"
#include "io/skinned_mesh.h"

namespace strandcast {

/// Nodes that the animations of a document may move.
struct GltfMovable {
  std::map<uint64_t, uint32_t> joints;   ///< node -> joint of the skeleton
  std::map<uint64_t, GltfMorph> meshes;  ///< node -> morph targets of its mesh
};

/// Morph targets that clips play: (node, number of the target) -> index into SkinnedMesh::targets.
using GltfPlayed = std::map<std::pair<uint64_t, size_t>, uint32_t>;

/// Reads the animations into SkinnedMesh::clips. Morph targets whose weight ever differs from that at rest
/// are added to SkinnedMesh::targets, still without vertices. An animation that cannot be read is left out
/// and reported; so is a single channel of weights that cannot be read.
GltfPlayed readGltfClips(const GltfDocument& document, const GltfMovable& movable, GltfReport& report,
                         SkinnedMesh& into);

}  // namespace strandcast
