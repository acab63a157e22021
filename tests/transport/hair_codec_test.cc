#include "transport/codec/hair_codec.h"

#include <gtest/gtest.h>

#include <limits>

#include "bound_hairs.h"
#include "core/error.h"
#include "payload_fuzz.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

StrandSet guidesOf(size_t strands) {
  return hairGroom(strands, [](size_t s) { return 2 + s % 20; }).guides;
}

/// The decoded hairs of all chunks.
HairDescription decoded(const std::vector<HairChunk>& chunks, const StrandSet& guides) {
  HairDescription hairs;
  for (const HairChunk& chunk : chunks) EXPECT_TRUE(decodeHairs(chunk, guides, hairs)) << chunk.chunk_index;
  return hairs;
}

double worstError(const StrandSet& a, const StrandSet& b) {
  EXPECT_EQ(a.offsets, b.offsets);
  double worst = 0;
  for (size_t v = 0; v < a.vertices(); ++v)
    worst = std::max(worst, (a.positions[v].cast<double>() - b.positions[v].cast<double>()).norm());
  return worst;
}

void expectSameBindings(const HairDescription& a, const HairDescription& b) {
  ASSERT_EQ(a.bindings.size(), b.bindings.size());
  for (size_t h = 0; h < a.bindings.size(); ++h) {
    EXPECT_EQ(a.bindings[h].guides, b.bindings[h].guides);
    EXPECT_EQ(a.bindings[h].weights, b.bindings[h].weights);
  }
}

TEST(HairCodec, KeepsTheErrorOfEveryVertexAndEverythingElse) {
  const StrandSet guides = guidesOf(300);
  for (const float error : {kMinHairError, kDefaultHairError, kMaxHairError}) {
    for (const bool with_arrays : {true, false}) {
      const HairDescription hairs = boundHairs(
          guides, 3000, [](size_t h) { return 2 + h % 40; }, with_arrays);
      ASSERT_NO_THROW(checkHairs(hairs, guides, "test"));
      const std::vector<HairChunk> chunks = encodeHairs(hairs, guides, error);
      const HairDescription got = decoded(chunks, guides);
      EXPECT_LE(worstError(hairs.hairs, got.hairs), error);
      EXPECT_GT(worstError(hairs.hairs, got.hairs), 0.5f * error);
      expectSameBindings(hairs, got);
      EXPECT_EQ(got.hairs.parts, hairs.hairs.parts);
      EXPECT_EQ(got.colours, hairs.colours);
      EXPECT_EQ(got.ids, hairs.ids);
      ASSERT_EQ(got.hairs.radii.size(), hairs.hairs.radii.size());
      for (size_t v = 0; v < got.hairs.radii.size(); ++v)
        EXPECT_NEAR(got.hairs.radii[v], hairs.hairs.radii[v], 10.1e-9f);
      ASSERT_EQ(got.hairs.uvs.size(), hairs.hairs.uvs.size());
      for (size_t h = 0; h < got.hairs.uvs.size(); ++h)
        EXPECT_LT((got.hairs.uvs[h] - hairs.hairs.uvs[h]).cwiseAbs().maxCoeff(), 6.0f / 130000);
      EXPECT_NO_THROW(checkHairs(got, guides, "test"));
    }
  }
}

TEST(HairCodec, ChunksAreFullConsecutiveAndDecodeAlone) {
  const StrandSet guides = guidesOf(300);
  const HairDescription hairs = boundHairs(
      guides, 6000, [](size_t h) { return 2 + h % 30; }, true);
  const std::vector<HairChunk> chunks = encodeHairs(hairs, guides, kDefaultHairError);
  ASSERT_GT(chunks.size(), 3u);
  uint32_t hair = 0, vertex = 0;
  for (const HairChunk& chunk : chunks) {
    EXPECT_EQ(chunk.chunk_count, chunks.size());
    EXPECT_EQ(chunk.chunk_index, static_cast<uint32_t>(&chunk - chunks.data()));
    EXPECT_EQ(chunk.session, 11u);
    EXPECT_EQ(chunk.groom_id, 1u);
    EXPECT_EQ(chunk.revision, 1u);
    EXPECT_EQ(chunk.total_hairs, 6000u);
    EXPECT_EQ(chunk.total_vertices, hairs.hairs.vertices());
    EXPECT_EQ(chunk.first_hair, hair);
    EXPECT_EQ(chunk.first_vertex, vertex);
    EXPECT_LE(chunk.payload.size(), kMaxChunkBytes);
    EXPECT_TRUE(chunk.payload.size() > kMaxChunkBytes - 400 || &chunk == &chunks.back()) << chunk.chunk_index;
    hair += chunk.hair_count;
    vertex += chunk.vertex_count;
    HairDescription alone;
    ASSERT_TRUE(decodeHairs(chunk, guides, alone));
    EXPECT_EQ(alone.hairs.strands(), chunk.hair_count);
    EXPECT_EQ(alone.ids.front(), hairs.ids[chunk.first_hair]);
  }
  EXPECT_EQ(hair, 6000u);
  EXPECT_EQ(vertex, hairs.hairs.vertices());
}

TEST(HairCodec, LongestAndShortestHairsAndManyGuides) {
  const StrandSet guides = hairGroom(70'000, [](size_t s) { return 1 + s % 3; }).guides;
  HairDescription hairs = boundHairs(
      guides, 40, [](size_t h) { return h % 2 == 0 ? 2u : 3500u; }, true);
  hairs.bindings[7].guides = {69'999, 0, 69'998};
  hairs.bindings[8].guides = {0, 69'999, 32'768};
  hairs.ids[3] = 0xffffffff;
  hairs.ids[4] = 0;
  hairs.hairs.radii[5] = kThickestHair;
  const HairDescription got = decoded(encodeHairs(hairs, guides, 1e-4f), guides);
  EXPECT_LE(worstError(hairs.hairs, got.hairs), 1e-4);
  expectSameBindings(hairs, got);
  EXPECT_EQ(got.ids, hairs.ids);
  EXPECT_NEAR(got.hairs.radii[5], kThickestHair, 1e-6f);
  EXPECT_NO_THROW(checkHairs(got, guides, "test"));
}

TEST(HairCodec, GuidesWithoutEdgesOrDirectionPredictNothing) {
  StrandSet guides;
  guides.append(std::vector<Vec3>{Vec3(0, 0, 0)});
  guides.append(std::vector<Vec3>(5, Vec3(0.01f, 0, 0)));
  guides.append(std::vector<Vec3>{Vec3(0, 0, 0), Vec3(0, -0.1f, 0), Vec3(0, 0, 0)});  // folds back
  HairDescription hairs;
  for (uint32_t g = 0; g < 3; ++g) {
    hairs.hairs.append(
        std::vector<Vec3>{Vec3(0, 0, 0), Vec3(0, -0.1f, 0), Vec3(0, -0.1f, 0), Vec3(0, 0.2f, 0)});
    hairs.bindings.push_back({{g, g, g}, {0, 0}});
  }
  EXPECT_LE(worstError(hairs.hairs, decoded(encodeHairs(hairs, guides, 3e-5f), guides).hairs), 3e-5);
}

TEST(HairCodec, KeepsTheErrorFarFromTheOrigin) {
  StrandSet guides = guidesOf(20);
  HairDescription hairs = boundHairs(
      guides, 200, [](size_t h) { return 2 + h % 9; }, false);
  for (Vec3& p : guides.positions) p.x() += 90;
  for (Vec3& p : hairs.hairs.positions) p.x() += 90;
  EXPECT_LE(worstError(hairs.hairs, decoded(encodeHairs(hairs, guides, 3e-5f), guides).hairs), 3e-5);
  hairs.source = "wig.usda (--hair-files)";
  expectError([&] { encodeHairs(hairs, guides, 1e-5f); },
              {"too far from the origin", "wig.usda (--hair-files)", "--hair-error"});
}

TEST(HairCodec, AllInstructionSetsWriteAndReadTheSame) {
  const StrandSet guides = guidesOf(50);
  const HairDescription hairs = boundHairs(
      guides, 700, [](size_t h) { return 2 + h % 30; }, true);
  const std::vector<HairChunk> expected = encodeHairs(hairs, guides, kDefaultHairError);
  const HairDescription expected_hairs = decoded(expected, guides);
  for (const StrandCoder& coder : runnableStrandCoders()) {
    const std::vector<HairChunk> chunks = encodeHairs(hairs, guides, kDefaultHairError, coder);
    ASSERT_EQ(chunks.size(), expected.size());
    HairDescription got;
    for (size_t i = 0; i < chunks.size(); ++i) {
      EXPECT_EQ(chunks[i].payload, expected[i].payload) << coder.name;
      EXPECT_TRUE(decodeHairs(chunks[i], guides, got, coder));
    }
    EXPECT_EQ(got.hairs.positions, expected_hairs.hairs.positions) << coder.name;
  }
}

TEST(HairCodec, BytesOfAHairThatRunsAsItsGuide) {
  // Copies of guides, moved: the payload has widths only, one byte for 16 numbers, but for roots and edges.
  const StrandSet guides = hairGroom(500, [](size_t) { return 16; }).guides;
  HairDescription hairs;
  for (uint32_t g = 0; g < 500; ++g) {
    std::vector<Vec3> points(guides.strand(g).begin(), guides.strand(g).end());
    for (Vec3& point : points) point += Vec3(0.001f, 0, 0);
    hairs.hairs.append(points);
    hairs.bindings.push_back({{g, g, g}, {0, 0}});
  }
  size_t bytes = 0;
  for (const HairChunk& chunk : encodeHairs(hairs, guides, kDefaultHairError)) bytes += chunk.payload.size();
  EXPECT_LT(bytes, 500 * 12u);
}

TEST(HairCodec, CountsThatThePayloadCannotHoldAllocateNothing) {
  const StrandSet guides = guidesOf(5);
  const HairDescription hairs = boundHairs(
      guides, 100, [](size_t) { return 8; }, true);
  const HairChunk sound = encodeHairs(hairs, guides, kDefaultHairError).front();
  const auto refused = [&](const auto& damage) {
    HairChunk chunk = sound;
    damage(chunk);
    HairDescription got;
    // A decoder that allocated for these counts would take 100 GB.
    EXPECT_FALSE(decodeHairs(chunk, guides, got));
    EXPECT_LE(got.hairs.positions.capacity(), 16 * chunk.payload.size());
    EXPECT_LE(got.bindings.capacity(), 32 * chunk.payload.size());
  };
  refused([](HairChunk& c) { c.vertex_count = 0xffffffff; });
  refused([](HairChunk& c) { c.hair_count = 0x7fffffff, c.vertex_count = 0xffffffff; });
  refused([](HairChunk& c) { c.hair_count = 0xffffffff; });
  refused([](HairChunk& c) { c.hair_count = 0; });
  refused([](HairChunk& c) { c.hair_count = c.vertex_count; });
  refused([](HairChunk& c) { ++c.vertex_count; });
  refused([](HairChunk& c) { --c.vertex_count; });
  refused([](HairChunk& c) { c.payload.clear(); });
  refused([](HairChunk& c) { c.payload.pop_back(); });
  refused([](HairChunk& c) { c.payload.push_back(0); });
  refused([](HairChunk& c) { c.payload.assign(60'000, 0); });
  refused([](HairChunk& c) { c.arrays |= 32; });
  refused([](HairChunk& c) { c.encoding = 1; });
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float step : {0.0f, -1e-5f, 0.9e-6f, 2e-3f, nan}) refused([&](HairChunk& c) { c.step = step; });
  for (const float step : {0.0f, 1e-10f, 1.0f, nan}) refused([&](HairChunk& c) { c.radius_step = step; });
  refused([&](HairChunk& c) { c.uv_box[1] = nan; });
  refused([](HairChunk& c) { c.radius_step = 1e-5f; });  // radii above 0.01 m
  HairDescription got;
  EXPECT_FALSE(decodeHairs(sound, guidesOf(1), got)) << "guides that do not exist";
  EXPECT_FALSE(decodeHairs(sound, StrandSet(), got = {})) << "no guides";
  EXPECT_TRUE(decodeHairs(sound, guides, got = {}));
}

TEST(HairCodec, UnsoundHairsAreRefusedByName) {
  const StrandSet guides = guidesOf(5);
  const HairDescription sound = boundHairs(
      guides, 10, [](size_t) { return 8; }, true);
  const auto error = [&](const auto& damage) {
    HairDescription hairs = sound;
    damage(hairs);
    return errorOf([&] { checkHairs(hairs, guides, "test"); });
  };
  EXPECT_EQ(error([](HairDescription&) {}), "");
  EXPECT_NE(error([](HairDescription& h) { h.bindings[3].guides[2] = 5; }).find("test, hair 3"),
            std::string::npos);
  EXPECT_NE(error([](HairDescription& h) {
              h.bindings[4].weights = {128, 128};
            }).find("hair 4"),
            std::string::npos);
  EXPECT_NE(error([](HairDescription& h) { h.hairs.radii[0] = 0.011f; }), "");
  EXPECT_NE(error([](HairDescription& h) { h.bindings.pop_back(); }), "");
  EXPECT_NE(error([](HairDescription& h) { h.ids.pop_back(); }), "");
  EXPECT_NE(error([](HairDescription& h) { h.colours.emplace_back(); }), "");
  EXPECT_NE(error([](HairDescription& h) { h = {}; }), "");
  EXPECT_NE(
      error([](HairDescription& h) { h.hairs.positions[0].x() = std::numeric_limits<float>::infinity(); }),
      "");
  HairDescription one;
  one.hairs.append(std::vector<Vec3>{Vec3(0, 0, 0)});
  one.bindings.resize(1);
  EXPECT_NE(errorOf([&] { checkHairs(one, guides, "test"); }).find("1 vertices"), std::string::npos);
}

TEST(HairCodec, AHairTooFarFromItsGuideForTheErrorIsNamed) {
  const StrandSet guides = guidesOf(5);
  HairDescription hairs = boundHairs(
      guides, 10, [](size_t) { return 8; }, false);
  for (Vec3& p : hairs.hairs.strand(6)) p.y() += 2;
  hairs.source = "wig.usda (--hair-files)";
  expectError([&] { encodeHairs(hairs, guides, kDefaultHairError); },
              {"wig.usda (--hair-files), hair 6 with its root at", "--unit-meters", "--hair-error"});
  EXPECT_LE(worstError(hairs.hairs, decoded(encodeHairs(hairs, guides, 1e-4f), guides).hairs), 1e-4);
}

}  // namespace
}  // namespace strandcast
