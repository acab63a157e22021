#include "collision/surface_samples.h"

#include <algorithm>
#include <cmath>

namespace strandcast {

std::vector<SurfaceSample> sampleSurface(const TriangleMesh& mesh, size_t count) {
  std::vector<double> cumulative;
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    area += 0.5 * static_cast<double>((b - a).cross(c - a).norm());
    cumulative.push_back(area);
  }
  std::vector<SurfaceSample> samples;
  if (!(area > 0)) return samples;
  size_t triangle = 0;
  for (size_t i = 0; i < count; ++i) {
    const double target = area * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    while (cumulative[triangle] < target && triangle + 1 < cumulative.size()) ++triangle;
    const auto& t = mesh.triangles[triangle];
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const double turn = 0.7548776662466927 * static_cast<double>(i + 1);
    const double other = 0.5698402909980532 * static_cast<double>(i + 1);
    const float u = std::sqrt(static_cast<float>(turn - std::floor(turn)));
    const float v = static_cast<float>(other - std::floor(other));
    const Vec3 normal = (b - a).cross(c - a);
    if (normal.norm() <= 0) continue;
    samples.push_back({a * (1 - u) + b * (u * (1 - v)) + c * (u * v), normal.normalized()});
  }
  return samples;
}

double shareInDoubt(const TriangleMesh& mesh, const MeshQuery& query, float step) {
  constexpr size_t kSamples = 2000;
  const std::vector<SurfaceSample> samples = sampleSurface(mesh, kSamples);
  const auto isDoubtful = [&](const Vec3& place) {
    return std::fabs(std::fabs(query.windingNumber(place)) - 0.5f) < 0.25f;
  };
  const auto doubtful = std::count_if(samples.begin(), samples.end(), [&](const SurfaceSample& sample) {
    return isDoubtful(sample.position + step * sample.normal) ||
           isDoubtful(sample.position - step * sample.normal);
  });
  return samples.empty() ? 0 : static_cast<double>(doubtful) / static_cast<double>(samples.size());
}

}  // namespace strandcast
