#pragma once
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "io/groom_file.h"
#include "io/mesh_file.h"
#include "io/skeleton.h"

namespace strandcast {

/// Share of a vertex that moves with a joint. The weights of a vertex add up to 1.
struct SkinInfluence {
  uint32_t binding = 0;  ///< index into SkinnedMesh::bindings
  float weight = 0;
};
using SkinInfluences = std::array<SkinInfluence, 4>;

/// Attachment of a skin to a joint: maps stored vertices to the frame of the joint.
struct SkinBinding {
  uint32_t joint = 0;
  Placement inverse_bind = Placement::Identity();
};

/// A shape that a clip blends into a mesh (glTF 2.0 specification, "Morph Targets").
struct MorphTarget {
  struct Move {
    uint32_t vertex;
    Vec3 by;  ///< displacement of the stored vertex per unit of the target's weight
  };
  std::string name;
  float rest = 0;  ///< weight at rest, already applied to stored vertices
  std::vector<Move> moves;
};

/// A mesh whose vertices move with the joints of a skeleton by linear blend skinning (Magnenat-Thalmann 1988;
/// glTF 2.0 specification, "Skins"), after morph targets have displaced them.
///
/// The position of a vertex is linear in the placements of bindings and in their products with the weights of
/// targets. Each pair of a target and a binding that some vertex uses therefore counts as one more binding.
/// Its placement is the linear part of the binding's, times the difference of the weight from that at rest: 0
/// at rest. Sums over bindings thereby include morph targets.
struct SkinnedMesh {
  TriangleMesh mesh;                       ///< with the skeleton at rest: metres, Y up, with normals
  std::vector<Vec3> stored;                ///< per vertex, as stored in the file, before bindings
  std::vector<SkinInfluences> influences;  ///< per vertex
  std::vector<SkinBinding> bindings;
  std::vector<MorphTarget> targets;  ///< those that clips play, or all of the file
  struct TargetBinding {
    uint32_t target, binding;
  };
  std::vector<TargetBinding> target_bindings;  ///< count as bindings from bindings.size() on
  Skeleton skeleton;  ///< all nodes of the file's scene; its root holds units and axes
  std::vector<SkeletonClip> clips;
  FileReport report;
  BodyRig rig;  ///< of the file

  /// Transforms of stored vertices per binding, then per entry of target_bindings. `world`: transforms of the
  /// joints. `weights`: per target; empty: as at rest.
  std::vector<Placement> bindingsAt(std::span<const Placement> world,
                                    std::span<const float> weights = {}) const;
  /// Positions of all vertices for these transforms and weights, m.
  std::vector<Vec3> blended(std::span<const Placement> world, std::span<const float> weights = {}) const;
  std::vector<float> restWeights() const;  ///< of the targets

  /// Fills target_bindings from `targets` and `influences`.
  void bindTargets();
  /// Keeps only the targets that a clip plays, and renumbers the targets of its channels.
  void keepTargets(SkeletonClip& clip);
};

/// The morph targets of a body that are read.
enum class BodyTargets : uint8_t {
  kClip,  ///< those that clips play
  kAll    ///< also those that only a program weighs
};

/// Reads the meshes of a .gltf or .glb with their skins, the nodes as a skeleton, and the animations
/// (translation, rotation, scale and weights of morph targets; STEP, LINEAR and CUBICSPLINE). A mesh without
/// a skin moves with its node. The four largest weights of a vertex are kept. Throws Error (file, part,
/// remedy) on bad input, and when no mesh has a skin or morph targets that are read. docs/formats.md lists
/// what is left out and repaired.
SkinnedMesh loadSkinnedMesh(const std::filesystem::path& file, const GroomReadOptions& options,
                            BodyTargets targets = BodyTargets::kClip);

/// As loadSkinnedMesh(), from memory, in the file's units and axes, without external buffers. The fuzzer's
/// entry point.
SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name,
                         const GltfLimits& limits = {}, BodyTargets targets = BodyTargets::kClip);

}  // namespace strandcast
