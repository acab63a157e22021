#pragma once
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/triangle_mesh.h"
#include "groom/groom_file.h"
#include "groom/skeleton.h"

namespace strandcast {

/// What of a vertex moves with which joint. The weights of a vertex add up to 1.
struct SkinInfluence {
  uint32_t binding = 0;  ///< index into SkinnedMesh::bindings
  float weight = 0;
};
using SkinInfluences = std::array<SkinInfluence, 4>;

/// How a skin hangs on a joint: from the vertices as they are stored to the joint's own frame.
struct SkinBinding {
  uint32_t joint = 0;
  Placement inverse_bind = Placement::Identity();
};

/// A mesh whose vertices move with the joints of a skeleton by linear blending (Magnenat-Thalmann 1988; glTF
/// 2.0 specification, "Skins").
struct SkinnedMesh {
  TriangleMesh mesh;                       ///< where the skeleton is at rest: metres, Y up, with normals
  std::vector<Vec3> stored;                ///< per vertex, as the file has it: what bindings apply to
  std::vector<SkinInfluences> influences;  ///< per vertex
  std::vector<SkinBinding> bindings;
  Skeleton skeleton;  ///< all nodes of the file's scene; its root holds units and axes
  std::vector<SkeletonClip> clips;
  FileReport report;

  /// What each binding does to stored vertices when the joints are at `world`.
  std::vector<Placement> bindingsAt(std::span<const Placement> world) const;
  /// Where all vertices are then, m.
  std::vector<Vec3> blended(std::span<const Placement> world) const;
};

/// Reads the meshes of a .gltf or .glb with its skins (JOINTS_0, WEIGHTS_0), its nodes as a skeleton and its
/// animations (translation, rotation and scale; STEP, LINEAR and CUBICSPLINE). What has no skin moves with
/// its node. Morph targets are left out. Throws Error (file, part, remedy) on bad input, on more than four
/// weights a vertex, and where no mesh has a skin.
SkinnedMesh loadSkinnedMesh(const std::filesystem::path& file, const GroomReadOptions& options);

/// The same from memory, in the file's units and axes; no external buffers. The fuzzer's entry point.
SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name);

}  // namespace strandcast
