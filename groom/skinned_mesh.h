#pragma once
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/triangle_mesh.h"
#include "groom/gltf_limits.h"
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

/// A shape that a clip blends into a mesh (glTF 2.0 specification, "Morph Targets").
struct MorphTarget {
  struct Move {
    uint32_t vertex;
    Vec3 by;  ///< how far the stored vertex moves when the target's weight grows by 1
  };
  std::string name;
  float rest = 0;  ///< its weight at rest, which stored vertices have in them
  std::vector<Move> moves;
};

/// A mesh whose vertices move with the joints of a skeleton by linear blending (Magnenat-Thalmann 1988; glTF
/// 2.0 specification, "Skins"), after morph targets have moved them.
///
/// Where a vertex is, is linear in the bindings' placements and in their products with the targets' weights.
/// So each pair of a target and a binding that some vertex has counts as one more binding, whose placement is
/// the linear part of the binding's times how far the weight is from that at rest: at rest it is 0. What is
/// made of sums over bindings is thereby made of morph targets, too.
struct SkinnedMesh {
  TriangleMesh mesh;                       ///< where the skeleton is at rest: metres, Y up, with normals
  std::vector<Vec3> stored;                ///< per vertex, as the file has it: what bindings apply to
  std::vector<SkinInfluences> influences;  ///< per vertex
  std::vector<SkinBinding> bindings;
  std::vector<MorphTarget> targets;  ///< those that clips play
  struct TargetBinding {
    uint32_t target, binding;
  };
  std::vector<TargetBinding> target_bindings;  ///< they count as bindings from bindings.size() on
  Skeleton skeleton;  ///< all nodes of the file's scene; its root holds units and axes
  std::vector<SkeletonClip> clips;
  FileReport report;

  /// What each binding, and each of target_bindings after them, does to stored vertices when the joints are
  /// at `world` and the targets have `weights`; without these, as they have at rest.
  std::vector<Placement> bindingsAt(std::span<const Placement> world,
                                    std::span<const float> weights = {}) const;
  /// Where all vertices are then, m.
  std::vector<Vec3> blended(std::span<const Placement> world, std::span<const float> weights = {}) const;
  std::vector<float> restWeights() const;  ///< of the targets

  /// Makes target_bindings of targets and influences.
  void bindTargets();
  /// Leaves only those targets that a clip plays, and numbers its channels anew.
  void keepTargets(SkeletonClip& clip);
};

/// Reads the meshes of a .gltf or .glb with its skins, its nodes as a skeleton and its animations
/// (translation, rotation, scale and weights of morph targets; STEP, LINEAR and CUBICSPLINE). What has no
/// skin moves with its node. Of a vertex the four largest weights are kept. Throws Error (file, part, remedy)
/// on bad input, and where no mesh has a skin or morph targets that are animated. docs/formats.md has what is
/// left out and mended.
SkinnedMesh loadSkinnedMesh(const std::filesystem::path& file, const GroomReadOptions& options);

/// The same from memory, in the file's units and axes; no external buffers. The fuzzer's entry point.
SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name,
                         const GltfLimits& limits = {});

}  // namespace strandcast
