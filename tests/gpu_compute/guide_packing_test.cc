#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "core/simulation.h"
#include "gpu_compute/gpu_backend.h"
#include "tests/transport/golden_hair.h"
#include "transport/codec/guide_decoder.h"
#include "transport/codec/guide_encoder.h"

namespace strandcast {
namespace {

/// Guides of a backend, as the daemon publishes them. Counts what is taken as positions.
class BackendGuides final : public GuideSource {
 public:
  explicit BackendGuides(Backend& backend, Vec3 origin = Vec3::Zero())
      : backend_(backend), origin_(std::move(origin)) {}
  size_t vertices() const override { return backend_.guides().size(); }
  std::span<const Vec3> positions(size_t first, size_t count) override {
    vertices_taken += count;
    world_.clear();
    for (const Vec3& p : backend_.guidesOf(first, count)) world_.push_back(p + origin_);
    return world_;
  }
  std::span<const PackedRun> packed(const GuideGrid& grid, const PackingFrame& frame) override {
    PackingFrame own = frame;
    own.origin = origin_;
    return backend_.packGuides(grid, own);
  }
  size_t vertices_taken = 0;

 private:
  Backend& backend_;
  Vec3 origin_;
  std::vector<Vec3> world_;
};

class GuidePacking : public testing::Test {
 protected:
  void SetUp() override {
    if (!gpuBackendInfo().available) GTEST_SKIP() << gpuBackendInfo().reason;
    if (!gpu_) gpu_ = makeGpuBackend();
  }
  static void TearDownTestSuite() { gpu_.reset(); }

  void load(const StrandSet& rest) {
    model_ = makeStrandModel(rest);
    gpu_->load(model_, restState(model_, model_.rest_roots));
    gpu_encoder_.setGroom(rest);
    cpu_encoder_.setGroom(rest);
  }
  void place(std::span<const Vec3> positions) {
    StrandState state = restState(model_, model_.rest_roots);
    state.positions.assign(positions.begin(), positions.end());
    gpu_->upload(state);
  }
  /// Encodes the guides of the GPU on both and compares all chunks. Returns the vertices that the GPU's
  /// encoder took as positions.
  size_t compare(const Pose& head, const std::string& what, const Vec3& origin = Vec3::Zero()) {
    GuideFrame frame;
    frame.revision = 1;
    frame.frame = ++frame_;
    frame.head = head;
    BackendGuides guides(*gpu_, origin);
    std::vector<GuideChunk> chunks;
    gpu_encoder_.encodeAll(frame, guides, [&](GuideChunk& chunk) { chunks.push_back(chunk); });
    const size_t taken = guides.vertices_taken;
    copyGuides(guides, frame);
    size_t next = 0;
    cpu_encoder_.encodeAll(frame, [&](GuideChunk& expected) {
      ASSERT_LT(next, chunks.size());
      const GuideChunk& chunk = chunks[next++];
      EXPECT_EQ(chunk.encoding, expected.encoding) << what << ", chunk " << expected.chunk_index;
      EXPECT_EQ(chunk.payload, expected.payload) << what << ", chunk " << expected.chunk_index;
    });
    EXPECT_EQ(next, chunks.size()) << what;
    const EncodingReport a = gpu_encoder_.report(), b = cpu_encoder_.report();
    EXPECT_EQ(a.frame_bytes, b.frame_bytes) << what;
    EXPECT_EQ(a.strands_sent_finer, b.strands_sent_finer) << what;
    EXPECT_EQ(a.worst_error, b.worst_error) << what;
    return taken;
  }

  static inline std::unique_ptr<Backend> gpu_;  // shared by all tests: its shaders take long to compile
  StrandModel model_;
  GuideEncoder gpu_encoder_{CodecOptions()}, cpu_encoder_{CodecOptions()};
  uint64_t frame_ = 0;
};

StrandSet hairOf(size_t strands, const std::function<size_t(size_t)>& vertices, float edge = 0.008f) {
  StrandSet set;
  std::minstd_rand random(7);
  const auto unit = [&] { return static_cast<float>(random() % 65536) / 32768 - 1; };
  for (size_t s = 0; s < strands; ++s) {
    std::vector<Vec3> strand{0.1f * Vec3(unit(), unit(), unit())};
    Vec3 way(unit(), -1, unit());
    while (strand.size() < vertices(s)) {
      way += 0.4f * Vec3(unit(), unit() - 0.2f, unit());
      strand.push_back(strand.back() + edge * way.normalized());
    }
    set.append(strand);
  }
  return set;
}

/// Positions of a frame: the hair swayed, on its head.
std::vector<Vec3> swayed(const StrandSet& rest, const Pose& head, float by) {
  std::vector<Vec3> out;
  for (size_t s = 0; s < rest.strands(); ++s) {
    const std::span<const Vec3> strand = rest.strand(s);
    for (size_t i = 0; i < strand.size(); ++i) {
      const float along = static_cast<float>(i * i) * 1e-4f;
      out.push_back(head.apply(strand[i] + by * along * Vec3(1, 0.3f, std::sin(static_cast<float>(s)))));
    }
  }
  return out;
}

Pose headAt(float angle, const Vec3& position) {
  return {position, Quat(Eigen::AngleAxisf(angle, Vec3(0.3f, 1, -0.2f).normalized()))};
}

TEST_F(GuidePacking, BytesAreThoseOfTheCpuForHairOfAllSizes) {
  const struct {
    const char* what;
    size_t strands;
    std::function<size_t(size_t)> vertices;
  } cases[] = {{"one edge", 1, [](size_t) { return size_t{2}; }},
               {"one strand", 1, [](size_t) { return size_t{32}; }},
               {"one long strand", 1, [](size_t) { return size_t{kMaxVerticesPerStrand}; }},
               {"edges alone", 700, [](size_t) { return size_t{2}; }},
               {"strands of all lengths", 531, [](size_t s) { return 2 + s * s % 61; }},
               {"runs of equal strands", 1000, [](size_t) { return size_t{32}; }},
               {"many runs", 9000, [](size_t s) { return 16 + s % 2; }}};
  for (const auto& hair : cases) {
    const StrandSet rest = hairOf(hair.strands, hair.vertices);
    load(rest);
    for (const float angle : {0.0f, 0.7f, -2.9f}) {
      const Pose head = headAt(angle, Vec3(0.01f * angle, 1.6f, -angle));
      place(swayed(rest, head, angle));
      const size_t taken = compare(head, hair.what);
      // A payload of two vertices may be no smaller than float32.
      if (rest.vertices() > 2) {
        EXPECT_EQ(taken, 0u) << hair.what;
      }
    }
  }
}

TEST_F(GuidePacking, TakesTheNewestStep) {
  const StrandSet rest = hairOf(300, [](size_t s) { return 2 + s % 40; });
  load(rest);
  Parameters parameters;
  Pose head;
  for (int i = 0; i < 12; ++i) {
    const std::vector<Pose> begin(model_.bones.size(), head);
    head = headAt(0.03f * static_cast<float>(i), Vec3(0, 0.01f * static_cast<float>(i), 0));
    const std::vector<Pose> end(model_.bones.size(), head);
    gpu_->step({.parameters = &parameters, .bones_begin = begin, .bones_end = end});
    // With the test, the GPU packs ahead in the frame that it expects, and packs again where another is asked
    // for.
    if (i % 4 != 0) {
      EXPECT_FALSE(gpu_->mayHaveDiverged());
    }
    const Pose asked = i % 3 == 2 ? headAt(1, Vec3(0, 0.1f, 0)) : head;
    EXPECT_EQ(compare(asked, "step " + std::to_string(i)), 0u);
    if (i == 6) {
      EXPECT_EQ(compare(head, "once more"), 0u);
    }
    if (i == 8) {
      place(swayed(rest, head, 0.5f));
      EXPECT_EQ(compare(head, "after an upload"), 0u);
    }
  }
}

TEST_F(GuidePacking, GoldenHairIsPackedWithItsExactStrand) {
  const GroomDescription groom = goldenGroom();
  StrandSet solvable;  // strands of two vertices and more
  for (size_t s = 0; s < groom.guides.strands(); ++s)
    if (groom.guides.verticesOf(s) > 1) {
      const std::span<const Vec3> strand = groom.guides.strand(s);
      solvable.append({strand.begin(), strand.end()});
    }
  load(solvable);
  for (uint64_t number = 1; number <= 4; ++number) {
    const GuideFrame frame = goldenFrame(number);
    std::vector<Vec3> positions;
    for (size_t s = 0; s < groom.guides.strands(); ++s)
      for (uint32_t v = groom.guides.offsets[s];
           groom.guides.verticesOf(s) > 1 && v < groom.guides.offsets[s + 1]; ++v)
        positions.push_back(frame.positions[v]);
    place(positions);
    const size_t taken = compare(frame.head, "golden frame");
    EXPECT_GT(taken, 0u) << "the run of the strand that is far away";
  }
  EXPECT_EQ(gpu_encoder_.report().strands_sent_finer, 1u);
}

TEST_F(GuidePacking, RunsWithExactStrandsAreEncodedFromPositionsAlone) {
  const StrandSet rest = hairOf(2000, [](size_t) { return size_t{20}; });
  load(rest);
  const std::vector<StrandRun>& runs = gpu_encoder_.runs();
  ASSERT_GT(runs.size(), 5u);
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  const Vec3 places[] = {Vec3(0, 2, 0),        Vec3(900, 0, 0),       Vec3(nan, 0, 0),
                         Vec3(0, infinity, 0), Vec3(0, 0, -infinity), Vec3(3e38f, -3e38f, 3e38f),
                         Vec3(1e16f, 0, 0)};
  const Pose head = headAt(1, Vec3(0, 1.6f, 0));
  for (const Vec3& by : places) {
    for (const uint32_t vertex : {0u, 7u, 19u}) {  // a root, within a strand, its tip
      std::vector<Vec3> positions = swayed(rest, head, 1);
      positions[runs[2].first_vertex + 20 * 3 + vertex] += by;
      place(positions);
      EXPECT_EQ(compare(head, "a strand far away"), runs[2].vertex_count);
      EXPECT_EQ(gpu_encoder_.report().strands_sent_finer, 1u);
    }
  }
  std::vector<Vec3> positions = swayed(rest, head, 1);
  for (Vec3& p : positions) p *= 1e3f;
  place(positions);
  EXPECT_EQ(compare(head, "nothing fits"), rest.vertices());
}

TEST_F(GuidePacking, RoundsAsTheCpuDoes) {
  const StrandSet rest = hairOf(900, [](size_t) { return size_t{24}; });
  load(rest);
  const float step = 0.95f * 2 / 1.7320508f * CodecOptions().max_error;
  std::minstd_rand random(11);
  for (const bool turned : {false, true}) {
    const Pose head = turned ? headAt(0.5f, Vec3(0.1f, 1.6f, 0)) : Pose{};
    std::vector<Vec3> positions;
    for (const Vec3& p : rest.positions) {
      // Halfway between grid points, one float off them, on them, and at zeros of both signs.
      Vec3 own;
      for (int c = 0; c < 3; ++c) {
        const float whole = std::round(p[c] / step);
        const float places[] = {(whole + 0.5f) * step, std::nextafter((whole + 0.5f) * step, 1.0f),
                                std::nextafter((whole - 0.5f) * step, -1.0f), whole * step};
        own[c] = places[random() % 4];
      }
      positions.push_back(head.apply(own));
    }
    positions[5] = Vec3(0.0f, -0.0f, 1e-40f);
    positions[6] = Vec3(-1e-38f, 1e-30f, 0);
    place(positions);
    compare(head, turned ? "ties, turned" : "ties");
  }
}

TEST_F(GuidePacking, WorldIsRelativeToTheOriginOfTheBackend) {
  const StrandSet rest = hairOf(400, [](size_t) { return size_t{32}; });
  load(rest);
  const Vec3 origin(1000, -3, 52);
  const Pose head = headAt(0.4f, Vec3(0.3f, 1.6f, 0.1f)), world{head.position + origin, head.rotation};
  place(swayed(rest, head, 1));
  // 1 km away floats are coarser than the grid: some strands are sent exactly.
  compare(world, "1 km away", origin);
}

TEST_F(GuidePacking, PrefersEitherPrediction) {
  bool uses[2] = {};
  const Pose head = headAt(0.2f, Vec3(0, 1.6f, 0));
  for (const bool zigzag : {false, true}) {
    // Straight strands, whose edges are alike, and zigzags.
    StrandSet rest = hairOf(300, [](size_t) { return size_t{32}; });
    for (size_t v = 1; v < rest.positions.size(); ++v)
      if (v % 32 != 0)
        rest.positions[v] =
            rest.positions[v - 1] + (zigzag && v % 2 == 0 ? -0.008f : 0.008f) * Vec3(0.3f, -0.9f, 0.2f);
    load(rest);
    place(swayed(rest, head, 0));
    EXPECT_EQ(compare(head, "prediction"), 0u);
    BackendGuides guides(*gpu_);
    GuideFrame frame;
    frame.frame = ++frame_;
    frame.head = head;
    gpu_encoder_.encodeAll(frame, guides,
                           [&](GuideChunk& chunk) { uses[chunk.payload[0] & kAlongStrand] = true; });
  }
  EXPECT_TRUE(uses[0] && uses[1]);
}

TEST_F(GuidePacking, FewBytesAndManyArrive) {
  const StrandSet rest = hairOf(2000, [](size_t) { return size_t{32}; });
  load(rest);
  const Pose head;
  StrandSet still = rest;
  for (size_t s = 0; s < still.strands(); ++s)
    for (size_t i = 1; i < 32; ++i) still.strand(s)[i] = still.strand(s)[0];
  place(still.positions);
  EXPECT_EQ(compare(head, "hair in its roots"), 0u);
  const uint64_t few = gpu_encoder_.report().frame_bytes;
  place(swayed(rest, head, 1));
  EXPECT_EQ(compare(head, "hair in full"), 0u);
  EXPECT_GT(gpu_encoder_.report().frame_bytes, 3 * few);
}

TEST_F(GuidePacking, WhatAFrameHasBeyondTheFrameBeforeArrives) {
  const StrandSet rest = hairOf(3000, [](size_t s) { return 2 + s % 47; });
  load(rest);
  StrandSet still = rest;
  for (size_t s = 0; s < still.strands(); ++s)
    for (Vec3& p : still.strand(s)) p = still.strand(s)[0];
  uint64_t before = 0;
  for (int frame = 0; frame < 6; ++frame) {  // few bytes and many by turns, and never the same many
    const Pose head = headAt(0.1f * static_cast<float>(frame), Vec3(0, 1.6f, 0));
    place(frame % 2 == 0 ? swayed(still, head, 0) : swayed(rest, head, 0.2f * static_cast<float>(frame)));
    EXPECT_EQ(compare(head, "frame " + std::to_string(frame)), 0u);
    const uint64_t bytes = gpu_encoder_.report().frame_bytes;
    if (frame % 2 == 1) {
      EXPECT_GT(bytes, 2 * before + 8192) << frame;
    }
    before = bytes;
  }
}

TEST_F(GuidePacking, OtherEncodingsAreThoseOfTheCpu) {
  const StrandSet rest = hairOf(200, [](size_t) { return size_t{16}; });
  load(rest);
  const Pose head = headAt(0.2f, Vec3(0, 1.6f, 0));
  place(swayed(rest, head, 0));
  for (const CodecInfo& info : codecList()) {
    for (const bool zstd : {false, true}) {
      CodecOptions options{info.codec};
      options.zstd = zstd;
      GuideEncoder encoder(options), expected(options);
      encoder.setGroom(rest);
      expected.setGroom(rest);
      BackendGuides guides(*gpu_);
      GuideFrame frame;
      frame.frame = ++frame_;
      frame.head = head;
      std::vector<std::vector<uint8_t>> payloads;
      encoder.encodeAll(frame, guides, [&](GuideChunk& chunk) { payloads.push_back(chunk.payload); });
      EXPECT_EQ(guides.vertices_taken, info.codec == Codec::kDelta16 && !zstd ? 0 : rest.vertices())
          << info.name;
      copyGuides(guides, frame);
      size_t next = 0;
      expected.encodeAll(
          frame, [&](GuideChunk& chunk) { EXPECT_EQ(payloads.at(next++), chunk.payload) << info.name; });
    }
  }
}

TEST_F(GuidePacking, ReadersDecodeIt) {
  const StrandSet rest = hairOf(900, [](size_t s) { return 3 + s % 30; });
  load(rest);
  const Pose head = headAt(0.2f, Vec3(0, 1.6f, 0));
  const std::vector<Vec3> positions = swayed(rest, head, 1);
  place(positions);
  GuideDecoder decoder;
  decoder.setGroom(rest);
  BackendGuides guides(*gpu_);
  GuideFrame frame;
  frame.frame = 1;
  frame.head = head;
  gpu_encoder_.encodeAll(frame, guides, [&](GuideChunk& chunk) {
    std::vector<Vec3> decoded(chunk.vertex_count);
    ASSERT_EQ(decoder.decode(chunk, decoded), DecodeResult::kDone);
    for (size_t v = 0; v < decoded.size(); ++v)
      EXPECT_LE((decoded[v] - positions[chunk.first_vertex + v]).norm(), 1e-5f);
  });
}

}  // namespace
}  // namespace strandcast
