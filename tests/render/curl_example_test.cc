// Curls taken from a strand and applied to hair.
#include "render/hair_growth.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "io/groom_file.h"
#include "render/shader_validation.h"

namespace strandcast {
namespace {

using Vec = Eigen::Vector3d;
constexpr double kTurn = 2 * std::numbers::pi;

/// A slightly curved axis of about `length`, from (0, 0, 0) downwards.
Vec axisAt(double u, double length) { return length * Vec(0.1 * u * u, -u, 0.15 * u * u * u); }

/// A helix around the axis that widens from the root on.
std::vector<Vec3> helix(double length, double radius, double turns, int vertices = 400) {
  std::vector<Vec3> points;
  for (int i = 0; i < vertices; ++i) {
    const double u = i / (vertices - 1.0), angle = kTurn * turns * u;
    const double r = radius * u * (2 - u);
    points.push_back((axisAt(u, length) + r * Vec(std::cos(angle), 0, std::sin(angle))).cast<float>());
  }
  return points;
}

TEST(CurlExample, OfAHelixHasItsRadiusAndItsTurns) {
  const CurlExample curl = curlOf(helix(0.2, 0.01, 8), "helix");
  EXPECT_NEAR(curl.axis_length, 0.2f, 0.01f);
  EXPECT_NEAR(curl.turns, 8, 0.5f);
  EXPECT_NEAR(curl.reach, 0.05f, 0.008f);
  EXPECT_EQ(curl.samples[0].x, 0);
  EXPECT_EQ(curl.samples[0].y, 0);
  // Near its ends the least squares axis follows the curl slightly.
  for (int i = 40; i < 216; i += 7) {
    const CurlExample::Sample& s = curl.samples[static_cast<size_t>(i)];
    const double u = static_cast<double>(i) / CurlExample::kParts;
    EXPECT_NEAR(std::hypot(s.x, s.y), 0.05 * u * (2 - u), 0.008) << i;
  }
}

TEST(CurlExample, OfAStrandThatOnlyBendsIsNone) {
  std::vector<Vec3> bent;
  for (int i = 0; i < 30; ++i) {
    const float a = 1.4f * static_cast<float>(i) / 29;
    bent.emplace_back(0.1f * (1 - std::cos(a)), -0.1f * std::sin(a), 0);
  }
  EXPECT_LT(curlOf(bent, "arc").reach, 0.01f);
}

/// Hair around one guide with no deviation but the curl.
Hair curledHair(double scale) {
  Hair hair{};
  hair.extent = hair.width = hair.importance = 1;
  hair.example_scale = static_cast<float>(scale);
  return hair;
}

StrandSet guideAlongAxis(double length) {
  std::vector<Vec3> axis;
  for (int i = 0; i < 40; ++i) axis.push_back(axisAt(i / 39.0, length).cast<float>());
  StrandSet guides;
  guides.append(axis);
  return guides;
}

TEST(CurlExample, LaidOnItsAxisGivesTheStrandAgainAndOnALongerOneALargerStrand) {
  constexpr int kSegments = 200;
  HairGrowth growth;
  for (const double turns : {5.0, 9.0}) {
    growth.curl_example = std::make_shared<const CurlExample>(curlOf(helix(0.2, 0.01, turns), "helix"));
    for (const double times : {1.0, 2.5}) {
      const StrandSet guides = guideAlongAxis(0.2 * times);
      const HairReference reference(guides, guides.positions, kSegments);
      const Hair hair = curledHair(static_cast<double>(growth.curl_example->axis_length) * times);
      const std::vector<Vec3> strand = helix(0.2 * times, 0.01 * times, turns, 8001);
      double worst = 0;
      for (int node = kSegments / 8; node <= kSegments * 7 / 8; ++node) {
        const Vec at = reference.at(hair, growth, node).position;
        double nearest = 1;
        for (const Vec3& p : strand) nearest = std::min(nearest, (p.cast<double>() - at).norm());
        worst = std::max(worst, nearest);
      }
      // Relative to the curl's radius; the component along the axis is omitted by design.
      EXPECT_LT(worst / (0.01 * times), 0.35) << turns << " turns, " << times << " times as long";
    }
  }
}

TEST(CurlExample, IsAsLargeAsTheHairIsLong) {
  StrandSet guides;
  for (int g = 0; g < 16; ++g) {
    const float length = g < 8 ? 0.1f : 0.3f;
    const Vec3 root(0.3f * static_cast<float>(g), 0, 0);  // too far apart to interpolate hair between them
    guides.append(
        std::vector<Vec3>{root, Vec3(root - Vec3(0, 0.5f * length, 0)), Vec3(root - Vec3(0, length, 0))});
  }
  HairGrowth growth;
  growth.hairs = 4000;
  for (const Hair& hair : growHairs(guides, growth)) EXPECT_EQ(hair.example_scale, 0);
  growth.curl_example = std::make_shared<const CurlExample>(curlOf(helix(0.2, 0.01, 8), "helix"));
  double sum[2] = {}, count[2] = {};
  for (const Hair& hair : growHairs(guides, growth)) {
    const float length = hair.guides[0] < 8 ? 0.1f : 0.3f;
    EXPECT_GT(hair.example_scale, 0.4f * length);
    EXPECT_LT(hair.example_scale, 1.3f * length);
    sum[hair.guides[0] < 8] += static_cast<double>(hair.example_scale);
    ++count[hair.guides[0] < 8];
  }
  EXPECT_NEAR(sum[0] / count[0] / (sum[1] / count[1]), 3, 0.6);
}

TEST(CurlExample, WhatIsNoExampleIsRefused) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("strandcast_curl_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  StrandSet strands;
  strands.append(helix(0.2, 0.01, 3, 60));
  strands.append(std::vector<Vec3>{Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(0, 2, 0), Vec3(0, 3, 0)});
  const auto file = folder / "two.hair";
  writeGroom(file, strands);
  EXPECT_NEAR(readCurlExample(file, 0).turns, 3, 0.5f);
  const auto refusal = [](auto&& make) -> std::string {
    try {
      make();
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto says = [&](const std::string& words, auto&& make) {
    const std::string said = refusal(make);
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  says("there is no strand 2", [&] { readCurlExample(file, 2); });
  says("name one from 0 to 1", [&] { readCurlExample(file, 2); });
  says("too short", [&] { readCurlExample(file, 1); });
  says("missing.obj", [&] { readCurlExample(folder / "missing.obj", 0); });
  std::vector<Vec3> broken = helix(0.2, 0.01, 3, 60);
  broken[7].y() = std::numeric_limits<float>::quiet_NaN();
  says("not finite", [&] { curlOf(broken, "broken"); });
  says("without length", [&] { curlOf(std::vector<Vec3>(9, Vec3(1, 2, 3)), "point"); });
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace strandcast
