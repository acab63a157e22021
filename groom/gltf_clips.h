#pragma once
#include <cstdint>
#include <map>
#include <utility>

#include "groom/gltf_primitives.h"
#include "groom/gltf_report.h"
#include "groom/skinned_mesh.h"

namespace strandcast {

/// What the animations of a document may move.
struct GltfMovable {
  std::map<uint64_t, uint32_t> joints;   ///< node -> joint of the skeleton
  std::map<uint64_t, GltfMorph> meshes;  ///< node -> morph targets of its mesh
};

/// Morph targets that clips play: node and number of the target -> index in SkinnedMesh::targets.
using GltfPlayed = std::map<std::pair<uint64_t, size_t>, uint32_t>;

/// Reads the animations into SkinnedMesh::clips, and those morph targets that they ever give another weight
/// than at rest into SkinnedMesh::targets, as yet without vertices. An animation, or of one a channel of
/// weights, that cannot be read is left out, and said.
GltfPlayed readGltfClips(const GltfDocument& document, const GltfMovable& movable, GltfReport& report,
                         SkinnedMesh& into);

}  // namespace strandcast
