#include "transport/recording/air_grids.h"

#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "transport/codec/bit_blocks.h"

namespace strandcast {
namespace {

constexpr int kCompression = 1;    // low, because the simulation waits while a grid is packed
constexpr float kLargest = 32767;  // magnitude of a quantised value
constexpr float kFarthest = 1e7f;  // m
constexpr float kLargestUnit = 1e30f;

bool isShape(uint32_t cells, const Vec3& origin, float cell) {
  return cells > 0 && cells <= kMaxGridCells && cells % kGridLayers == 0 && origin.allFinite() &&
         origin.cwiseAbs().maxCoeff() <= kFarthest && cell > 0 && cell <= kFarthest;
}

size_t slabSize(uint32_t cells) { return size_t{kGridLayers} * cells * cells; }

}  // namespace

bool isSound(const AirGrids& grids) {
  if (!isShape(grids.cells, grids.origin, grids.cell)) return false;
  const size_t count = slabSize(grids.cells) * (grids.cells / kGridLayers);
  const auto holds = [](const std::vector<float>& values) { return !values.empty(); };
  if (std::none_of(grids.values.begin(), grids.values.end(), holds)) return false;
  return std::all_of(grids.values.begin(), grids.values.end(), [&](const std::vector<float>& values) {
    return values.empty() ||
           (values.size() == count && std::all_of(values.begin(), values.end(), [](float v) {
              return std::fabs(v) <= kLargestUnit;  // false for NaN
            }));
  });
}

void packLayers(const AirGrids& grids, uint32_t first_layer, GridRecord& out) {
  out.cells = grids.cells;
  out.origin = {grids.origin.x(), grids.origin.y(), grids.origin.z()};
  out.cell = grids.cell;
  out.first_layer = first_layer;
  out.values = 0;
  out.units.clear();
  const size_t count = slabSize(grids.cells), first = size_t{first_layer} * grids.cells * grids.cells;
  std::vector<uint8_t> low, high;
  for (size_t which = 0; which < kGridValues; ++which) {
    if (grids.values[which].empty()) continue;
    out.values |= 1u << which;
    const float* const values = grids.values[which].data() + first;
    float largest = 0;
    for (size_t i = 0; i < count; ++i) largest = std::max(largest, std::fabs(values[i]));
    const float unit = largest / kLargest;
    const bool is_zero = !std::isnormal(unit);
    out.units.push_back(is_zero ? 0 : unit);
    uint16_t before = 0;
    for (size_t i = 0; i < count; ++i) {
      const float whole = is_zero ? 0 : std::clamp(std::nearbyint(values[i] / unit), -kLargest, kLargest);
      const auto number = static_cast<uint16_t>(static_cast<int>(whole));
      const auto change = static_cast<uint16_t>(number - before);
      before = number;
      const uint16_t folded = zigzag(change);
      low.push_back(static_cast<uint8_t>(folded));
      high.push_back(static_cast<uint8_t>(folded >> 8));
    }
  }
  low.insert(low.end(), high.begin(), high.end());
  out.packed.resize(ZSTD_compressBound(low.size()));
  out.packed.resize(
      ZSTD_compress(out.packed.data(), out.packed.size(), low.data(), low.size(), kCompression));
}

bool addLayers(const GridRecord& record, AirGrids& grids) {
  const Vec3 origin(record.origin[0], record.origin[1], record.origin[2]);
  if (!isShape(record.cells, origin, record.cell) || record.values == 0 ||
      record.values >> kGridValues != 0 ||
      record.units.size() != static_cast<size_t>(std::popcount(record.values)) ||
      !std::all_of(record.units.begin(), record.units.end(),
                   [](float unit) { return unit >= 0 && unit <= kLargestUnit; }))
    return false;
  if (record.first_layer == 0) {
    grids.cells = record.cells;
    grids.origin = origin;
    grids.cell = record.cell;
    for (std::vector<float>& values : grids.values) values.clear();
  }
  const size_t count = slabSize(record.cells),
               held = size_t{record.first_layer} * record.cells * record.cells;
  if (record.cells != grids.cells || origin != grids.origin || record.cell != grids.cell ||
      record.first_layer >= record.cells)
    return false;
  for (size_t which = 0; which < kGridValues; ++which)
    if (grids.values[which].size() != ((record.values >> which & 1) != 0 ? held : 0)) return false;

  std::vector<uint8_t> bytes(2 * count * record.units.size());
  if (ZSTD_decompress(bytes.data(), bytes.size(), record.packed.data(), record.packed.size()) != bytes.size())
    return false;
  const uint8_t *low = bytes.data(), *high = low + bytes.size() / 2;
  auto unit = record.units.begin();
  for (size_t which = 0; which < kGridValues; ++which) {
    if ((record.values >> which & 1) == 0) continue;
    std::vector<float>& values = grids.values[which];
    values.reserve(held + count);
    uint16_t number = 0;
    for (size_t i = 0; i < count; ++i) {
      const auto folded = static_cast<uint16_t>(*low++ | *high++ << 8);
      number = static_cast<uint16_t>(number + unzigzag(folded));
      values.push_back(*unit * static_cast<float>(static_cast<int16_t>(number)));
    }
    ++unit;
  }
  return true;
}

}  // namespace strandcast
