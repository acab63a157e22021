#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// A triangle mesh in metres, Y up, counter-clockwise seen from outside.
struct TriangleMesh {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;                       ///< one per position, unit length; empty until computed
  std::vector<std::array<uint32_t, 3>> triangles;  ///< indices into positions, all in range

  bool empty() const { return triangles.empty(); }
  Box bounds() const {
    Box box;
    for (const Vec3& p : positions) box.extend(Eigen::Vector3f(p));
    return box;
  }
};

/// Sets `normals` to the angle-weighted mean of the adjacent triangles' normals.
void computeNormals(TriangleMesh& mesh);

}  // namespace strandcast
