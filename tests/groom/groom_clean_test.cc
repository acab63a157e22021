// Cleaning, orientation, resampling, guide selection and binding of strands made by hand; loading of files
// with units and axes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "core/strand_model.h"
#include "groom/groom.h"
#include "groom/groom_operations.h"
#include "io/axes_and_units.h"
#include "io/file_bytes.h"
#include "tests/expect_error.h"
#include "tests/io/sample_files.h"
#include "tests/io/scratch_folder.h"

namespace strandcast {
namespace {

std::vector<Vec3> straight(const Vec3& root, float length, int vertices) {
  std::vector<Vec3> points;
  for (int i = 0; i < vertices; ++i)
    points.push_back(root + Vec3(0, length * static_cast<float>(i) / static_cast<float>(vertices - 1), 0));
  return points;
}

std::vector<Vec3> helix(int vertices) {
  std::vector<Vec3> points;
  for (int i = 0; i < vertices; ++i) {
    const float angle = 0.35f * static_cast<float>(i);
    points.push_back({0.01f * std::cos(angle), 0.002f * static_cast<float>(i), 0.01f * std::sin(angle)});
  }
  return points;
}

SurfacePoint onFloor(const Vec3& point) {
  return {Vec3(point.x(), 0, point.z()), 0, Vec3(1, 0, 0), std::abs(point.y())};
}

TEST(CleanStrands, CountsAndRemovesWhatIsNoHair) {
  Groom groom;
  for (int s = 0; s < 5; ++s)
    groom.strands.append(straight(Vec3(0.01f * static_cast<float>(s), 0, 0), 0.2f, 5));
  groom.strands.append(std::vector<Vec3>(4, Vec3(1, 0, 0)));  // 5: a point
  groom.strands.append(straight(Vec3(1, 0, 0), 0.0019f, 4));  // 6: below 1 %
  groom.strands.append(straight(Vec3(1, 0, 0), 0.0021f, 4));  // 7: above 1 %
  groom.strands.append(std::vector<Vec3>{Vec3(2, 0, 0)});     // 8: one vertex
  std::vector<Vec3> doubled = straight(Vec3(3, 0, 0), 0.2f, 5);
  doubled.insert(doubled.begin() + 2, doubled[2]);
  doubled.insert(doubled.begin(), doubled[0]);
  doubled.push_back(doubled.back() + Vec3(1e-8f, 0, 0));
  groom.strands.append(doubled);  // 9: three duplicates
  groom.strands.uvs.resize(10);
  for (int s = 0; s < 10; ++s) groom.strands.uvs[s] = Vec2(static_cast<float>(s), 0);
  cleanStrands(groom);
  EXPECT_EQ(groom.report.strands_read, 10u);
  EXPECT_EQ(groom.report.dropped_short, 3u);
  EXPECT_EQ(groom.report.duplicate_vertices, 3u);
  EXPECT_EQ(groom.report.resampled, 0u);
  ASSERT_EQ(groom.strands.strands(), 7u);
  EXPECT_EQ(groom.strands.verticesOf(6), 5u);
  EXPECT_EQ(groom.strands.strand(6).back(), doubled.back());
  EXPECT_EQ(groom.strands.uvs[5].x(), 7);
  EXPECT_EQ(groom.strands.uvs[6].x(), 9);
  EXPECT_NO_THROW(makeStrandModel(groom.strands));
}

TEST(CleanStrands, AMergedVertexLeavesItsPinToTheOneThatStays) {
  Groom groom;
  std::vector<Vec3> points = straight(Vec3::Zero(), 0.2f, 4);
  points.push_back(points.back());
  groom.strands.append(points);
  groom.strands.pinned = {1, 0, 0, 1, 0};
  cleanStrands(groom);
  EXPECT_EQ(groom.strands.pinned, (std::vector<uint8_t>{1, 0, 0, 1}));
  EXPECT_EQ(groom.report.both_ends_pinned, 1u);
}

TEST(CleanStrands, NoEdgeIsLeftShorterThanATenthOfItsStrandsMean) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(0, 1);
  Groom groom;
  for (int s = 0; s < 200; ++s) {
    std::vector<Vec3> points = straight(Vec3(0.01f * static_cast<float>(s), 0, 0), 0.2f, 4 + s % 40);
    for (Vec3& point : points) point += std::pow(any(random), 4.0f) * Vec3(0.02f, 0.2f, 0);
    points.push_back(points.back() - Vec3(0, std::pow(any(random), 8.0f) * 0.05f, 0));
    groom.strands.append(points);
  }
  const StrandSet before = groom.strands;
  cleanStrands(groom);
  EXPECT_GT(groom.report.duplicate_vertices, 200u);
  ASSERT_EQ(groom.strands.strands(), before.strands());
  for (size_t s = 0; s < before.strands(); ++s) {
    const std::span<const Vec3> points = groom.strands.strand(s);
    EXPECT_EQ(points.front(), before.strand(s).front());
    EXPECT_EQ(points.back(), before.strand(s).back());
    const float mean = arcLength(points) / static_cast<float>(points.size() - 1);
    for (size_t i = 1; i < points.size(); ++i) EXPECT_GT((points[i] - points[i - 1]).norm(), 0.1f * mean);
  }
}

TEST(CleanStrands, EdgesOfAQuarterOfTheMeanStay) {
  Groom groom;
  std::vector<Vec3> points = straight(Vec3::Zero(), 0.2f, 9);
  points.insert(points.begin() + 4, 0.75f * points[4] + 0.25f * points[3]);
  groom.strands.append(points);
  cleanStrands(groom);
  EXPECT_EQ(groom.report.duplicate_vertices, 0u);
  EXPECT_EQ(groom.strands.verticesOf(0), 10u);
}

TEST(CleanStrands, StrandsOfMoreThan128VerticesAreEvenedDownAndCounted) {
  Groom groom;
  groom.strands.append(helix(128));
  groom.strands.append(helix(300));
  cleanStrands(groom);
  EXPECT_EQ(groom.strands.verticesOf(0), 128u);
  EXPECT_EQ(groom.strands.verticesOf(1), 128u);
  EXPECT_EQ(groom.report.resampled, 1u);
  EXPECT_EQ(groom.strands.strand(0)[64], helix(128)[64]);
  EXPECT_EQ(groom.strands.strand(1).back(), helix(300).back());
}

TEST(OrientRoots, OnlyStrandsWhoseTipIsClearlyNearerAreTurnedRound) {
  Groom groom;
  groom.strands.append(straight(Vec3(0, 0.01f, 0), 0.2f, 3));
  std::vector<Vec3> upside_down = straight(Vec3(1, 0.01f, 0), 0.2f, 3);
  std::reverse(upside_down.begin(), upside_down.end());
  groom.strands.append(upside_down);
  groom.strands.append(upside_down);
  groom.strands.append(
      {{Vec3(0, 0.02f, 0), Vec3(0.1f, 0.1f, 0), Vec3(0.2f, 0.01f, 0)}});  // nearer, but within the threshold
  groom.strands.pinned = {1, 0, 0, 1, 0, 0, 1, 0, 1, 1, 0, 0};
  groom.strands.radii = {1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3};
  orientRoots(groom, onFloor);
  EXPECT_EQ(groom.report.reversed, 2u);
  EXPECT_FLOAT_EQ(groom.strands.strand(1)[0].y(), 0.01f);
  EXPECT_EQ(groom.strands.strand(3)[0], Vec3(0, 0.02f, 0));
  EXPECT_EQ(groom.strands.pinned, (std::vector<uint8_t>{1, 0, 0, 1, 0, 0, 1, 0, 1, 1, 0, 0}));
  EXPECT_EQ(groom.strands.radii, (std::vector<float>{1, 2, 3, 3, 2, 1, 3, 2, 1, 1, 2, 3}));
}

TEST(Resample, KeepsRootTipAndLengthAndSpacesEvenly) {
  StrandSet strands;
  strands.append(helix(100));
  const float length = arcLength(strands.strand(0));
  for (const int vertices : {2, 3, 16, 50, 100, 128}) {
    const StrandSet even = resample(strands, vertices);
    ASSERT_EQ(even.vertices(), static_cast<size_t>(vertices));
    EXPECT_EQ(even.positions.front(), strands.positions.front());
    EXPECT_EQ(even.positions.back(), strands.positions.back());
    const float kept = arcLength(even.strand(0));
    EXPECT_LE(kept, length * 1.00001f);
    if (vertices == 100) {
      EXPECT_NEAR(kept, length, 1e-5f * length);  // its edges are equal already
    }
    // Samples closer than the edges cut each corner once. A chord across a corner of angle a keeps cos(a / 2)
    // of the length of its arms, and a helix with 0.35 radians per step bends by less than that.
    if (vertices == 128) {
      EXPECT_GE(kept, std::cos(0.35f / 2) * length);
    }
  }
}

TEST(Resample, EdgesAreOfOneLengthHoweverAStrandIsBent) {
  StrandSet strands;
  strands.append(helix(100));
  strands.append(  // kinks
      {{Vec3(0, 1.7f, 0), Vec3(0.1f, 1.7f, 0), Vec3(0.15f, 1.8f, 0), Vec3(0.3f, 1.72f, 0.01f)}});
  for (const int vertices : {3, 4, 16, 100, 128}) {
    const StrandSet even = resample(strands, vertices);
    for (size_t s = 0; s < strands.strands(); ++s) {
      const std::span<const Vec3> points = even.strand(s);
      const float mean = arcLength(points) / static_cast<float>(vertices - 1);
      for (size_t i = 1; i < points.size(); ++i)
        EXPECT_NEAR((points[i] - points[i - 1]).norm(), mean, 3e-7f) << vertices << " of " << s << ", " << i;
    }
  }
}

TEST(Resample, WhereNoEdgesOfOneLengthEndAtTheTipPlacesAreEven) {
  StrandSet strands;
  strands.append({{Vec3(0, 0, 0), Vec3(0, 0.2f, 0), Vec3(0, 0.1f, 0)}});  // out and back
  const StrandSet even = resample(strands, 5);
  const float places[] = {0, 0.075f, 0.15f, 0.175f, 0.1f};
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(even.positions[i].y(), places[i], 1e-7f);
}

TEST(Resample, IsExactOnAStraightStrandOfUnevenEdges) {
  StrandSet strands;
  strands.append(
      {{Vec3(0, 0, 0), Vec3(0, 0.01f, 0), Vec3(0, 0.15f, 0), Vec3(0, 0.16f, 0), Vec3(0, 0.3f, 0)}});
  const StrandSet even = resample(strands, 7);
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(even.positions[i].y(), 0.05f * static_cast<float>(i), 1e-7f);
}

TEST(Resample, CarriesPinsRadiiAndAllValuesPerStrand) {
  StrandSet strands;
  strands.append(straight(Vec3::Zero(), 0.3f, 11));
  strands.append(straight(Vec3::Ones(), 0.3f, 3));
  strands.pinned = {1, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 0, 0};
  for (int i = 0; i < 14; ++i) strands.radii.push_back(i < 11 ? 0.1f * static_cast<float>(i) : 2.0f);
  strands.uvs = {Vec2(0, 1), Vec2(2, 3)};
  strands.parts = {7, 8};
  strands.ids = {70, 80};
  strands.is_guide = {0, 1};
  strands.groups = {1, 0};
  strands.colours = {Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const StrandSet even = resample(strands, 6);
  EXPECT_EQ(even.pinned, (std::vector<uint8_t>{1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0}));
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(even.radii[i], 0.2f * static_cast<float>(i), 1e-5f);
  EXPECT_EQ(even.uvs, strands.uvs);
  EXPECT_EQ(even.parts, strands.parts);
  EXPECT_EQ(even.ids, strands.ids);
  EXPECT_EQ(even.is_guide, strands.is_guide);
  EXPECT_EQ(even.groups, strands.groups);
  EXPECT_EQ(even.colours, strands.colours);
}

TEST(Resample, CountsOutOfRangeAreRefused) {
  StrandSet strands;
  strands.append(straight(Vec3::Zero(), 0.3f, 4));
  for (const int count : {-1, 0, 1, 129}) {
    expectError([&] { resample(strands, count); }, {std::to_string(count)});
    expectError([&] { equalize(strands, count); }, {std::to_string(count)});
  }
}

TEST(Equalize, CapsCountsAndEvensSpacing) {
  StrandSet strands;
  strands.append(straight(Vec3::Zero(), 0.3f, 40));
  strands.append({{Vec3(0, 0, 0), Vec3(0, 0.01f, 0), Vec3(0, 0.3f, 0)}});
  const StrandSet even = equalize(strands, 16);
  EXPECT_EQ(even.verticesOf(0), 16u);
  ASSERT_EQ(even.verticesOf(1), 3u);
  EXPECT_NEAR(even.strand(1)[1].y(), 0.15f, 1e-7f);
}

StrandSet randomRoots(size_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> anywhere(-1, 1);
  StrandSet strands;
  while (strands.strands() < count) {
    const Vec3 point(anywhere(random), anywhere(random), anywhere(random));
    if (point.norm() < 0.1f || point.norm() > 1) continue;
    const Vec3 root = 0.1f * point.normalized();
    strands.append({{root, root * 2}});
  }
  return strands;
}

/// Reference implementation, without a grid.
std::vector<uint32_t> farthestPointsPlainly(const StrandSet& strands, uint32_t first, size_t count) {
  std::vector<float> distance(strands.strands(), 1e30f);
  std::vector<uint32_t> chosen{first};
  while (chosen.size() < count) {
    for (size_t s = 0; s < distance.size(); ++s)
      distance[s] = std::min(distance[s], (strands.strand(s)[0] - strands.strand(chosen.back())[0]).norm());
    chosen.push_back(
        static_cast<uint32_t>(std::max_element(distance.begin(), distance.end()) - distance.begin()));
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

TEST(ChooseGuides, IsFarthestPointSampling) {
  const StrandSet strands = randomRoots(3000);
  const uint32_t first = chooseGuides(strands, 1)[0];
  for (const size_t count : {1, 2, 17, 300, 2999})
    EXPECT_EQ(chooseGuides(strands, count), farthestPointsPlainly(strands, first, count)) << count;
}

TEST(ChooseGuides, CopesWithRootsInOnePlaceOnALineAndWithOddCounts) {
  StrandSet strands;
  for (int s = 0; s < 100; ++s)
    strands.append(straight(Vec3(s < 50 ? 0.0f : 0.001f * static_cast<float>(s), 0, 0), 0.1f, 2));
  for (const size_t count : {1, 10, 60, 99, 100, 1000}) {
    const std::vector<uint32_t> chosen = chooseGuides(strands, count);
    EXPECT_EQ(chosen.size(), std::min<size_t>(count, 100));
    EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
    EXPECT_EQ(std::adjacent_find(chosen.begin(), chosen.end()), chosen.end());
  }
  EXPECT_TRUE(chooseGuides(strands, 0).empty());
  EXPECT_TRUE(chooseGuides(StrandSet(), 5).empty());
}

TEST(Subset, CarriesEverythingInTheOrderAsked) {
  StrandSet strands;
  for (int s = 0; s < 3; ++s) strands.append(straight(Vec3(static_cast<float>(s), 0, 0), 0.1f, 2 + s));
  strands.pinned = {1, 0, 1, 1, 0, 1, 0, 0, 1};
  strands.radii = {0, 1, 2, 3, 4, 5, 6, 7, 8};
  strands.uvs = {Vec2(0, 0), Vec2(1, 0), Vec2(2, 0)};
  strands.parts = {4, 5, 6};
  strands.ids = {40, 50, 60};
  strands.is_guide = {1, 0, 0};
  strands.groups = {2, 1, 0};
  strands.colours = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  const StrandSet chosen = subset(strands, {2, 0});
  EXPECT_EQ(chosen.offsets, (std::vector<uint32_t>{0, 4, 6}));
  EXPECT_EQ(chosen.pinned, (std::vector<uint8_t>{1, 0, 0, 1, 1, 0}));
  EXPECT_EQ(chosen.radii, (std::vector<float>{5, 6, 7, 8, 0, 1}));
  EXPECT_EQ(chosen.uvs[0], Vec2(2, 0));
  EXPECT_EQ(chosen.parts, (std::vector<uint16_t>{6, 4}));
  EXPECT_EQ(chosen.ids, (std::vector<uint32_t>{60, 40}));
  EXPECT_EQ(chosen.is_guide, (std::vector<uint8_t>{0, 1}));
  EXPECT_EQ(chosen.groups, (std::vector<uint32_t>{0, 2}));
  EXPECT_EQ(chosen.colours, (std::vector<Vec3>{Vec3(0, 0, 1), Vec3(1, 0, 0)}));
  expectError([&] { subset(strands, {3}); }, {"strand 3"});
}

TEST(BindRoots, MeasuresHowFarRootsAreOffAPlane) {
  StrandSet strands;
  for (const float height : {0.0f, 0.002f, 0.016f})
    strands.append(straight(Vec3(height, height, 1), 0.1f, 4));
  const RootBinding binding = bindRoots(strands, onFloor);
  ASSERT_EQ(binding.roots.size(), 3u);
  EXPECT_EQ(binding.roots[2].position, Vec3(0.016f, 0, 1));
  EXPECT_FLOAT_EQ(binding.mean_distance, 0.006f);
  EXPECT_FLOAT_EQ(binding.max_distance, 0.016f);
  EXPECT_TRUE(bindRoots(StrandSet(), onFloor).roots.empty());
}

TEST(Summarize, CountsLengthsAndBounds) {
  StrandSet strands;
  for (const float length : {0.1f, 0.2f, 0.4f}) strands.append(straight(Vec3::Zero(), length, 3));
  strands.append(straight(Vec3::Zero(), 0.001f, 5));
  const GroomSummary summary = summarize(strands);
  EXPECT_EQ(summary.strands, 4u);
  EXPECT_EQ(summary.vertices, 14u);
  EXPECT_EQ(summary.min_vertices, 3u);
  EXPECT_EQ(summary.max_vertices, 5u);
  EXPECT_EQ(summary.degenerate_strands, 1u);
  EXPECT_FLOAT_EQ(summary.min_length, 0.001f);
  EXPECT_FLOAT_EQ(summary.median_length, 0.2f);
  EXPECT_FLOAT_EQ(summary.max_length, 0.4f);
  EXPECT_FLOAT_EQ(summary.bounds.max().y(), 0.4f);
  EXPECT_EQ(summarize(StrandSet()).strands, 0u);
}

TEST(GuessUnit, MakesAHeadOfHairHeadSized) {
  const auto box = [](float size) {
    return Box(Eigen::Vector3f::Zero(), Eigen::Vector3f(size / 2, size, size / 3));
  };
  EXPECT_EQ(guessUnit(box(0.28f)), 1.0f);
  EXPECT_EQ(guessUnit(box(3)), 0.1f);
  EXPECT_EQ(guessUnit(box(25)), 0.01f);
  EXPECT_EQ(guessUnit(box(127)), 0.0025f);
  EXPECT_EQ(guessUnit(box(300)), 0.001f);
  EXPECT_EQ(guessUnit(Box()), 1.0f);
  EXPECT_EQ(guessUnit(box(0)), 1.0f);
}

TEST(GuessUnit, InchesAndFeetAreNamedWhereTheyMakeAHeadOfHair) {
  EXPECT_EQ(likelierUnits(12, 0.01f), "0.0254 m (inches) would make it 0.3 m large");
  EXPECT_EQ(likelierUnits(0.9f, 1), "0.3048 m (feet) would make it 0.27 m large");
  EXPECT_EQ(likelierUnits(12, 1000),
            "0.0254 m (inches) would make it 0.3 m large, 0.01 m (centimetres) would make it 0.12 m large");
  EXPECT_EQ(likelierUnits(1, 100),
            "0.3048 m (feet) would make it 0.3 m large, 0.1 m would make it 0.1 m large, "
            "1 m would make it 1 m large");
  EXPECT_EQ(likelierUnits(30, 0.01f), "");
  EXPECT_EQ(likelierUnits(0.3f, 1), "");
  for (const float none : {0.0f, 1e9f, 1e-9f}) EXPECT_EQ(likelierUnits(none, 1), "") << none;
}

TEST(LoadGroom, AnUnlikelyUnitIsReportedWithLikelierOnes) {
  const ScratchFolder folder;
  const auto warningsOf = [&](float size, float unit) {
    std::ofstream(folder / "wig.obj") << "v 0 0 0\nv 0 " << size / 2 << " 0\nv 0 " << size << " 0\nl 1 2 3\n";
    return loadGroom({folder / "wig.obj"}, {unit, UpAxis::kAuto}).report.warnings;
  };
  const std::string name = (folder / "wig.obj").string();
  EXPECT_EQ(
      warningsOf(25, 1),
      std::vector<std::string>{
          name + ": with a unit of 1 m the groom is 25 m large: give its unit (--unit-meters): 0.01 m "
                 "(centimetres) would make it 0.25 m large, 0.0254 m (inches) would make it 0.63 m large"});
  EXPECT_EQ(warningsOf(0.8f, 1e-3f),
            std::vector<std::string>{
                name + ": with a unit of 0.001 m the groom is 0.0008 m large: give its unit (--unit-meters): "
                       "0.3048 m (feet) would make it 0.24 m large, 1 m would make it 0.8 m large"});
  EXPECT_EQ(
      warningsOf(12, 0),
      std::vector<std::string>{
          name + ": the unit is guessed: 0.01 m, which makes the groom 0.12 m large (12 units; 0.0254 m "
                 "(inches) would make it 0.3 m large); give --unit-meters to be sure"});
  EXPECT_TRUE(warningsOf(25, 0.01f).empty());
}

TEST(LoadGroom, WarnsOfAFileThatIsGivenMoreThanOnce) {
  const ScratchFolder folder;
  for (const char* const name : {"a.hair", "b.hair"}) writeFileBytes(folder / name, samples::hair());
  std::filesystem::create_symlink("a.hair", folder / "link.hair");
  const auto warned = [&](const std::vector<std::filesystem::path>& files) {
    size_t lines = 0;
    for (const std::string& line : loadGroom(files, {1, UpAxis::kZ}).report.warnings)
      lines += line.find("given more than once") != std::string::npos;
    return lines;
  };
  const auto a = folder / "a.hair", b = folder / "b.hair";
  EXPECT_EQ(warned({a, b}), 0u) << "alike, but two files";
  EXPECT_EQ(warned({a, a}), 1u);
  EXPECT_EQ(warned({a, b, folder.path() / "." / "a.hair"}), 1u);
  EXPECT_EQ(warned({a, folder / "link.hair", b, b}), 2u);
}

TEST(LoadGroom, ConvertsUnitAndAxesAndSaysWhenItGuessed) {
  const ScratchFolder folder;
  writeFileBytes(folder / "a.hair", samples::hair());
  const Vec3 in_file = samples::vertex(2, 4);
  const Groom given = loadGroom({folder / "a.hair"}, {0.5f, UpAxis::kAuto});
  EXPECT_TRUE(given.report.warnings.empty());
  EXPECT_EQ(given.report.unit_meters, 0.5f);
  EXPECT_LT((given.strands.strand(2)[4] - 0.5f * Vec3(in_file.x(), in_file.z(), -in_file.y())).norm(), 1e-6f);
  EXPECT_FLOAT_EQ(given.strands.radii.back(), 0.045f);

  const Groom guessed = loadGroom({folder / "a.hair"}, {0, UpAxis::kX});
  ASSERT_EQ(guessed.report.warnings.size(), 1u);
  EXPECT_NE(guessed.report.warnings[0].find("a.hair"), std::string::npos);
  EXPECT_EQ(guessed.report.unit_meters, 1.0f);
  EXPECT_LT((guessed.strands.strand(2)[4] - Vec3(-in_file.y(), in_file.x(), in_file.z())).norm(), 1e-6f);
  EXPECT_EQ(loadGroom({folder / "a.hair"}, {1, UpAxis::kY}).strands.strand(2)[4], in_file);
}

bool isReported(const Groom& groom, const std::string& what) {
  const std::vector<std::string>& lines = groom.report.warnings;
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(what) != std::string::npos; });
}

TEST(LoadGroom, AUnitOrAxisGivenAgainstTheFileWinsAndIsReported) {
  const ScratchFolder folder;
  writeFileBytes(folder / "a.usda", samples::usda());
  const Groom said = loadGroom({folder / "a.usda"}, {});
  EXPECT_FLOAT_EQ(said.report.unit_meters, 0.01f);
  EXPECT_FALSE(isReported(said, "as given"));
  EXPECT_FALSE(isReported(loadGroom({folder / "a.usda"}, {0.01f, UpAxis::kZ}), "as given"));
  const Groom given = loadGroom({folder / "a.usda"}, {0.02f, UpAxis::kY});
  EXPECT_FLOAT_EQ(given.report.unit_meters, 0.02f);
  EXPECT_TRUE(
      isReported(given, "the file says that its unit is 0.01 m, 0.02 m is taken as given (--unit-meters)"));
  EXPECT_TRUE(isReported(given, "Z is up in the file, Y is taken as given (--up)"));
}

TEST(LoadGroom, SizesAndPlacesThatNoHairHasAreReportedAsUnits) {
  const ScratchFolder folder;
  writeFileBytes(folder / "a.hair", samples::hair());
  for (const auto& [unit, told] : {std::pair{1e-5f, "m large: give its unit (--unit-meters)"},
                                   {1e-3f, "m large"},
                                   {0.1f, nullptr},
                                   {1.0f, nullptr},
                                   {1000.0f, "m large"}}) {
    const Groom groom = loadGroom({folder / "a.hair"}, {unit, UpAxis::kAuto});
    EXPECT_EQ(groom.report.warnings.size(), told == nullptr ? 0u : 1u) << unit;
    EXPECT_TRUE(told == nullptr || isReported(groom, told)) << unit;
  }
  writeFileBytes(folder / "far.obj",
                 samples::fromText("v 5000 0 0\nv 5000 0.01 0\nv 5000 0.02 0\nl 1 2 3\n"));
  EXPECT_TRUE(isReported(loadGroom({folder / "far.obj"}, {1, UpAxis::kY}), "positions are rounded"));
}

TEST(LoadGroom, SeveralFilesBecomeOneGroomWithParts) {
  const ScratchFolder folder;
  writeFileBytes(folder / "a.tfx", samples::tfx3());
  writeFileBytes(folder / "b.obj", samples::objStrands());
  writeFileBytes(folder / "c.tfx", samples::tfx4());
  const Groom groom = loadGroom({folder / "a.tfx", folder / "b.obj", folder / "c.tfx"}, {1, UpAxis::kAuto});
  EXPECT_EQ(groom.name, "a+b+c");
  EXPECT_EQ(groom.strands.parts, (std::vector<uint16_t>{0, 0, 0, 1, 1, 1, 2, 2, 2}));
  EXPECT_EQ(groom.report.strands_read, 9u);
  EXPECT_TRUE(groom.strands.uvs.empty());
  EXPECT_EQ(groom.report.warnings.size(), 1u);
  for (size_t s = 0; s < groom.strands.strands(); ++s) {
    EXPECT_TRUE(groom.strands.pinned[groom.strands.offsets[s]]);
    EXPECT_FALSE(groom.strands.isPinned(s, 1)) << "the root's frame is clamped instead";
  }
}

TEST(LoadGroom, LabelsOfSeveralFilesStayWithTheirStrands) {
  const ScratchFolder folder;
  StrandSet strands;
  for (int s = 0; s < 3; ++s)
    strands.append(straight(Vec3(0.1f * static_cast<float>(s), 0, 0), s == 1 ? 0.0f : 0.1f, 200));
  strands.ids = {1, 2, 3};
  strands.is_guide = {1, 0, 0};
  strands.groups = {0, 1, 1};
  strands.colours.assign(3, Vec3(0.5f, 0.25f, 0));
  writeGroom(folder / "a.usda", strands, UpAxis::kY, 1, std::vector<StrandGroup>{{5, "fringe"}, {6, ""}});
  const Groom one = loadGroom({folder / "a.usda"}, {});
  EXPECT_EQ(one.report.dropped_short, 1u);
  EXPECT_EQ(one.report.resampled, 2u);
  EXPECT_EQ(one.strands.ids, (std::vector<uint32_t>{1, 3}));
  EXPECT_EQ(one.strands.is_guide, (std::vector<uint8_t>{1, 0}));
  EXPECT_EQ(one.strands.groups, (std::vector<uint32_t>{0, 1}));
  const GroomSummary summary = summarize(one.strands);
  EXPECT_EQ(summary.guides, 1u);
  EXPECT_EQ(summary.ids, 2u);
  EXPECT_EQ(summary.groups, 2u);
  EXPECT_EQ(summary.colours, 1u);

  strands.is_guide.clear();
  strands.groups.clear();
  strands.ids.clear();
  writeGroom(folder / "b.usda", strands);
  const Groom both = loadGroom({folder / "b.usda", folder / "a.usda", folder / "a.usda"}, {});
  EXPECT_EQ(both.strands.is_guide, (std::vector<uint8_t>{0, 0, 1, 0, 1, 0}));
  EXPECT_EQ(both.strands.groups, (std::vector<uint32_t>{0, 0, 1, 2, 3, 4})) << "equal ids, other groups";
  ASSERT_EQ(both.groups.size(), 5u);
  EXPECT_EQ(both.groups[3].id, 5);
  EXPECT_EQ(both.groups[3].name, "fringe");
  EXPECT_EQ(both.strands.colours.size(), 6u);
  EXPECT_TRUE(both.strands.ids.empty());
  EXPECT_TRUE(isReported(both, "some of the files have no ids"));
}

TEST(LoadGroom, PinnedTipsStayPinned) {
  const ScratchFolder folder;
  samples::Bytes bytes = samples::tfx3(true);
  samples::overwrite(bytes, 4, uint32_t{2});
  samples::overwrite(bytes, 8, uint32_t{6});
  writeFileBytes(folder / "a.tfx", bytes);
  const Groom groom = loadGroom({folder / "a.tfx"}, {1, UpAxis::kAuto});
  EXPECT_EQ(groom.report.both_ends_pinned, 2u);
  EXPECT_EQ(std::vector<uint8_t>(groom.strands.pinned.begin(), groom.strands.pinned.begin() + 6),
            (std::vector<uint8_t>{1, 0, 0, 0, 1, 1}));
}

TEST(LoadGroom, BadOptionsAndGroomsWithoutHairAreRefused) {
  const ScratchFolder folder;
  writeFileBytes(folder / "a.tfx", samples::tfx3());
  expectError([&] { loadGroom({}, {}); }, {"no groom file"});
  for (const float unit : {-1.0f, std::nanf(""), HUGE_VALF})
    expectError([&] { loadGroom({folder / "a.tfx"}, {unit, UpAxis::kAuto}); }, {"unit_meters"});
  expectError([&] { loadGroom({folder / "a.tfx"}, {1e30f, UpAxis::kAuto}); }, {"a.tfx", "vertex 0", "10 km"});
  writeFileBytes(folder / "b.obj", samples::fromText("v 1 2 3\nv 1 2 3\nl 1 2\n"));
  expectError([&] { loadGroom({folder / "b.obj"}, {}); }, {"b.obj", "no strand"});
}

}  // namespace
}  // namespace strandcast
