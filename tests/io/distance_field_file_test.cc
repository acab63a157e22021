#include "io/distance_field_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "tests/expect_error.h"
#include "tests/io/sample_files.h"
#include "tests/io/scratch_folder.h"

namespace strandcast {
namespace {

using samples::Bytes;

TEST(DistanceFieldFile, ComesBackBitForBit) {
  const ScratchFolder folder;
  const DistanceField field = samples::field();
  writeDistanceField(folder / "ball.sdf", field, samples::kFieldKey);
  EXPECT_EQ(std::filesystem::file_size(folder / "ball.sdf"), 32 + field.bytes());
  const StoredField back = loadDistanceField(folder / "ball.sdf");
  EXPECT_EQ(back.key, samples::kFieldKey);
  EXPECT_EQ(std::memcmp(&back.field.grid, &field.grid, sizeof(FieldGrid)), 0);
  EXPECT_EQ(back.field.index, field.index);
  EXPECT_EQ(back.field.samples, field.samples);
  EXPECT_EQ(back.field.corners, field.corners);
  EXPECT_EQ(back.field.storedBricks(), 2u);
}

template <class T>
void expectRefused(size_t offset, T value, const std::vector<std::string>& why) {
  Bytes bytes = samples::sdf();
  samples::overwrite(bytes, offset, value);
  expectError([&] { readDistanceField(bytes, "ball.sdf"); }, why);
}

TEST(DistanceFieldFile, WhatNoBakeWritesIsRefusedWithTheByte) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  expectRefused(0, 'X', {"STRNDSDF", "ball.sdf, byte 0"});
  expectRefused(8, uint32_t{1}, {"version 1", "byte 8", "bake the mesh again"});
  expectRefused(12, uint32_t{3}, {"ends before its bricks"});
  expectRefused(12, uint32_t{1}, {"goes on after its end"});
  expectRefused(12, uint32_t{0xFFFFFFFF}, {"stored of 6", "byte 12"});
  expectRefused(32, kNan, {"nowhere near", "byte 32"});
  expectRefused(44, -1.0f, {"the cell is out of range", "byte 44"});
  expectRefused(48, uint32_t{0}, {"0 x 1 x 2 bricks", "byte 48"});
  expectRefused(52, uint32_t{0xFFFFFFFF}, {"cannot be"});
  expectRefused(60, kNan, {"the band is out of range", "byte 60"});
  expectRefused(64, 0.0f, {"the unit of the samples", "byte 64"});
  expectRefused(80, uint32_t{1}, {"the index names brick 1 where 0 of 2 follows", "byte 80"});
  expectRefused(80 + 4 * 4, kOutsideBrick, {"names 1 bricks of 2"});
  expectRefused(80 + 4 * 5, uint32_t{2}, {"the index names brick 2"});
  const size_t corners_at = 80 + 4 * (6 + 2 * kBrickWords);
  expectRefused(corners_at + 8, kNan,
                {"a distance is out of range", "byte " + std::to_string(corners_at + 8)});
  expectRefused(corners_at - 1, '\x01', {"the file is damaged", "byte 24", "bake the mesh again"});
  expectRefused(16, uint64_t{1}, {"the file is damaged"});
  Bytes cut = samples::sdf();
  for (const size_t size : {size_t{0}, size_t{7}, size_t{79}, cut.size() - 1}) {
    cut.resize(size);
    expectError([&] { readDistanceField(cut, "ball.sdf"); }, {"ball.sdf"});
    cut = samples::sdf();
  }
}

}  // namespace
}  // namespace strandcast
