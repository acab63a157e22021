#include "io/distance_field_file.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>

#include "core/hash.h"
#include "io/file_bytes.h"
#include "io/little_endian.h"

namespace strandcast {
namespace {

constexpr std::array<char, 8> kMagic{'S', 'T', 'R', 'N', 'D', 'S', 'D', 'F'};
constexpr uint32_t kVersion = 2;
constexpr uint64_t kHashAt = 24;
constexpr uint64_t kGridAt = 32;
constexpr uint64_t kArraysAt = kGridAt + sizeof(FieldGrid);

/// Hash of all bytes of a file except the hash itself.
uint64_t hashOf(std::span<const std::byte> bytes) {
  ContentHash hash;
  hash.add(bytes.data(), kHashAt);
  hash.add(bytes.data() + kGridAt, bytes.size() - kGridAt);
  return hash.value();
}

FieldGrid readGrid(const ByteReader& reader) {
  const auto grid = reader.at<FieldGrid>(kGridAt);
  const auto inRange = [](float value, double low, double high) { return value >= low && value <= high; };
  for (const float coordinate : grid.origin)
    if (!inRange(coordinate, -1e7, 1e7)) reader.fail("the grid lies nowhere near its body", kGridAt);
  if (!inRange(grid.cell, 1e-6, 1e3)) reader.fail("the cell is out of range", kGridAt + 12);
  if (!inRange(grid.band, grid.cell, 1001.0 * grid.cell))
    reader.fail("the band is out of range", kGridAt + 28);
  if (!inRange(grid.quantum, 1e-6 * grid.cell, grid.cell))
    reader.fail("the unit of the samples is out of range", kGridAt + 32);
  uint64_t corners = 1;
  for (const uint32_t bricks : grid.bricks) {
    corners *= uint64_t{bricks} + 1;
    if (bricks == 0 || corners > kMaxGridBricks)
      reader.fail(fmt::format("a grid of {} x {} x {} bricks cannot be", grid.bricks[0], grid.bricks[1],
                              grid.bricks[2]),
                  kGridAt + 16);
  }
  return grid;
}

}  // namespace

void stampDistanceField(std::span<std::byte> bytes) {
  if (bytes.size() < kGridAt) return;
  const uint64_t hash = hashOf(bytes);
  std::memcpy(bytes.data() + kHashAt, &hash, sizeof hash);
}

std::vector<std::byte> encodeDistanceField(const DistanceField& field, uint64_t key) {
  ByteWriter writer;
  writer.reserve(kArraysAt + field.bytes());
  writer.raw(kMagic.data(), kMagic.size());
  writer.put(kVersion);
  writer.put(static_cast<uint32_t>(field.storedBricks()));
  writer.put(key);
  writer.put(uint64_t{0});
  writer.put(field.grid);
  writer.raw(field.index.data(), field.index.size() * sizeof(uint32_t));
  writer.raw(field.samples.data(), field.samples.size() * sizeof(uint32_t));
  writer.raw(field.corners.data(), field.corners.size() * sizeof(float));
  std::vector<std::byte> bytes = writer.take();
  stampDistanceField(bytes);
  return bytes;
}

StoredField readDistanceField(std::span<const std::byte> bytes, const std::string& name) {
  const ByteReader reader(bytes, name);
  if (reader.at<std::array<char, 8>>(0) != kMagic)
    reader.fail("this is not a .sdf file of Strandcast (it does not start with STRNDSDF)", 0,
                "bake the mesh with strandcast bake");
  const auto version = reader.at<uint32_t>(8);
  if (version != kVersion)
    reader.fail(fmt::format("this is version {} of the format, version {} can be read", version, kVersion), 8,
                "bake the mesh again");
  const uint64_t stored = reader.at<uint32_t>(12);
  StoredField out;
  out.key = reader.at<uint64_t>(16);
  DistanceField& field = out.field;
  field.grid = readGrid(reader);
  const auto& [nx, ny, nz] = field.grid.bricks;
  const uint64_t bricks = uint64_t{nx} * ny * nz, words = stored * kBrickWords,
                 corners = uint64_t{nx + 1} * (ny + 1) * (nz + 1);
  if (stored > bricks) reader.fail(fmt::format("{} bricks are stored of {}", stored, bricks), 12);
  reader.require(kArraysAt, bricks + words + corners, sizeof(uint32_t), "bricks");
  const uint64_t end = kArraysAt + (bricks + words + corners) * sizeof(uint32_t);
  if (reader.size() != end) reader.fail("the file goes on after its end", end);

  field.index.resize(bricks);
  reader.copy<uint32_t>(kArraysAt, bricks, field.index.data(), "index");
  uint32_t next = 0;  // bricks are stored in the order of the index
  for (uint64_t b = 0; b < bricks; ++b) {
    if (field.index[b] == kOutsideBrick || field.index[b] == kInsideBrick) continue;
    if (field.index[b] != next || next == stored)
      reader.fail(
          fmt::format("the index names brick {} where {} of {} follows", field.index[b], next, stored),
          kArraysAt + b * sizeof(uint32_t));
    ++next;
  }
  if (next != stored) reader.fail(fmt::format("the index names {} bricks of {}", next, stored), 12);
  const uint64_t samples_at = kArraysAt + bricks * sizeof(uint32_t),
                 corners_at = samples_at + words * sizeof(uint32_t);
  field.samples.resize(words);
  reader.copy<uint32_t>(samples_at, words, field.samples.data(), "samples");
  field.corners.resize(corners);
  reader.copy<float>(corners_at, corners, field.corners.data(), "corners");
  for (uint64_t c = 0; c < corners; ++c)
    if (!(std::fabs(field.corners[c]) < 1e7f))
      reader.fail("a distance is out of range", corners_at + c * sizeof(float));
  if (reader.at<uint64_t>(kHashAt) != hashOf(bytes))
    reader.fail("the file is damaged: its bytes are not those that were written", kHashAt,
                "bake the mesh again");
  return out;
}

void writeDistanceField(const std::filesystem::path& file, const DistanceField& field, uint64_t key) {
  writeFileBytes(file, encodeDistanceField(field, key));
}

StoredField loadDistanceField(const std::filesystem::path& file) {
  return readDistanceField(readFileBytes(file), file.string());
}

}  // namespace strandcast
