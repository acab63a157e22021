#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "collision/field_bake.h"
#include "collision/field_grid.h"
#include "core/content_hash.h"
#include "core/error.h"

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

}  // namespace

float defaultFieldCell(float hair_radius, float diagonal) {
  return std::max(hair_radius, std::sqrt(diagonal * hair_radius / 8));
}

float defaultFieldBand(float hair_radius, float cell) { return 4 * cell + hair_radius; }

Box usedBounds(const TriangleMesh& mesh) {
  Box box;
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t corner : triangle) box.extend(Eigen::Vector3f(mesh.positions[corner]));
  return box;
}

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

}  // namespace strandcast
