#pragma once
#include <filesystem>
#include <fstream>

#include "core/geometry.h"

namespace strandcast {

inline void writeObj(const std::filesystem::path& file, const TriangleMesh& mesh) {
  std::ofstream out(file);
  for (const Vec3& p : mesh.positions) out << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  for (const auto& t : mesh.triangles) out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
}

}  // namespace strandcast
