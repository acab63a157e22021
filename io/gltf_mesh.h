#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "io/file_report.h"
#include "io/gltf_document.h"
#include "io/gltf_scene.h"
#include "io/mesh_file.h"
#include "io/skinned_mesh.h"

namespace strandcast {

using GltfTransform = Eigen::Matrix<float, 4, 4, Eigen::DontAlign>;

/// The morph targets of a mesh at one node.
struct GltfMorph {
  std::vector<float> weights;  ///< at rest, one for each target
  std::vector<bool> played;    ///< per target; empty when no clip moves any
  /// Or else read for programs that weigh it.
  bool isPlayed(size_t target) const { return target < played.size() && played[target]; }
};

/// Reads the morph targets of meshes.
class GltfMorphs {
 public:
  GltfMorphs(const GltfDocument& document, GltfReport& report) : document_(document), report_(report) {}
  /// Returns the targets of a mesh at a node. Weights at rest are those of the node, else of the mesh, else
  /// 0. Reports targets whose vertex count differs from that of their primitive. Throws Error.
  GltfMorph of(const nlohmann::json& node, uint64_t mesh, const std::string& part);

 private:
  size_t targetsOf(uint64_t mesh, const std::string& part);
  void reportTargetCounts(const nlohmann::json& primitive, const nlohmann::json& targets,
                          const std::string& part);

  const GltfDocument& document_;
  GltfReport& report_;
  std::map<uint64_t, size_t> targets_;  ///< mesh -> number of its targets
};

/// Accessors of the sets of joints or weights of a primitive ("JOINTS_0", "JOINTS_1", ...), by set number.
/// `beginning` is the part before the number.
std::map<uint64_t, uint64_t> gltfSets(const GltfDocument& document, const nlohmann::json& attributes,
                                      const std::string& beginning, const std::string& part);

/// Gathers the triangle primitives of meshes into one mesh. Morph targets are applied with their weights at
/// rest.
class GltfPrimitives {
 public:
  /// Vertices that one primitive added to the mesh.
  struct Added {
    const nlohmann::json& attributes;
    uint64_t first, count;
    std::string part;
    /// Per played target: its number, and per vertex the displacement at weight 1.
    std::vector<std::pair<size_t, std::vector<Vec3>>> moves;
  };
  using VerticesAdded = std::function<void(const Added&)>;

  GltfPrimitives(const GltfDocument& document, GltfReport& report) : document_(document), report_(report) {}

  /// Adds all primitives of a mesh, with vertices transformed by `to_world`. `mirrored` reverses the winding
  /// of triangles. Primitives share vertices when they share their accessors of positions, of active morph
  /// targets and, when `added` is given, of joints and weights. Throws Error.
  void add(uint64_t mesh, const GltfMorph& morph, const GltfTransform& to_world, bool mirrored,
           const std::string& asked_by, const VerticesAdded& added = {});
  /// Returns the mesh, without normals. Throws Error when it has no triangle.
  TriangleMesh take();

 private:
  using Shared = std::map<std::vector<uint64_t>, uint32_t>;  ///< accessors -> first vertex
  /// A morph target that displaces the vertices of a primitive: its number and the accessor of its positions.
  struct Target {
    size_t number;
    uint64_t accessor;
  };

  void addPrimitive(const nlohmann::json& primitive, const GltfMorph& morph, const GltfTransform& to_world,
                    bool mirrored, const std::string& part, const VerticesAdded& added, Shared& shared);
  std::vector<Target> targetsOf(const nlohmann::json& primitive, const GltfMorph& morph, uint64_t vertices,
                                const std::string& part);
  uint32_t addVertices(uint64_t accessor, const std::vector<Target>& targets, const GltfMorph& morph,
                       const GltfTransform& to_world, Added& added);
  void addTriangles(const nlohmann::json& primitive, uint64_t mode, uint32_t first, uint64_t vertices,
                    bool mirrored, const std::string& part);
  void spend(uint64_t& spent, uint64_t elements, uint64_t limit, const char* what,
             const std::string& part) const;

  const GltfDocument& document_;
  GltfReport& report_;
  uint64_t primitives_spent_ = 0, vertices_spent_ = 0, triangles_spent_ = 0, targets_spent_ = 0;
  TriangleMesh mesh_;
};

/// As readGltfMesh() in mesh_file.h, and also reads the external buffers of a .gltf.
ReadMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name,
                      const ReadBeside& read_beside, const GltfLimits& limits = {});
/// As readGltfSkin() in skinned_mesh.h, and also reads the external buffers of a .gltf.
SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name,
                         const ReadBeside& read_beside, const GltfLimits& limits = {},
                         BodyTargets targets = BodyTargets::kClip);

/// Returns a reader for files that a .gltf names, in the folder of the .gltf. If `beneath` is not empty,
/// reads are confined to it (readBeneath).
ReadBeside besideFile(const std::filesystem::path& file, const std::filesystem::path& beneath = {});

/// Name of a node, else gltfNodePart().
std::string gltfNodeName(const GltfDocument& document, uint64_t node);
/// Name of a morph target of a node's mesh from `extras.targetNames`, a convention of exporters, else
/// "target N".
std::string gltfTargetName(const GltfDocument& document, uint64_t node, size_t target);
/// The rig of these nodes. Throws Error.
BodyRig gltfRig(const GltfDocument& document, const std::vector<GltfNode>& nodes);

/// The mesh of a document with a skin, with its joints at rest, without normals. Clips are not read.
TriangleMesh skinAtRest(const GltfDocument& document, GltfReport& report);

}  // namespace strandcast
