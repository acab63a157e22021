#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <tuple>

#include "core/triangle_mesh.h"
#include "groom/gltf_document.h"

namespace strandcast {

using GltfTransform = Eigen::Matrix<float, 4, 4, Eigen::DontAlign>;

/// Gathers the triangle primitives of meshes into one mesh.
class GltfPrimitives {
 public:
  /// Told of `count` vertices that were added, and the attributes and part of their primitive.
  using VerticesAdded =
      std::function<void(const nlohmann::json& attributes, uint64_t count, const std::string& part)>;

  explicit GltfPrimitives(const GltfDocument& document) : document_(document) {}

  /// Adds all of a mesh, its vertices placed by `to_world`; `mirrored` turns its triangles round. Primitives
  /// that share their positions, and, where `added` is asked for, joints and weights, share vertices. Throws
  /// Error.
  void add(uint64_t mesh, const GltfTransform& to_world, bool mirrored, const std::string& asked_by,
           const VerticesAdded& added = {});
  /// Without normals. Throws Error when there is no triangle.
  TriangleMesh take();

 private:
  using Shared = std::map<std::tuple<uint64_t, uint64_t, uint64_t>, uint32_t>;  ///< accessors -> first vertex

  void addPrimitive(const nlohmann::json& primitive, const GltfTransform& to_world, bool mirrored,
                    const std::string& part, const VerticesAdded& added, Shared& shared);
  uint32_t addVertices(uint64_t accessor, uint64_t count, const GltfTransform& to_world,
                       const std::string& part);
  void spend(uint64_t& spent, uint64_t elements, const std::string& part) const;

  const GltfDocument& document_;
  uint64_t vertices_spent_ = 0;
  uint64_t triangles_spent_ = 0;
  TriangleMesh mesh_;
};

}  // namespace strandcast
