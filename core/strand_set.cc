#include "core/strand_set.h"

#include "core/triangle_mesh.h"

namespace strandcast {

void StrandSet::append(std::span<const Vec3> points) {
  positions.insert(positions.end(), points.begin(), points.end());
  offsets.push_back(static_cast<uint32_t>(positions.size()));
}

float arcLength(std::span<const Vec3> points) {
  float length = 0;
  for (size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

void computeNormals(TriangleMesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), Vec3::Zero());
  for (const auto& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const uint32_t here = triangle[corner];
      const Vec3 a = mesh.positions[triangle[(corner + 1) % 3]] - mesh.positions[here];
      const Vec3 b = mesh.positions[triangle[(corner + 2) % 3]] - mesh.positions[here];
      const Vec3 normal = a.cross(b);
      const float doubled_area = normal.norm();
      if (doubled_area <= 0) continue;
      const float angle = std::atan2(doubled_area, a.dot(b));
      mesh.normals[here] += normal * (angle / doubled_area);
    }
  }
  for (Vec3& normal : mesh.normals) {
    const float length = normal.norm();
    normal = length > 0 ? Vec3(normal / length) : Vec3(0, 1, 0);
  }
}

}  // namespace strandcast
