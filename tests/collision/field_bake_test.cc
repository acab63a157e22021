#include "collision/field_bake.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <thread>

#include "collision/body_distance.h"
#include "tests/collision/shapes.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

using shapes::randomPoint;

constexpr float kFine = 0.003f, kCell = 0.004f;  // m

FieldOptions cells(float cell) {
  FieldOptions options;
  options.cell = cell;
  return options;
}

DistanceField baked(const TriangleMesh& mesh, float cell = kCell, int threads = 0) {
  BakeLimits limits;
  limits.threads = threads;
  return FieldBaker(mesh, cells(cell), limits).bake();
}

/// Exact signed distance and its direction.
using Truth = std::function<FieldSample(const Vec3&)>;

Truth sphereTruth(float radius, const Vec3& centre = Vec3::Zero()) {
  return [=](const Vec3& p) { return FieldSample{(p - centre).norm() - radius, (p - centre).normalized()}; };
}

Truth capsuleTruth(float radius, float half) {
  return [=](const Vec3& p) { return sphereTruth(radius, {0, std::clamp(p.y(), -half, half), 0})(p); };
}

/// Worst error of distance (m) and gradient (degrees) at points of the band.
struct Worst {
  double distance = 0, degrees = 0;
  int points = 0;
};

Worst compare(const DistanceField& field, const Truth& truth, float reach) {
  std::mt19937 random(7);
  Worst worst;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = randomPoint(random, reach);
    const FieldSample exact = truth(p);
    if (std::fabs(exact.distance) > field.grid.band) continue;
    const FieldSample found = field.at(p);
    worst.distance = std::max(worst.distance, std::fabs(double{found.distance} - double{exact.distance}));
    const double cosine = found.gradient.normalized().dot(exact.gradient);
    worst.degrees = std::max(worst.degrees, std::acos(std::min(1.0, cosine)) * 180 / std::numbers::pi);
    ++worst.points;
  }
  return worst;
}

// m. Depth of the middles of an icosphere's facets (edges of 4 % of the radius at five levels), plus the
// interpolation error where the distance is most curved, at the inner end of the band.
double roundError(float radius) {
  const float edge = 0.04f * radius;
  return edge * edge / (6 * radius) + kFine * kFine / (4 * (radius - defaultFieldBand(40e-6f, kFine)));
}

// Degrees. Angle between normals of facets, plus the change of direction within half a cell's diagonal there.
double roundTurn(float radius) {
  const float turn =
      0.02f + kFine / (std::numbers::sqrt2_v<float> * (radius - defaultFieldBand(40e-6f, kFine)));
  return turn * 180 / std::numbers::pi;
}

TEST(FieldBake, ASphereIsWithinItsFacetsAndTheInterpolantsError) {
  const Worst worst = compare(baked(shapes::sphere(0.05f, 5), kFine), sphereTruth(0.05f), 0.06f);
  EXPECT_GT(worst.points, 1000);
  EXPECT_LT(worst.distance, roundError(0.05f));
  EXPECT_LT(worst.degrees, roundTurn(0.05f));
}

TEST(FieldBake, ACapsuleIsWithinItsFacetsAndTheInterpolantsError) {
  const Worst worst =
      compare(baked(shapes::capsule(0.04f, 0.02f, 5), kFine), capsuleTruth(0.04f, 0.02f), 0.07f);
  EXPECT_GT(worst.points, 1000);
  EXPECT_LT(worst.distance, roundError(0.04f));
  EXPECT_LT(worst.degrees, roundTurn(0.04f));
}

TEST(FieldBake, ABoxIsExactOverItsFacesAndWithinAPartOfACellAtItsEdges) {
  const Vec3 half(0.06f, 0.04f, 0.05f);
  const DistanceField field = baked(shapes::box(half), kFine);
  std::mt19937 random(3);
  int faces = 0;
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = randomPoint(random, 0.08f);
    const Vec3 beyond = p.cwiseAbs() - half;
    const float exact = beyond.cwiseMax(0).norm() + std::min(beyond.maxCoeff(), 0.0f);
    if (std::fabs(exact) > field.grid.band) continue;
    const double error = std::fabs(double{field.at(p).distance} - double{exact});
    worst = std::max(worst, error);
    std::array<float, 3> sorted{beyond.x(), beyond.y(), beyond.z()};
    std::sort(sorted.begin(), sorted.end());
    if (sorted[1] > -std::fabs(sorted[2]) - 2 * kFine || sorted[1] > -2 * kFine) continue;
    ++faces;
    EXPECT_LT(error, 2e-6) << p.transpose() << ": the distance to a plane is linear";
  }
  EXPECT_GT(faces, 1000);
  EXPECT_LT(worst, 0.5 * kFine);
}

TEST(FieldBake, BeyondTheBandDistancesAreLowerBoundsWithTheRightSignAndAWayOut) {
  const DistanceField field = baked(shapes::sphere(0.1f, 4));
  // m, as in roundError, at four levels. Stored bricks extend beyond the band, and their interpolated values
  // are no bound.
  constexpr float kOff = 0.008f * 0.008f / (6 * 0.1f) + kCell * kCell / (4 * 0.1f);
  std::mt19937 random(5);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 p = randomPoint(random, i % 2 ? 0.11f : 0.4f);
    const FieldSample exact = sphereTruth(0.1f)(p), found = field.at(p);
    if (std::fabs(exact.distance) < field.grid.band + kOff) continue;
    EXPECT_EQ(std::signbit(found.distance), std::signbit(exact.distance)) << p.transpose();
    EXPECT_LE(std::fabs(found.distance), std::fabs(exact.distance) + kOff) << p.transpose();
    EXPECT_GE(std::fabs(found.distance), field.grid.band - 1e-5f) << p.transpose();
    if (p.norm() > 0.03f) {
      EXPECT_GT(found.gradient.dot(exact.gradient), 0.5f) << p.transpose();
    }
  }
}

TEST(FieldBake, NeighbouringBricksShareTheirSamples) {
  const DistanceField field = baked(shapes::potato(0.06f, 3));
  const auto& [nx, ny, nz] = field.grid.bricks;
  const auto sample = [&](uint32_t brick, uint32_t n) {
    return static_cast<int16_t>(field.samples[size_t{brick} * kBrickWords + n / 2] >> (16 * (n % 2)));
  };
  int pairs = 0;
  for (size_t b = 0; b < field.bricks(); ++b) {
    if (b % nx + 1 == nx || field.index[b] >= kInsideBrick || field.index[b + 1] >= kInsideBrick) continue;
    ++pairs;
    for (uint32_t row = 0; row < kBrickSide * kBrickSide; ++row)
      ASSERT_EQ(sample(field.index[b], row * kBrickSide + kBrickCells),
                sample(field.index[b + 1], row * kBrickSide));
  }
  EXPECT_GT(pairs, 20);
}

TEST(FieldBake, StoredSamplesAreWithinHalfAUnitOfTheExactDistance) {
  const TriangleMesh mesh = shapes::potato(0.05f, 4);
  const DistanceField field = baked(mesh);
  const MeshQuery query(mesh);
  const std::vector<OpenEdge> closed;
  const BodyDistance body(query, query, closed);
  const auto& [nx, ny, nz] = field.grid.bricks;
  for (uint32_t b = 0; b < field.bricks(); b += 3) {
    if (field.index[b] >= kInsideBrick) continue;
    for (uint32_t n = 0; n < kBrickSamples; n += 11) {
      const Vec3 p = samplePosition(field.grid, b % nx * kBrickCells + n % kBrickSide,
                                    b / nx % ny * kBrickCells + n / kBrickSide % kBrickSide,
                                    b / nx / ny * kBrickCells + n / kBrickSide / kBrickSide);
      const auto stored =
          static_cast<int16_t>(field.samples[size_t{field.index[b]} * kBrickWords + n / 2] >> (16 * (n % 2)));
      ASSERT_NEAR(stored * field.grid.quantum, body.at(p).signed_distance, 0.501f * field.grid.quantum);
    }
  }
}

TEST(FieldBake, TheNumberOfThreadsChangesNoBit) {
  TriangleMesh mesh = shapes::together(shapes::potato(0.05f, 3), shapes::sphere(0.03f, 2, {0.05f, 0, 0}));
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 10);  // open as well
  const DistanceField one = baked(mesh, 0.005f, 1);
  for (const int threads : {2, 5}) {
    const DistanceField other = baked(mesh, 0.005f, threads);
    EXPECT_EQ(other.index, one.index);
    EXPECT_EQ(other.samples, one.samples);
    EXPECT_EQ(std::memcmp(other.corners.data(), one.corners.data(), 4 * one.corners.size()), 0);
  }
}

TEST(FieldBake, ALowPriorityIsNotLeftToThreadsThatWorkAfterwards) {
  const int own = getpriority(PRIO_PROCESS, 0);
  if (own >= 19) GTEST_SKIP() << "no thread can be of a lower priority than this one";
  // Without this, oneTBB uses no more threads than the machine has.
  using oneapi::tbb::global_control;
  const global_control four(global_control::max_allowed_parallelism, 4);
  oneapi::tbb::task_arena arena(4);
  arena.initialize();  // as a simulation's before its first step: workers that start now stay
  std::thread([&] {
    ASSERT_EQ(setpriority(PRIO_PROCESS, 0, own + 1), 0);  // on Linux, of this thread
    baked(shapes::potato(0.05f, 3), 0.005f, 4);
  }).join();
  std::map<std::thread::id, int> priorities;
  std::mutex mutex;
  arena.execute([&] {
    oneapi::tbb::parallel_for(0, 64, [&](int) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      const std::lock_guard lock(mutex);
      priorities[std::this_thread::get_id()] = getpriority(PRIO_PROCESS, 0);
    });
  });
  EXPECT_GT(priorities.size(), 1u);
  for (const auto& [thread, priority] : priorities) EXPECT_EQ(priority, own);
}

TEST(FieldBake, AMeshTurnedInsideOutIsTakenAsItIsMeant) {
  TriangleMesh mesh = shapes::sphere(0.05f, 3);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(baked(mesh).samples, baked(shapes::sphere(0.05f, 3)).samples);
}

// A bowl: the lower half of a sphere.
TriangleMesh bowl() {
  TriangleMesh mesh = shapes::sphere(0.1f, 4);
  std::erase_if(mesh.triangles, [&](const auto& t) {
    return mesh.positions[t[0]].y() + mesh.positions[t[1]].y() + mesh.positions[t[2]].y() > 0;
  });
  return mesh;
}

TEST(FieldBake, AnOpenHemisphereHasAnInsideUnderALid) {
  FieldBaker baker(bowl(), cells(kCell));
  EXPECT_GT(baker.mesh().open_edges.size(), 50u);
  const DistanceField field = baker.bake();
  EXPECT_EQ(baker.hiddenTriangles(), 0u);
  std::mt19937 random(2);
  for (int i = 0; i < 10000; ++i) {
    const Vec3 p = randomPoint(random, 0.12f);
    const float to_sphere = p.norm() - 0.1f;
    if (std::fabs(to_sphere) < kCell) continue;
    const float found = field.at(p).distance;
    if (to_sphere < 0 && p.y() < -0.012f) {
      EXPECT_LT(found, 0) << p.transpose();
    }
    if (to_sphere > 0 || p.y() > 0.012f) {
      EXPECT_GT(found, 0) << p.transpose();
    }
  }
  float last = field.at({0.02f, -0.03f, 0.01f}).distance;
  for (float y = -0.03f; y < 0.03f; y += 1e-4f) {
    const float now = field.at({0.02f, y, 0.01f}).distance;
    if (std::fabs(y) < 0.006f) {
      EXPECT_NEAR(now, last, 2e-4f) << "no jump at the lid, y " << y;
    }
    last = now;
  }
}

TEST(FieldBake, ASheetHasOutsideOnBothSides) {
  TriangleMesh mesh;
  mesh.positions = {{-0.1f, 0, -0.1f}, {0.1f, 0, -0.1f}, {0.1f, 0, 0.1f}, {-0.1f, 0, 0.1f}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const DistanceField field = baked(mesh);
  for (float x = -0.08f; x < 0.08f; x += 0.01f)
    for (const float y : {-0.006f, -0.003f, 0.003f, 0.006f})
      EXPECT_NEAR(field.at({x, y, 0.02f}).distance, std::fabs(y), 0.2f * kCell) << x << " " << y;
}

TEST(FieldBake, SpheresThatCutEachOtherAreOneBody) {
  const Vec3 second(0.06f, 0, 0);
  const TriangleMesh mesh = shapes::together(shapes::sphere(0.05f, 4), shapes::sphere(0.05f, 4, second));
  FieldBaker baker(mesh, cells(kCell));
  EXPECT_TRUE(baker.mesh().open_edges.empty());
  const DistanceField field = baker.bake();
  EXPECT_GT(baker.hiddenTriangles(), 1000u);
  std::mt19937 random(8);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = randomPoint(random, 0.12f);
    const float exact = std::min(p.norm(), (p - second).norm()) - 0.05f, found = field.at(p).distance;
    if (exact > 0 && exact < field.grid.band) worst = std::max<double>(worst, std::fabs(found - exact));
    if (exact < -0.5f * kCell) {
      EXPECT_LT(found, 0) << p.transpose();
    }
  }
  EXPECT_LT(worst, 0.5 * kCell) << "the crease";
  // On the wall of the second sphere, deep inside the first.
  EXPECT_LT(field.at({0.012f, 0.01f, 0}).distance, -0.015f);
  EXPECT_LT(field.at({0.048f, 0.01f, 0}).distance, -0.015f);
  // As above, with triangles at the seam much larger than a cell.
  const TriangleMesh coarse =
      shapes::together(shapes::box({0.1f, 0.1f, 0.1f}), shapes::sphere(0.05f, 4, {0.1f, 0, 0}));
  const DistanceField boxes = baked(coarse);
  EXPECT_LT(boxes.at({0.1f, 0.02f, 0}).distance, -0.015f) << "the face within the sphere is gone";
  EXPECT_NEAR(boxes.at({0.1f, 0.08f, 0.08f}).distance, 0, 0.1f * kCell) << "the face beside it is not";
}

TEST(FieldBake, TrianglesWithoutAreaChangeNothing) {
  TriangleMesh mesh = shapes::sphere(0.05f, 3);
  const DistanceField field = baked(mesh);
  const size_t before = mesh.triangles.size();
  for (size_t t = 0; t < before; t += 5) {
    const auto [a, b, c] = mesh.triangles[t];
    mesh.triangles.push_back({a, a, a});
    mesh.triangles.push_back({b, b, c});
    mesh.triangles.push_back({a, b, a});
  }
  FieldBaker baker(mesh, cells(kCell));
  EXPECT_EQ(baker.mesh().without_area, mesh.triangles.size() - before);
  EXPECT_TRUE(baker.mesh().open_edges.empty());
  EXPECT_EQ(baker.bake().samples, field.samples);
  TriangleMesh line;
  line.positions = {{0, 0, 0}, {0.05f, 0, 0}, {0.1f, 0, 0}};
  line.triangles = {{0, 1, 2}};
  EXPECT_NEAR(baked(line).at({0.05f, 0.005f, 0}).distance, 0.005f, 0.3f * kCell);
  line.positions.assign(3, Vec3(0.3f, 0.2f, 0.1f));
  EXPECT_NEAR(baked(line).at({0.3f, 0.205f, 0.1f}).distance, 0.005f, 0.3f * kCell);
}

void expectRefused(const TriangleMesh& mesh, const FieldOptions& options, const std::string& why,
                   const BakeLimits& limits = {}) {
  const std::string error = errorOf([&] { FieldBaker baker(mesh, options, limits); });
  EXPECT_NE(error.find(why), std::string::npos) << error;
  EXPECT_NE(error.find(mesh.name), std::string::npos) << error;
}

TEST(FieldBake, WhatCannotBeBakedIsRefusedWithWhatAndWhere) {
  TriangleMesh mesh;
  mesh.name = "nothing";
  expectRefused(mesh, {}, "no triangles");
  mesh = shapes::sphere(0.1f, 2);
  mesh.positions[17].z() = std::numeric_limits<float>::quiet_NaN();
  expectRefused(mesh, {}, "vertex 17");
  mesh = shapes::sphere(0.1f, 2);
  mesh.triangles[3][1] = 100000;
  expectRefused(mesh, {}, "triangle 3");
  mesh = shapes::sphere(0.1f, 2);
  expectRefused(mesh, cells(-1), "the cell is out of range");
  expectRefused(mesh, cells(NAN), "the cell is out of range");
  expectRefused(mesh, cells(1e-5f), "bricks");
  FieldOptions options = cells(kCell);
  options.band = kCell;
  expectRefused(mesh, options, "the band is out of range");
  options = {};
  options.hair_radius = 1;
  expectRefused(mesh, options, "the hair's radius");
  BakeLimits limits;
  limits.memory_bytes = 1 << 20;
  expectRefused(mesh, cells(0.001f), "needs more memory", limits);
  for (Vec3& p : mesh.positions) p.x() += 500;
  expectRefused(mesh, cells(kCell), "too fine");
  for (Vec3& p : mesh.positions) p.x() *= 1e5f;
  expectRefused(mesh, cells(kCell), "1000 km");
}

TEST(FieldBake, ProgressGoesForwardAndStopsTheBake) {
  const TriangleMesh mesh = shapes::together(shapes::sphere(0.1f, 4), shapes::sphere(0.05f, 3, {0.1f, 0, 0}));
  FieldBaker baker(mesh, cells(kCell));
  double last = 0;
  int calls = 0;
  const DistanceField field = baker.bake([&](const std::string& what, double part) {
    EXPECT_FALSE(what.empty());
    EXPECT_GE(part, last);
    EXPECT_LE(part, 1);
    last = part;
    ++calls;
    return true;
  });
  EXPECT_GE(calls, 3);
  EXPECT_GT(last, 0);
  int left = 3;
  EXPECT_THROW(baker.bake([&](const std::string&, double) { return --left > 0; }), BakeStopped);
  EXPECT_EQ(left, 0);
  EXPECT_THROW(FieldBaker(mesh, cells(kCell), {}, [](const std::string&, double) { return false; }),
               BakeStopped);
  EXPECT_EQ(baker.bake().samples, field.samples) << "a stopped bake leaves nothing behind";
}

TEST(FieldBake, TheEstimateHoldsTheField) {
  FieldBaker baker(shapes::potato(0.1f, 4), cells(kCell));
  const DistanceField field = baker.bake();
  EXPECT_LE(field.bytes(), baker.estimate().field_bytes);
  EXPECT_GE(field.bytes(), baker.estimate().field_bytes / 2);
  EXPECT_LE(field.storedBricks(), baker.estimate().bricks);
  EXPECT_GT(baker.estimate().seconds, 0);
}

TEST(FieldBake, TheMeasureFindsWhatIsWrongWithAField) {
  FieldBaker baker(shapes::sphere(0.05f, 4), cells(kCell));
  DistanceField field = baker.bake();
  const FieldAccuracy good = baker.measure(field, 2000);
  EXPECT_EQ(good.points, 2000u);
  EXPECT_LT(good.worst, 1.5e-4);  // h^2 / 4R is 118 um at the inner end of the band
  EXPECT_LT(good.rms, good.worst);
  EXPECT_LT(good.median_angle, 2);
  EXPECT_EQ(good.wrong_side, 0u);
  EXPECT_EQ(good.unclear, 0u);
  for (uint32_t& word : field.samples) word ^= 0x80008000;
  const FieldAccuracy bad = baker.measure(field, 2000);
  EXPECT_GT(bad.worst, 0.005);
  EXPECT_GT(bad.wrong_side, 100u);
  EXPECT_GT(FieldBaker(bowl(), cells(kCell)).measure(baked(bowl()), 2000).unclear, 20u);
}

TEST(FieldBake, CellAndBandFollowFromHairAndBody) {
  EXPECT_NEAR(defaultFieldCell(40e-6f, 0.8f), 0.002f, 1e-6);
  EXPECT_NEAR(defaultFieldCell(40e-6f, 0), 40e-6f, 1e-9);
  EXPECT_NEAR(defaultFieldBand(40e-6f, 0.002f), 0.00804f, 1e-7);
  const FieldOptions resolved = resolveFieldOptions(shapes::sphere(0.1f, 2), {});
  EXPECT_NEAR(resolved.cell, std::sqrt(0.2f * std::sqrt(3.0f) * 40e-6f / 8), 1e-4);
  EXPECT_FLOAT_EQ(resolved.band, defaultFieldBand(40e-6f, resolved.cell));
}

TEST(FieldBake, TheKeyIsOfWhatTheFieldDependsOn) {
  const TriangleMesh mesh = shapes::sphere(0.1f, 2);
  const FieldOptions options = resolveFieldOptions(mesh, cells(kCell));
  const uint64_t key = fieldKey(mesh, options);
  EXPECT_EQ(fieldKey(shapes::sphere(0.1f, 2), options), key);
  TriangleMesh other = mesh;
  other.name = "elsewhere";
  other.normals.resize(other.positions.size());
  EXPECT_EQ(fieldKey(other, options), key);
  other.positions[5].y() = std::nextafter(other.positions[5].y(), 1.0f);
  EXPECT_NE(fieldKey(other, options), key);
  other = mesh;
  std::swap(other.triangles[0][0], other.triangles[0][1]);
  EXPECT_NE(fieldKey(other, options), key);
  FieldOptions wider = options;
  wider.band *= 1.5f;
  EXPECT_NE(fieldKey(mesh, wider), key);
  EXPECT_NE(fieldKey(mesh, resolveFieldOptions(mesh, cells(0.003f))), key);
}

// Each brick with as many cells around it as its evenness states.
TEST(FieldEvenness, NormalsAboutEvenBricksAreLessThan60DegreesApart) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> part(0, 1);
  for (const TriangleMesh& mesh : {shapes::sphere(0.08f, 4), shapes::box({0.05f, 0.003f, 0.05f})}) {
    const DistanceField field = baked(mesh, kFine);
    const FieldGrid& grid = field.grid;
    const std::vector<uint32_t> words = field.evenness();
    size_t even_bricks = 0, others = 0;
    for (uint32_t n = 0; n < field.index.size(); ++n) {
      const uint32_t entry = field.index[n];
      if (entry >= kInsideBrick) continue;
      const uint32_t even = words[entry / kEvennessesPerWord] >> (2 * (entry % kEvennessesPerWord)) & 3;
      ++(even > 0 ? even_bricks : others);
      if (even == 0) continue;
      const float around = static_cast<float>(even - 1) * grid.cell, edge = kBrickCells * grid.cell;
      const uint32_t x = n % grid.bricks[0], y = n / grid.bricks[0] % grid.bricks[1],
                     z = n / grid.bricks[0] / grid.bricks[1];
      const Vec3 low = samplePosition(grid, x * kBrickCells, y * kBrickCells, z * kBrickCells);
      const auto normal = [&] {
        const Vec3 at(part(random), part(random), part(random));
        return field.at(low + (edge + 2 * around) * at - Vec3::Constant(around)).gradient.normalized();
      };
      for (int pair = 0; pair < 50; ++pair) ASSERT_GT(normal().dot(normal()), 0.5f) << n << ", " << even;
    }
    EXPECT_GT(even_bricks, 0u);
    const bool thin = mesh.triangles.size() == 12;
    EXPECT_TRUE(others > 0 || !thin) << "where the sides of a thin body meet";
  }
}

}  // namespace
}  // namespace strandcast
