#include "collision/primitive_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <string>

#include "collision/body_distance.h"
#include "core/error.h"

namespace strandcast {
namespace {

constexpr size_t kCoverSamples = 2000;  // samples on which coverage is measured
constexpr size_t kSeeds = 2000;         // points where candidate spheres touch the surface
// Share of the mesh's diagonal: a point farther than this from all spheres is not covered.
constexpr float kReach = 0.04f;
constexpr float kTouch = 1e-4f;  // m: a point this near to a candidate adds no other candidate

/// Proportional to the signed volume; negative if the mesh is inside out.
double volumeOf(const TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    volume += static_cast<double>(mesh.positions[a].dot(mesh.positions[b].cross(mesh.positions[c])));
  return volume;
}

struct Sphere {
  Vec3 centre;
  float radius;
};

float gap(const Sphere& sphere, const Vec3& p) {
  return std::fabs((p - sphere.centre).norm() - sphere.radius);
}

// The largest sphere inside the mesh that touches it at `seed`: a ball is shrunk until it contains no surface
// point (Ma, Bae, Choi 2012, "3D medial axis point approximation using nearest neighbors and the normal
// field").
Sphere largestBall(const MeshQuery& query, const Vec3& seed, const Vec3& inward, float start) {
  float radius = start;
  Vec3 centre = seed + inward * radius;
  for (int i = 0; i < 30; ++i) {
    const MeshPoint nearest = query.closest(centre);
    if (nearest.distance >= radius * 0.999f) break;
    const Vec3 chord = nearest.position - seed;
    const float along = chord.dot(inward);
    const float squared = chord.squaredNorm();
    if (along <= 1e-9f || squared <= 1e-12f) break;
    const float shrunk = squared / (2 * along);
    if (shrunk >= radius) break;
    radius = shrunk;
    centre = seed + inward * radius;
  }
  return {centre, query.closest(centre).distance};
}

// The mesh without internal parts (teeth, eyes, overlapping parts): triangles with inside on both sides are
// removed.
TriangleMesh outerSurface(const TriangleMesh& mesh) {
  const MeshQuery query(mesh);
  const float away = 1e-3f * mesh.bounds().diagonal().norm();
  TriangleMesh outer;
  outer.name = mesh.name;
  outer.positions = mesh.positions;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const Vec3 normal = (b - a).cross(c - a);
    if (!(normal.norm() > 0)) continue;
    if (boundsOutside(query, (a + b + c) / 3, normal.normalized() * away)) outer.triangles.push_back(t);
  }
  return outer.triangles.empty() ? mesh : outer;
}

std::vector<Sphere> candidateSpheres(const TriangleMesh& mesh, const PrimitiveFitOptions& options) {
  const MeshQuery query(mesh);
  const float start = 0.5f * mesh.bounds().sizes().maxCoeff();
  std::vector<Sphere> spheres;
  const float inward = volumeOf(mesh) < 0 ? 1.0f : -1.0f;  // an inside-out mesh keeps its inside
  for (const SurfaceSample& seed : sampleSurface(mesh, kSeeds)) {
    if (std::any_of(spheres.begin(), spheres.end(),
                    [&](const Sphere& s) { return gap(s, seed.position) < options.skin + kTouch; }))
      continue;
    Sphere sphere = largestBall(query, seed.position, inward * seed.normal, start);
    sphere.radius -= options.skin;
    if (sphere.radius < options.min_radius || !isInside(query, sphere.centre)) continue;
    spheres.push_back(sphere);
  }
  return spheres;
}

// Whether the sphere protrudes through the hole of an open mesh, which closest points alone do not reveal.
bool leaves(const MeshQuery& query, const Sphere& sphere) {
  constexpr int kPlaces = 200;
  constexpr float kWithin = 0.6f;  // winding number; somewhat above a half, for the space between the points
  for (int i = 0; i < kPlaces; ++i) {
    const float y = 1 - (2 * static_cast<float>(i) + 1) / kPlaces, ring = std::sqrt(1 - y * y);
    const float turn = 2.3999632f * static_cast<float>(i);
    const Vec3 p = sphere.centre + sphere.radius * Vec3(ring * std::cos(turn), y, ring * std::sin(turn));
    if (std::fabs(query.windingNumber(p)) < kWithin && query.closest(p).distance > kTouch) return true;
  }
  return false;
}

float gain(const Sphere& sphere, const std::vector<SurfaceSample>& samples, const std::vector<float>& gaps) {
  float sum = 0;
  for (size_t i = 0; i < samples.size(); ++i)
    sum += std::max(0.0f, gaps[i] - gap(sphere, samples[i].position));
  return sum;
}

}  // namespace

std::vector<ContactPrimitive> fitSpheres(const TriangleMesh& whole, const PrimitiveFitOptions& options) {
  const TriangleMesh mesh = outerSurface(whole);
  const std::vector<Sphere> spheres = candidateSpheres(mesh, options);
  if (spheres.empty())
    throw Error("no sphere fits inside", mesh.name.empty() ? "mesh" : "mesh " + mesh.name,
                "check its unit, or that it is closed; smallest radius is " +
                    std::to_string(options.min_radius) + " m");
  const std::vector<SurfaceSample> samples = sampleSurface(mesh, kCoverSamples);
  std::vector<float> gaps(samples.size(), kReach * mesh.bounds().diagonal().norm());

  // Lazy greedy selection: gains only decrease as spheres are added, so the first entry that is up to date
  // and still on top is the best (Minoux 1978). Ties go to the first candidate.
  using Entry = std::pair<float, int64_t>;  // gain, minus the candidate's index
  std::priority_queue<Entry> queue;
  for (size_t i = 0; i < spheres.size(); ++i)
    queue.emplace(std::numeric_limits<float>::max(), -static_cast<int64_t>(i));
  const MeshQuery query(whole);
  std::vector<ContactPrimitive> fitted;
  while (!queue.empty() && fitted.size() < static_cast<size_t>(std::max(options.max_primitives, 0))) {
    const int64_t index = queue.top().second;
    queue.pop();
    const Sphere& sphere = spheres[static_cast<size_t>(-index)];
    const float now = gain(sphere, samples, gaps);
    if (!queue.empty() && Entry(now, index) < queue.top()) {
      queue.emplace(now, index);
      continue;
    }
    if (now <= 0) break;
    if (leaves(query, sphere)) continue;
    ContactPrimitive primitive;
    primitive.kind = PrimitiveKind::kSphere;
    primitive.a = sphere.centre;
    primitive.radius = sphere.radius;
    fitted.push_back(primitive);
    for (size_t i = 0; i < samples.size(); ++i) gaps[i] = std::min(gaps[i], gap(sphere, samples[i].position));
  }
  return fitted;
}

}  // namespace strandcast
