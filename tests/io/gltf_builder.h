#pragma once
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast::samples {

/// Builds .gltf files from pieces of JSON and numbers, with one buffer in a data URI.
class GltfBuilder {
 public:
  /// Adds a buffer view of these values and returns its index. `more`: further members, each after a comma.
  template <class T>
  size_t view(const std::vector<T>& values, const std::string& more = "") {
    std::vector<std::byte> bytes(values.size() * sizeof(T));
    if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return addView(bytes, more);
  }
  /// Adds an accessor with these members and returns its index.
  size_t accessor(const std::string& members);
  /// Adds an accessor of all values, with a view of its own.
  size_t floats(const std::vector<float>& values, const std::string& type);
  size_t points(const std::vector<Vec3>& points);
  size_t indices(const std::vector<uint16_t>& values);
  /// The file, with these members of its root: nodes, meshes and so on.
  std::vector<std::byte> gltf(const std::string& members) const;
  /// A scene of one node, "head", whose mesh has one primitive with these members; `more` are members of the
  /// root.
  std::vector<std::byte> body(const std::string& primitive, const std::string& more = "") const;

 private:
  size_t addView(const std::vector<std::byte>& bytes, const std::string& more);

  std::vector<std::byte> bytes_;
  std::string views_, accessors_;
  size_t view_count_ = 0, accessor_count_ = 0;
};

/// A small valid file with sparse and quantised accessors, targets, instances, extensions and odd primitives.
std::vector<std::byte> gltfOfAllKinds();

/// A tetrahedron at the origin with edges of 1, and its triangles, outside out.
std::vector<Vec3> tetrahedron();
std::vector<uint16_t> tetrahedronTriangles();

}  // namespace strandcast::samples
