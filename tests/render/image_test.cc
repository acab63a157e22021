#include "io/image.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"

namespace strandcast {
namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) / name;
}

TEST(Image, SurvivesAPngRoundTrip) {
  Image image{37, 21, {}};
  for (int i = 0; i < 37 * 21 * 3; ++i) image.rgb.push_back(static_cast<uint8_t>(i * 89 + i / 7));
  const auto file = temporary("strandcast_round_trip.png");
  writePng(file, image);
  const Image back = readPng(file);
  EXPECT_EQ(back.width, 37);
  EXPECT_EQ(back.height, 21);
  EXPECT_EQ(back.rgb, image.rgb);
  std::filesystem::remove(file);
}

TEST(Image, RefusesWhatCannotBeWrittenOrRead) {
  const Image good{1, 1, {1, 2, 3}};
  EXPECT_THROW(writePng("/no such folder/picture.png", good), Error);
  EXPECT_THROW(writePng(temporary("strandcast_short.png"), Image{2, 2, {1, 2, 3}}), Error);
  EXPECT_THROW(writePng(temporary("strandcast_none.png"), Image{}), Error);
  EXPECT_THROW(readPng("/no such folder/picture.png"), Error);
  const auto file = temporary("strandcast_damaged.png");
  std::ofstream(file) << "\x89PNG\r\n\x1a\n and then nothing that fits";
  EXPECT_THROW(readPng(file), Error);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace strandcast
