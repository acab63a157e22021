#include "io/exr.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <limits>
#include <string>

#include "tests/expect_error.h"

namespace strandcast {
namespace {

std::string exrPath() { return std::string(STRANDCAST_BINARY_DIR) + "/exr_test.exr"; }

FloatImage exrSample() {
  FloatImage image{3, 2, {}, {{"maker", "a test"}}};
  image.channels = {{"R", {0, 1, 2, 3, 4, 5}},
                    {"Z", {-1, 1e30f, std::numeric_limits<float>::infinity(), 0.1f, 1e-30f, 7}},
                    {"single.G", {9, 8, 7, 6, 5, 4}}};
  return image;
}

std::string bytesOfExr() {
  std::ifstream in(exrPath(), std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Exr, AFileHoldsWhatWasWritten) {
  const FloatImage image = exrSample();
  writeExr(exrPath(), image);
  const std::string bytes = bytesOfExr();
  const FloatImage read = readExr(exrPath());
  EXPECT_EQ(read.width, 3);
  EXPECT_EQ(read.height, 2);
  ASSERT_EQ(read.channels.size(), 3u);
  for (const FloatImage::Channel& channel : image.channels) {
    ASSERT_NE(read.find(channel.name), nullptr) << channel.name;
    EXPECT_EQ(*read.find(channel.name), channel.values) << channel.name;
  }
  EXPECT_EQ(read.find("B"), nullptr);
  EXPECT_EQ(read.attributes.at("maker"), "a test");
  writeExr(exrPath(), image);
  EXPECT_EQ(bytesOfExr(), bytes);
  std::remove(exrPath().c_str());
}

TEST(Exr, BadInputIsOneError) {
  expectError([] { readExr("/nowhere/a.exr"); }, {"cannot be read: /nowhere/a.exr"});
  std::ofstream(exrPath()) << "P3 1 1 255 0 0 0";
  expectError([] { readExr(exrPath()); }, {"no OpenEXR file: " + exrPath()});
  writeExr(exrPath(), exrSample());
  const std::string bytes = bytesOfExr();
  int refused = 0;
  for (size_t length = 0; length < bytes.size();
       length += 7) {  // every truncation is an error or a whole picture
    std::ofstream(exrPath(), std::ios::binary) << bytes.substr(0, length);
    refused += !errorOf([] { readExr(exrPath()); }).empty();
  }
  EXPECT_GT(refused, static_cast<int>(bytes.size() / 7) - 3);
  std::remove(exrPath().c_str());
  FloatImage image = exrSample();
  expectError([&] { writeExr("/nowhere/a.exr", image); }, {"cannot be written: /nowhere/a.exr"});
  image.channels[1].values.pop_back();
  expectError([&] { writeExr(exrPath(), image); }, {"does not have the picture's size", "Z"});
}

}  // namespace
}  // namespace strandcast
