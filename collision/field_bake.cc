#include "collision/field_bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "collision/bake_loop.h"
#include "collision/body_distance.h"
#include "collision/brick_search.h"
#include "collision/field_accuracy.h"
#include "collision/field_grid.h"
#include "collision/outer_surface.h"
#include "collision/surface_samples.h"
#include "core/error.h"

namespace strandcast {
namespace {

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
    tell(progress, "checking the mesh");
    if (!options.is_oriented) {
      OrientedSurface oriented = orientSurface(std::move(mesh));
      mesh = std::move(oriented.mesh);
      repair = oriented.repair;
    }
    check = checkMesh(mesh);
    grid = makeFieldGrid(mesh, options);
    tell(progress, "building the hierarchy");
    whole.emplace(mesh);
    if (!check.open_edges.empty()) in_doubt = strandcast::shareInDoubt(mesh, *whole, kAway * options.cell);
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

  static void tell(const BakeProgress& progress, const char* what) {
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
      constexpr float kMost = std::numeric_limits<int16_t>::max();
      const auto stored =
          static_cast<int16_t>(std::lround(std::clamp(distance / grid.quantum, -kMost, kMost)));
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
double FieldBaker::shareInDoubt() const { return impl_->in_doubt; }
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
