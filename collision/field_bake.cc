#include "collision/field_bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "collision/bake_loop.h"
#include "collision/body_distance.h"
#include "core/error.h"
#include "core/hash.h"

namespace strandcast {
namespace {

std::string nameOf(const TriangleMesh& mesh) { return mesh.name.empty() ? "mesh" : "mesh " + mesh.name; }

void requireRange(float value, float low, float high, const char* what, const TriangleMesh& mesh) {
  if (value >= low && value <= high) return;
  throw Error(fmt::format("{} is out of range", what), fmt::format("{} m, for {}", value, nameOf(mesh)),
              fmt::format("give {:g} to {:g} m", low, high));
}

/// To be raised with each change of the baking that changes fields.
constexpr uint32_t kBakingVersion = 2;

/// Value of an index entry during the search: the brick is to be stored.
constexpr uint32_t kCandidate = 0;

/// Bounding box of the vertices that triangles use.
Box usedBounds(const TriangleMesh& mesh) {
  Box box;
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t corner : triangle) box.extend(Eigen::Vector3f(mesh.positions[corner]));
  return box;
}

/// Grid around the mesh with a margin of at least the band on each side. Throws Error when it is too large.
FieldGrid makeFieldGrid(const TriangleMesh& mesh, const FieldOptions& resolved) {
  FieldGrid grid{};
  grid.cell = resolved.cell;
  grid.band = resolved.band;
  // Range of the samples: the farthest sample of a brick whose nearest one is within the band plus a cell.
  grid.quantum =
      (resolved.band + resolved.cell + std::numbers::sqrt3_v<float> * resolved.cell * kBrickCells) /
      std::numeric_limits<int16_t>::max();
  const Box box = usedBounds(mesh);
  const double edge = double{resolved.cell} * kBrickCells;
  double corners = 1;
  for (int a = 0; a < 3; ++a) {
    const double low = box.min()[a], high = box.max()[a];
    // A hundredth of a cell more than the band, so that rounding does not reduce the band.
    const double bricks = std::ceil((high - low + 2 * (resolved.band + 0.01 * resolved.cell)) / edge);
    corners *= bricks + 1;
    if (corners > kMaxGridBricks) break;
    grid.bricks[a] = static_cast<uint32_t>(bricks);
    grid.origin[a] = static_cast<float>(0.5 * (low + high - bricks * edge));
  }
  if (corners > kMaxGridBricks)
    throw Error(fmt::format("the field would have more than {} bricks", kMaxGridBricks),
                fmt::format("{}, {:.3g} x {:.3g} x {:.3g} m in cells of {:g} m", nameOf(mesh),
                            box.sizes().x(), box.sizes().y(), box.sizes().z(), resolved.cell),
                "give a larger cell (--cell), or check the unit of the mesh");
  return grid;
}

}  // namespace

float defaultFieldCell(float hair_radius, float diagonal) {
  return std::max(hair_radius, std::sqrt(diagonal * hair_radius / 8));
}

float defaultFieldBand(float hair_radius, float cell) { return 4 * cell + hair_radius; }

FieldOptions resolveFieldOptions(const TriangleMesh& mesh, const FieldOptions& options) {
  requireSoundMesh(mesh);
  FieldOptions out = options;
  requireRange(out.hair_radius, 1e-6f, 5e-3f, "the hair's radius", mesh);
  const Box box = usedBounds(mesh);
  const float farthest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  if (farthest > 1e6f)
    throw Error("a vertex lies more than 1000 km away", nameOf(mesh), "check the unit of the mesh");
  if (out.cell == 0) out.cell = defaultFieldCell(out.hair_radius, box.diagonal().norm());
  requireRange(out.cell, 1e-6f, 1e3f, "the cell", mesh);
  if (out.cell < 100 * std::numeric_limits<float>::epsilon() * farthest)
    throw Error("the cell is too fine for a body so far from the origin",
                fmt::format("{}, cells of {:g} m at {:g} m", nameOf(mesh), out.cell, farthest),
                "give a larger cell (--cell) or move the body to the origin");
  if (out.band == 0) out.band = defaultFieldBand(std::max(out.hair_radius, out.thickest_hair), out.cell);
  requireRange(out.band, 2 * out.cell, 1000 * out.cell, "the band", mesh);
  makeFieldGrid(mesh, out);
  return out;
}

uint64_t fieldKey(const TriangleMesh& mesh, const FieldOptions& resolved) {
  ContentHash hash;
  hash.add(kBakingVersion);
  hash.add(resolved.cell);
  hash.add(resolved.band);
  hash.add(uint32_t{resolved.is_oriented});
  hash.add(mesh.positions.size());
  for (const Vec3& position : mesh.positions) hash.add(position.data(), 3 * sizeof(float));
  hash.add(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
  return hash.value();
}

namespace {

/// A cube of 2^level bricks per edge, clipped to the grid. Level 0: a brick.
struct Cube {
  std::array<uint32_t, 3> at;
  uint32_t level;
};

class BrickSearch {
 public:
  explicit BrickSearch(const FieldGrid& grid) : grid_(grid) {}

  std::vector<uint32_t> run(const MeshQuery& query, BakeLoop& loop, const BakeProgress& progress,
                            double done) const {
    std::vector<uint32_t> index(size_t{grid_.bricks[0]} * grid_.bricks[1] * grid_.bricks[2], kOutsideBrick);
    uint32_t level = std::bit_width(std::max({grid_.bricks[0], grid_.bricks[1], grid_.bricks[2]}) - 1);
    for (std::vector<Cube> cubes{{{0, 0, 0}, level}};; --level) {
      std::vector<uint8_t> near(cubes.size());
      loop.run(cubes.size(), progress, "finding bricks", done, done,
               [&](size_t i) { near[i] = isNearSurface(cubes[i], query); });
      std::vector<Cube> finer;
      for (size_t i = 0; i < cubes.size(); ++i) {
        if (near[i] == 0) continue;
        if (level > 0)
          split(cubes[i], finer);
        else
          index[brickNumber(cubes[i].at)] = kCandidate;
      }
      if (level == 0) return index;
      cubes = std::move(finer);
    }
  }

 private:
  size_t brickNumber(const std::array<uint32_t, 3>& at) const {
    return (size_t{at[2]} * grid_.bricks[1] + at[1]) * grid_.bricks[0] + at[0];
  }

  bool isNearSurface(const Cube& cube, const MeshQuery& query) const {
    Vec3 centre, half;
    for (int a = 0; a < 3; ++a) {
      const uint32_t end = std::min(cube.at[a] + (1u << cube.level), grid_.bricks[a]);
      half[a] = 0.5f * grid_.cell * static_cast<float>((end - cube.at[a]) * kBrickCells);
      centre[a] = grid_.origin[a] + grid_.cell * static_cast<float>(cube.at[a] * kBrickCells) + half[a];
    }
    const float reach = grid_.band + half.norm();
    return query.distance(centre, reach) < reach;
  }

  void split(const Cube& cube, std::vector<Cube>& finer) const {
    const uint32_t side = 1u << (cube.level - 1);
    for (uint32_t child = 0; child < 8; ++child) {
      Cube part{cube.at, cube.level - 1};
      for (int a = 0; a < 3; ++a) part.at[a] += (child >> a & 1) * side;
      if (part.at[0] < grid_.bricks[0] && part.at[1] < grid_.bricks[1] && part.at[2] < grid_.bricks[2])
        finer.push_back(part);
    }
  }

  const FieldGrid& grid_;
};

/// Index of the grid with kCandidate for bricks that may come nearer to the mesh than the band, else
/// kOutsideBrick. The grid is subdivided as an octree, so the work scales with the surface and not with the
/// grid. `done`: value reported as progress.
std::vector<uint32_t> findBricks(const FieldGrid& grid, const MeshQuery& query, BakeLoop& loop,
                                 const BakeProgress& progress, double done) {
  return BrickSearch(grid).run(query, loop, progress, done);
}

/// Random points in the stored bricks of a field.
class BandPlaces {
 public:
  explicit BandPlaces(const DistanceField& field) : grid_(field.grid) {
    for (size_t i = 0; i < field.index.size(); ++i)
      if (field.index[i] < kInsideBrick) stored_.push_back(static_cast<uint32_t>(i));
  }
  bool empty() const { return stored_.empty(); }
  Vec3 next() {
    const uint32_t brick = stored_[random_() % stored_.size()], nx = grid_.bricks[0], ny = grid_.bricks[1];
    const float x = fraction(), y = fraction(), z = fraction();
    return samplePosition(grid_, brick % nx * kBrickCells, brick / nx % ny * kBrickCells,
                          brick / nx / ny * kBrickCells) +
           Vec3(x, y, z) * (grid_.cell * kBrickCells);
  }

 private:
  float fraction() { return std::ldexp(static_cast<float>(random_() >> 40), -24); }

  const FieldGrid& grid_;
  std::vector<uint32_t> stored_;
  std::mt19937_64 random_{1};
};

double degrees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
}

/// Compares a field with the exact distance of `body` at `points` random points of its band.
FieldAccuracy measureField(const DistanceField& field, const BodyDistance& body, size_t points,
                           const BakeProgress& progress) {
  const FieldGrid& grid = field.grid;
  FieldAccuracy out;
  std::vector<double> angles;
  double squares = 0;
  BandPlaces places(field);
  for (size_t tries = 0; out.points < points && tries < 50 * points && !places.empty(); ++tries) {
    if (tries % 16 == 0 && progress &&
        !progress("measuring", static_cast<double>(out.points) / static_cast<double>(points)))
      throw BakeStopped();
    const Vec3 p = places.next();
    if (body.toMesh(p, grid.band) >= grid.band) continue;
    ++out.points;
    const BodyPoint exact = body.at(p);
    const FieldSample found = field.at(p);
    const double error = std::fabs(double{found.distance} - double{exact.signed_distance});
    out.worst = std::max(out.worst, error);
    squares += error * error;
    if (exact.in_doubt) ++out.unclear;
    if (std::fabs(exact.signed_distance) > grid.cell && found.distance * exact.signed_distance < 0)
      ++out.wrong_side;
    // Very near the surface rounding spoils the direction to it.
    if (exact.to_lid || std::fabs(exact.signed_distance) < 0.01f * grid.cell) continue;
    const double side = exact.signed_distance < 0 ? -1 : 1;
    angles.push_back(
        degrees((p - body.nearestOnMesh(p)).cast<double>() * side, found.gradient.cast<double>()));
  }
  if (out.points > 0) out.rms = std::sqrt(squares / static_cast<double>(out.points));
  if (!angles.empty()) {
    std::sort(angles.begin(), angles.end());
    out.median_angle = angles[angles.size() / 2];
    out.p99_angle = angles[angles.size() * 99 / 100];
    out.worst_angle = angles.back();
  }
  return out;
}

using Corners = std::array<Vec3, 3>;

std::vector<uint32_t> candidates(const std::vector<uint32_t>& index) {
  std::vector<uint32_t> out;
  for (size_t i = 0; i < index.size(); ++i)
    if (index[i] == kCandidate) out.push_back(static_cast<uint32_t>(i));
  return out;
}

double mebibytes(size_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

}  // namespace

struct FieldBaker::Impl {
  TriangleMesh mesh;  // without normals
  FieldOptions options;
  BakeLimits limits;
  BakeLoop loop;
  SurfaceRepair repair;
  MeshCheck check;
  double in_doubt = 0;
  FieldGrid grid{};
  BakeEstimate estimate;
  size_t mesh_bytes = 0;                                               // mesh and hierarchies
  double seconds_hidden = 0, seconds_corners = 0, seconds_bricks = 0;  // parts of the estimate
  std::vector<uint32_t> index;  // candidates with respect to the whole mesh
  std::optional<MeshQuery> whole;
  std::optional<MeshQuery> outer;  // empty if equal to `whole`
  size_t hidden = 0;
  bool parted = false;  // `outer` and `hidden` are computed

  Impl(const TriangleMesh& given, const FieldOptions& wanted, const BakeLimits& within)
      : options(resolveFieldOptions(given, wanted)), limits(within), loop(within.threads) {
    mesh.name = given.name;
    mesh.positions = given.positions;
    mesh.triangles = given.triangles;
  }

  const MeshQuery& surface() const { return outer ? *outer : *whole; }
  BodyDistance body() const { return {*whole, surface(), check.open_edges}; }
  size_t cornerRows() const { return size_t{grid.bricks[1] + 1} * (grid.bricks[2] + 1); }

  void require(size_t bytes, const std::string& what) const {
    if (bytes <= limits.memory_bytes) return;
    throw Error("the bake needs more memory than it may have",
                fmt::format("{}: {:.0f} MiB for {}, the limit is {:.0f} MiB", mesh.name, mebibytes(bytes),
                            what, mebibytes(limits.memory_bytes)),
                "give a larger cell (--cell), or raise the limit (--memory)");
  }

  void prepare(const BakeProgress& progress) {
    const size_t given = mesh.triangles.size();
    // Two hierarchies: of the whole mesh, and of the surface that bounds the outside.
    mesh_bytes = 2 * MeshQuery::bytes(given) +
                 given * (sizeof(mesh.triangles[0]) + sizeof(std::vector<Corners>)) +
                 mesh.positions.size() * sizeof(Vec3);
    require(mesh_bytes, fmt::format("the hierarchy of {} triangles", given));
    reportProgress(progress, "checking the mesh");
    if (!options.is_oriented) {
      OrientedSurface oriented = orientSurface(std::move(mesh));
      mesh = std::move(oriented.mesh);
      repair = oriented.repair;
    }
    check = checkMesh(mesh);
    grid = makeFieldGrid(mesh, options);
    reportProgress(progress, "building the hierarchy");
    whole.emplace(mesh);
    if (!check.open_edges.empty()) in_doubt = strandcast::uncertainShare(mesh, *whole, kAway * options.cell);
    index = findBricks(grid, *whole, loop, progress, 0);
    const std::vector<uint32_t> found = candidates(index);
    const size_t corner_count = cornerRows() * (grid.bricks[0] + 1);
    estimate.bricks = found.size();
    estimate.field_bytes = sizeof(FieldGrid) +
                           sizeof(uint32_t) * (index.size() + found.size() * kBrickWords) +
                           sizeof(float) * corner_count;
    // Packing and writing need the field twice.
    estimate.working_bytes = mesh_bytes + estimate.field_bytes;
    require(estimate.working_bytes + estimate.field_bytes,
            fmt::format("{} bricks and the hierarchy", found.size()));
    std::vector<uint32_t> words(kBrickWords * found.size());
    std::vector<float> row(corner_count);
    seconds_hidden = loop.secondsFor(mesh.triangles.size(), progress, [&](size_t t) { outerPieces(t); });
    seconds_corners =
        loop.secondsFor(cornerRows(), progress, [&](size_t i) { bakeCornerRow(i, row.data()); });
    seconds_bricks = loop.secondsFor(found.size(), progress,
                                     [&](size_t b) { bakeBrick(found[b], words.data() + b * kBrickWords); });
    estimate.seconds = seconds_hidden + seconds_corners + seconds_bricks;
  }

  static constexpr float kAway = 0.01f;  // distance in cells from the surface at which its sides are tested

  static void reportProgress(const BakeProgress& progress, const char* what) {
    if (progress && !progress(what, 0)) throw BakeStopped();
  }

  Corners corners(size_t t) const {
    const auto& [a, b, c] = mesh.triangles[t];
    return {mesh.positions[a], mesh.positions[b], mesh.positions[c]};
  }
  std::vector<Corners> outerPieces(size_t t) const {
    return strandcast::outerPieces(*whole, corners(t), 2 * options.cell, loop.stopping());
  }

  /// Removes what lies inside the body: it would count for distances but not for signs.
  void part(const BakeProgress& progress, double to) {
    if (parted) return;
    std::vector<std::vector<Corners>> pieces(mesh.triangles.size());  // of triangles not kept whole
    std::vector<uint8_t> whole_one(pieces.size());
    loop.run(pieces.size(), progress, "looking for hidden parts", 0, to, [&](size_t t) {
      std::vector<Corners> found = outerPieces(t);
      whole_one[t] = found.size() == 1 && found[0] == corners(t);
      if (whole_one[t] == 0) pieces[t] = std::move(found);
    });
    TriangleMesh shown;
    shown.name = mesh.name;
    shown.positions = mesh.positions;
    hidden = 0;
    for (size_t t = 0; t < pieces.size(); ++t) {
      if (whole_one[t] != 0) shown.triangles.push_back(mesh.triangles[t]);
      if (whole_one[t] == 0 && pieces[t].empty()) ++hidden;
      for (const Corners& piece : pieces[t]) {
        const auto first = static_cast<uint32_t>(shown.positions.size());
        shown.positions.insert(shown.positions.end(), piece.begin(), piece.end());
        shown.triangles.push_back({first, first + 1, first + 2});
      }
    }
    const bool all_whole = std::all_of(whole_one.begin(), whole_one.end(), [](uint8_t w) { return w != 0; });
    if (!all_whole && !shown.empty()) outer.emplace(shown);
    parted = true;
  }

  void bakeCornerRow(size_t row, float* all) const {
    const auto j = static_cast<uint32_t>(row % (grid.bricks[1] + 1)),
               k = static_cast<uint32_t>(row / (grid.bricks[1] + 1));
    const float step = grid.cell * kBrickCells;
    const BodyDistance distances = body();
    DistanceWalk walk(distances);
    float* out = all + row * (grid.bricks[0] + 1);
    for (uint32_t i = 0; i <= grid.bricks[0] && !loop.stopping(); ++i) {
      const Vec3 p = samplePosition(grid, i * kBrickCells, j * kBrickCells, k * kBrickCells);
      out[i] = i == 0 ? walk.start(p, check.open_edges.empty()) : walk.next(p, step);
    }
  }

  /// Fills the words of a brick. Returns the smallest unsigned distance of its samples, m.
  float bakeBrick(uint32_t brick, uint32_t* words) const {
    const uint32_t x = brick % grid.bricks[0], y = brick / grid.bricks[0] % grid.bricks[1],
                   z = brick / grid.bricks[0] / grid.bricks[1];
    const auto place = [&](uint32_t i, uint32_t j, uint32_t k) {
      return samplePosition(grid, x * kBrickCells + i, y * kBrickCells + j, z * kBrickCells + k);
    };
    const BodyDistance distances = body();
    const float half = 0.5f * grid.cell * kBrickCells;
    const Vec3 centre = place(0, 0, 0) + Vec3::Constant(half);
    const bool brick_clear = distances.clearOfLids(centre, std::numbers::sqrt3_v<float> * half);
    DistanceWalk walk(distances);
    float nearest = std::numeric_limits<float>::infinity();
    // Boustrophedon order, so that successive samples are neighbours. Near a lid the walk restarts in each
    // row.
    for (uint32_t n = 0; n < kBrickSamples && !loop.stopping(); ++n) {
      const uint32_t row = n / kBrickSide, k = row / kBrickSide;
      const uint32_t j = k % 2 == 0 ? row % kBrickSide : kBrickCells - row % kBrickSide;
      const uint32_t i = row % 2 == 0 ? n % kBrickSide : kBrickCells - n % kBrickSide;
      const Vec3 p = place(i, j, k);
      const bool first = n == 0 || (!brick_clear && n % kBrickSide == 0);
      const float distance =
          first ? walk.start(p, brick_clear || distances.clearOfLids({centre.x(), p.y(), p.z()}, half))
                : walk.next(p, grid.cell);
      nearest = std::min(nearest, std::fabs(distance));
      constexpr float kMax = std::numeric_limits<int16_t>::max();
      const auto stored = static_cast<int16_t>(std::lround(std::clamp(distance / grid.quantum, -kMax, kMax)));
      const uint32_t at = (k * kBrickSide + j) * kBrickSide + i;
      words[at / 2] |= uint32_t{static_cast<uint16_t>(stored)} << (16 * (at % 2));
    }
    return nearest;
  }

  DistanceField bake(const BakeProgress& progress) {
    const double whole_seconds = std::max(estimate.seconds, 1e-9);
    const double parted_at = seconds_hidden / whole_seconds,
                 corners_at = parted_at + seconds_corners / whole_seconds;
    part(progress, parted_at);
    DistanceField field;
    field.grid = grid;
    field.index = outer ? findBricks(grid, *outer, loop, progress, parted_at) : index;
    field.corners.resize(cornerRows() * (grid.bricks[0] + 1));
    loop.run(cornerRows(), progress, "baking far distances", parted_at, corners_at,
             [&](size_t row) { bakeCornerRow(row, field.corners.data()); });
    addLids(field);
    const std::vector<uint32_t> found = candidates(field.index);
    require(mesh_bytes + 2 * (field.bytes() + found.size() * kBrickWords * sizeof(uint32_t)),
            fmt::format("{} bricks and the hierarchy", found.size()));
    field.samples.resize(found.size() * kBrickWords);
    std::vector<float> nearest(found.size());
    loop.run(found.size(), progress, "baking bricks", corners_at, 1,
             [&](size_t b) { nearest[b] = bakeBrick(found[b], field.samples.data() + b * kBrickWords); });
    keepNear(found, nearest, field);
    markFar(field);
    return field;
  }

  /// Adds bricks near lids: the search considers only the mesh. Lids are smooth, so the corners of bricks
  /// detect them.
  void addLids(DistanceField& field) const {
    if (check.open_edges.empty()) return;
    const float reach = grid.band + 0.5f * std::numbers::sqrt3_v<float> * grid.cell * kBrickCells;
    forFarBricks(field, [&](uint32_t& entry, const std::array<float, 8>& at) {
      const float least = *std::min_element(at.begin(), at.end()),
                  most = *std::max_element(at.begin(), at.end());
      if (least < reach && most > -reach) entry = kCandidate;
    });
  }

  /// Marks bricks beyond the band: no surface passes through them, so their sign is that of their corners.
  static void markFar(DistanceField& field) {
    forFarBricks(field, [](uint32_t& entry, const std::array<float, 8>& at) {
      if (std::accumulate(at.begin(), at.end(), 0.0f) < 0) entry = kInsideBrick;
    });
  }

  /// Calls act(entry of the index, distances at the corners) for each brick marked kOutsideBrick.
  template <class Act>
  static void forFarBricks(DistanceField& field, Act act) {
    const auto& [nx, ny, nz] = field.grid.bricks;
    size_t brick = 0;
    for (uint32_t z = 0; z < nz; ++z)
      for (uint32_t y = 0; y < ny; ++y)
        for (uint32_t x = 0; x < nx; ++x, ++brick) {
          if (field.index[brick] != kOutsideBrick) continue;
          std::array<float, 8> at;
          for (uint32_t c = 0; c < 8; ++c)
            at[c] =
                field.corners[((z + (c >> 2)) * size_t{ny + 1} + y + (c >> 1 & 1)) * (nx + 1) + x + (c & 1)];
          act(field.index[brick], at);
        }
  }

  /// Drops superfluous bricks of the search: those without a sample nearer than the band plus a cell.
  static void keepNear(const std::vector<uint32_t>& found, const std::vector<float>& nearest,
                       DistanceField& field) {
    uint32_t kept = 0;
    for (size_t b = 0; b < found.size(); ++b) {
      if (nearest[b] > field.grid.band + field.grid.cell) {
        field.index[found[b]] = kOutsideBrick;
        continue;
      }
      const auto from = field.samples.begin() + static_cast<std::ptrdiff_t>(b * kBrickWords);
      std::copy(from, from + kBrickWords,
                field.samples.begin() + static_cast<std::ptrdiff_t>(size_t{kept} * kBrickWords));
      field.index[found[b]] = kept++;
    }
    field.samples.resize(size_t{kept} * kBrickWords);
    field.samples.shrink_to_fit();
  }
};

FieldBaker::FieldBaker(const TriangleMesh& mesh, const FieldOptions& options, const BakeLimits& limits,
                       const BakeProgress& progress)
    : impl_(std::make_unique<Impl>(mesh, options, limits)) {
  impl_->prepare(progress);
}

FieldBaker::~FieldBaker() = default;
const FieldOptions& FieldBaker::options() const { return impl_->options; }
const MeshCheck& FieldBaker::mesh() const { return impl_->check; }
const SurfaceRepair& FieldBaker::repair() const { return impl_->repair; }
double FieldBaker::uncertainShare() const { return impl_->in_doubt; }
const BakeEstimate& FieldBaker::estimate() const { return impl_->estimate; }
size_t FieldBaker::hiddenTriangles() const { return impl_->hidden; }

std::vector<std::string> FieldBaker::warnings() const {
  constexpr double kWorthSaying = 0.02;
  std::vector<std::string> out = impl_->repair.lines();
  if (impl_->in_doubt > kWorthSaying)
    out.push_back(fmt::format(
        "inside and outside are in doubt at {:.0f} % of the surface, where hair may get in: close "
        "its holes ({} open edges)",
        100 * impl_->in_doubt, impl_->check.open_edges.size()));
  return out;
}

DistanceField FieldBaker::bake(const BakeProgress& progress) { return impl_->bake(progress); }

FieldAccuracy FieldBaker::measure(const DistanceField& field, size_t points, const BakeProgress& progress) {
  impl_->part(progress, 1);
  return measureField(field, impl_->body(), points, progress);
}

}  // namespace strandcast
