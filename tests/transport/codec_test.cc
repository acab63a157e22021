#include "transport/codec/codec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/hash.h"
#include "golden_hair.h"
#include "moving_hair.h"
#include "payload_fuzz.h"
#include "tests/expect_error.h"
#include "transport/assembler.h"
#include "transport/codec/bit_blocks.h"
#include "transport/codec/guide_decoder.h"
#include "transport/codec/guide_encoder.h"
#include "transport/codec/strand_coder.h"

namespace strandcast {

// The lane code of the coders, compiled with one float per lane.
namespace octahedral_scalar {
#define STRANDCAST_SCALAR float
// clang-format off
#include "kernels/lanes_scalar.inl"
#include "transport/codec/quantization.inl"
#include "kernels/end_lanes.inl"
// clang-format on
}  // namespace octahedral_scalar

namespace {

double worstError(const GuideFrame& a, const GuideFrame& b) {
  double worst = 0;
  for (size_t v = 0; v < a.positions.size(); ++v)
    worst = std::max(worst, static_cast<double>((a.positions[v] - b.positions[v]).norm()));
  return worst;
}

/// Encoder and decoder without a network.
class Road {
 public:
  Road(GroomDescription groom, CodecOptions options)
      : groom_(std::make_shared<GroomDescription>(std::move(groom))), encoder_(options) {
    encoder_.setGroom(groom_->guides);
    assembler_.setGroom(groom_);
  }
  std::shared_ptr<const GuideFrame> send(const GuideFrame& frame) {
    std::shared_ptr<const GuideFrame> received;
    for (uint32_t i = 0; i < encoder_.runs().size(); ++i) {
      encoder_.encode(frame, i, chunk_);
      EXPECT_LE(chunk_.payload.size(), kMaxChunkBytes);
      encodings_.push_back(chunk_.encoding);
      if (const auto frame_done = assembler_.add(chunk_)) received = frame_done;
    }
    return received;
  }
  const GroomDescription& groom() const { return *groom_; }
  GuideEncoder& encoder() { return encoder_; }
  GuideAssembler& assembler() { return assembler_; }
  const std::vector<Encoding>& encodings() const { return encodings_; }

 private:
  std::shared_ptr<const GroomDescription> groom_;
  GuideEncoder encoder_;
  GuideAssembler assembler_;
  GuideChunk chunk_;
  std::vector<Encoding> encodings_;
};

GroomDescription head() {
  return hairGroom(1000, [](size_t) { return 32; });
}

/// Sends half a second; returns mean bytes per vertex.
double measure(Road& road, double max_error) {
  uint64_t bytes = 0;
  for (uint64_t number = 1; number <= 30; ++number) {
    const GuideFrame frame = hairFrame(road.groom(), number);
    const auto received = road.send(frame);
    EXPECT_TRUE(received) << number;
    if (!received) return 0;
    EXPECT_LE(worstError(frame, *received), max_error * 1.000001);
    EXPECT_NEAR(worstError(frame, *received), road.encoder().report().worst_error, 1e-9);
    EXPECT_EQ(received->head.rotation.coeffs(), frame.head.rotation.coeffs());
    bytes += road.encoder().report().frame_bytes;
  }
  EXPECT_EQ(road.assembler().statistics().chunks_rejected, 0u);
  EXPECT_EQ(road.assembler().statistics().frames_lost, 0u);
  return static_cast<double>(bytes) / (30 * static_cast<double>(road.groom().guides.vertices()));
}

TEST(Codec, EveryCodecKeepsItsErrorAndSize) {
  struct Expected {
    Codec codec;
    double bytes;
  };
  for (const Expected& e : {Expected{Codec::kFloat32, 12.0},
                            {Codec::kDelta16, 4.0},
                            {Codec::kOctahedral12, 4.0},
                            {Codec::kOctahedral16, 5.0},
                            {Codec::kTangent, 2.0},
                            {Codec::kTemporal, 1.0}}) {
    Road road(head(), {e.codec});
    const double bytes = measure(road, e.codec == Codec::kFloat32 ? 0 : 1e-5);
    EXPECT_LE(bytes, e.bytes) << nameOf(e.codec);
    EXPECT_EQ(road.encoder().report().strands_sent_finer, 0u) << nameOf(e.codec);
    std::printf("%-8s %.2f bytes per vertex, worst error %.4f mm\n", nameOf(e.codec), bytes,
                1e3 * road.encoder().report().worst_error);
  }
}

TEST(Codec, AnyErrorThatIsAskedForIsKept) {
  double before = 1e9;
  for (const float max_error : {1e-6f, 1e-5f, 1e-4f, 1e-3f}) {
    for (const Codec codec :
         {Codec::kDelta16, Codec::kOctahedral12, Codec::kOctahedral16, Codec::kTangent, Codec::kTemporal}) {
      Road road(hairGroom(100, [](size_t s) { return 1 + s % 50; }), {codec, max_error});
      const double bytes = measure(road, static_cast<double>(max_error));
      EXPECT_GT(bytes, 0);
      if (codec != Codec::kDelta16) continue;
      EXPECT_LT(bytes, before) << "a coarser grid takes fewer bytes";
      before = bytes;
    }
  }
}

TEST(Codec, StrandsThatWouldBreakTheBoundAreSentFiner) {
  for (const Codec codec : {Codec::kDelta16, Codec::kOctahedral12, Codec::kTangent, Codec::kTemporal}) {
    Road road(head(), {codec}), whole(head(), {codec});
    for (uint64_t number = 1; number <= 12; ++number) {
      GuideFrame frame = hairFrame(road.groom(), number);
      whole.send(frame);
      const uint64_t finer_anyway = whole.encoder().report().strands_sent_finer;
      EXPECT_LE(finer_anyway, 2u);
      // A stretched strand (whose tip no octahedral encoding reaches), one far away, one torn apart.
      const auto& offsets = road.groom().guides.offsets;
      for (uint32_t v = offsets[3] + 1; v < offsets[4]; ++v)
        frame.positions[v] += 0.1f * (frame.positions[v] - frame.positions[offsets[3]]);
      for (uint32_t v = offsets[7]; v < offsets[8]; ++v) frame.positions[v].x() += 900;
      frame.positions[offsets[9] + 5].y() += 2;
      const auto received = road.send(frame);
      ASSERT_TRUE(received);
      EXPECT_LE(worstError(frame, *received), 1e-5);
      EXPECT_EQ(received->positions[offsets[7]], frame.positions[offsets[7]]) << "far away: exactly";
      EXPECT_EQ(road.encoder().report().strands_sent_finer,
                finer_anyway + (codec == Codec::kDelta16 ? 2u : 3u));
    }
  }
}

TEST(Codec, HairThatDoesNotFitTheCodecFallsBackAndIsAnnounced) {
  Road stretched(head(), {Codec::kOctahedral12});
  GuideFrame frame = hairFrame(stretched.groom(), 1);
  for (Vec3& position : frame.positions)
    position = frame.head.position + 1.2f * (position - frame.head.position);
  auto received = stretched.send(frame);
  ASSERT_TRUE(received);
  EXPECT_LE(worstError(frame, *received), 1e-5);
  for (const Encoding encoding : stretched.encodings()) EXPECT_EQ(encoding, Encoding::kDelta16);
  // Noise over kilometres: nothing is smaller than float32, which is exact.
  Road noise(head(), {Codec::kTemporal});
  std::mt19937 random(1);
  std::uniform_real_distribution<float> any(-1000, 1000);
  for (Vec3& position : frame.positions) position = Vec3(any(random), any(random), any(random));
  received = noise.send(frame);
  ASSERT_TRUE(received);
  EXPECT_EQ(received->positions, frame.positions);
  for (const Encoding encoding : noise.encodings()) EXPECT_EQ(encoding, Encoding::kFloat32);
}

TEST(Codec, ANonFiniteStrandIsRefusedByTheReader) {
  for (const CodecInfo& info : codecList()) {
    Road road(head(), {info.codec});
    GuideFrame frame = hairFrame(road.groom(), 1);
    frame.positions[40].x() = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(road.send(frame)) << info.name;
    EXPECT_EQ(road.assembler().statistics().chunks_rejected, 1u) << info.name;
  }
}

TEST(Codec, ALostFrameCostsThoseUpToTheNextThatStandsAlone) {
  CodecOptions options{Codec::kTemporal};
  options.key_interval = 8;
  Road road(head(), options);
  const auto runs = static_cast<uint32_t>(road.encoder().runs().size());
  ASSERT_GT(runs, 1u);
  uint64_t incomplete = 0, last_incomplete = 0;
  GuideChunk chunk;
  for (uint64_t number = 1; number <= 40; ++number) {
    const GuideFrame frame = hairFrame(road.groom(), number);
    std::shared_ptr<const GuideFrame> received;
    for (uint32_t i = 0; i < runs; ++i) {
      road.encoder().encode(frame, i, chunk);
      if (number == 20 && i == 1) continue;  // lost
      if (const auto done = road.assembler().add(chunk)) received = done;
    }
    if (received) {
      EXPECT_LE(worstError(frame, *received), 1e-5) << number;
    } else {
      ++incomplete;
      last_incomplete = number;
    }
  }
  EXPECT_GE(incomplete, 2u);
  EXPECT_LE(incomplete, options.key_interval);
  EXPECT_EQ(last_incomplete, 20 + incomplete - 1) << "all frames from then on";
  EXPECT_EQ(road.assembler().statistics().chunks_without_key, incomplete - 1);
  EXPECT_EQ(road.assembler().statistics().chunks_rejected, 0u);
}

TEST(Codec, BlocksOfBitsAreReadBackAndEndWhereTheyEnd) {
  const std::vector<StrandCoder> coders = runnableStrandCoders();
  std::mt19937 random(7);
  for (size_t count = 0; count < 100; ++count) {
    for (int width = 0; width <= 16; ++width) {
      std::vector<uint16_t> numbers(count);
      for (uint16_t& number : numbers) {
        const int less = random() % 8 == 0 ? static_cast<int>(random() % 17) : 16 - width;
        number = static_cast<uint16_t>(static_cast<int16_t>(random()) >> std::min(less, 15));
        if (less == 16) number = 0;
      }
      std::vector<uint8_t> first;
      for (const StrandCoder& coder : coders) {
        std::vector<uint8_t> room(maxPackedBytes(count));
        room.resize(static_cast<size_t>(coder.pack(numbers, room.data()) - room.data()));
        // An exact allocation, so that sanitizers detect reads beyond its end
        const std::vector<uint8_t> bytes(room.begin(), room.end());
        if (first.empty()) first = bytes;
        ASSERT_EQ(bytes, first) << coder.name << ", " << count << " numbers of " << width << " bits";
        std::vector<uint16_t> back(count);
        std::span<const uint8_t> left = bytes;
        ASSERT_TRUE(coder.unpack(left, back));
        EXPECT_TRUE(left.empty());
        ASSERT_EQ(back, numbers) << coder.name << ", " << count << " numbers of " << width << " bits";
        if (bytes.empty()) continue;
        const std::vector<uint8_t> cut(bytes.begin(), bytes.end() - 1);
        left = cut;
        EXPECT_FALSE(coder.unpack(left, back)) << "a byte too few";
      }
    }
  }
}

// The example follows docs/wire.md, "Blocks of bits".
TEST(Codec, BlocksOfBitsAreAsTheyAreDescribed) {
  const std::vector<uint16_t> numbers = {1, 0xffff, 0, 2, 0, 0, 0, 0, 100};
  const uint8_t expected[] = {0x83,              // 3 bits, then 8
                              0x0a, 0x08, 0x00,  // 2, 1, 0, 4, 0 ...
                              200,  0,    0,    0, 0, 0, 0, 0};
  std::vector<uint8_t> bytes(maxPackedBytes(numbers.size()));
  bytes.resize(static_cast<size_t>(strandCoder().pack(numbers, bytes.data()) - bytes.data()));
  EXPECT_EQ(bytes, std::vector<uint8_t>(std::begin(expected), std::end(expected)));
  const std::vector<uint16_t> wide = {0x2000, 0xe000, 0, 0, 0, 0, 0, 0};  // 15 bits are written as 16
  bytes.resize(maxPackedBytes(wide.size()));
  bytes.resize(static_cast<size_t>(strandCoder().pack(wide, bytes.data()) - bytes.data()));
  ASSERT_EQ(bytes.size(), 17u);
  EXPECT_EQ(bytes[0], 0x0f);
}

TEST(Codec, ZstdHoldsTheSameSymbols) {
  for (const Codec codec : {Codec::kDelta16, Codec::kOctahedral12, Codec::kOctahedral16}) {
    CodecOptions options{codec};
    Road in_blocks(head(), options);
    options.zstd = true;
    Road compressed(head(), options);
    EXPECT_LT(measure(compressed, 1e-5), measure(in_blocks, 1e-5)) << nameOf(codec);
    const GuideFrame frame = hairFrame(in_blocks.groom(), 31);
    const auto a = in_blocks.send(frame), b = compressed.send(frame);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->positions, b->positions) << nameOf(codec);
  }
}

TEST(Codec, KeyFramesLetAReaderJoinWithinTheirInterval) {
  CodecOptions options{Codec::kTemporal};
  options.key_interval = 8;
  Road road(head(), options);
  for (uint64_t number = 1; number <= 20; ++number) road.send(hairFrame(road.groom(), number));
  GuideAssembler late;
  late.setGroom(std::make_shared<GroomDescription>(road.groom()));
  GuideChunk chunk;
  uint64_t first = 0;
  for (uint64_t number = 21; number <= 40; ++number) {
    const GuideFrame frame = hairFrame(road.groom(), number);
    for (uint32_t i = 0; i < road.encoder().runs().size(); ++i) {
      road.encoder().encode(frame, i, chunk);
      EXPECT_LT(chunk.key_frame, number);
      const auto received = late.add(chunk);
      if (received && first == 0) first = number;
      if (received) {
        EXPECT_LE(worstError(frame, *received), 1e-5);
      }
    }
  }
  EXPECT_GT(first, 0u);
  EXPECT_LE(first, 29u);
  EXPECT_EQ(late.statistics().frames_received, 41 - first) << "and sees every frame from then on";
  EXPECT_GT(late.statistics().chunks_without_key, 0u);
  EXPECT_EQ(late.statistics().chunks_rejected, 0u);
}

TEST(Codec, ChunksInAnyOrderDecodeAlone) {
  for (const Codec codec : {Codec::kDelta16, Codec::kOctahedral12, Codec::kOctahedral16, Codec::kTangent}) {
    const GroomDescription groom = head();
    const GuideFrame frame = hairFrame(groom, 9);
    const std::vector<GuideChunk> chunks = splitFrame(groom, frame, {codec});
    ASSERT_GE(chunks.size(), 3u);
    for (const GuideChunk& chunk : chunks) {
      GuideDecoder decoder;  // without any earlier frame
      decoder.setGroom(groom.guides);
      std::vector<Vec3> positions(chunk.vertex_count);
      EXPECT_EQ(chunk.key_frame, 0u);
      ASSERT_EQ(decoder.decode(chunk, positions), DecodeResult::kDone);
      EXPECT_LE((positions[5] - frame.positions[chunk.first_vertex + 5]).norm(), 1e-5f);
    }
  }
}

TEST(Codec, OctahedralDirectionsAreUniformlyFine) {
  using namespace octahedral_scalar;
  const auto back = [](const Vec3& direction, int bits) {
    const auto steps = static_cast<float>((1 << bits) - 1);
    const real3 d = fromOctahedral(toOctahedral({direction.x(), direction.y(), direction.z()}, steps), steps);
    return Vec3(d.x, d.y, d.z);
  };
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  for (const int bits : {12, 16}) {
    // In the middle of a face the points are a hexagonal lattice with spacing 2 sqrt(2) / (2^bits - 1), at a
    // distance of 1 / sqrt(3). No direction is farther from a lattice point than 1 / sqrt(3) of the spacing.
    const float limit = 1.02f * 2 * 1.41421356f / static_cast<float>((1 << bits) - 1);
    float worst = 0;
    for (int i = 0; i < 100000; ++i) {
      const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
      const Vec3 decoded = back(direction, bits);
      EXPECT_NEAR(decoded.norm(), 1, 1e-6);
      worst = std::max(worst, (decoded - direction).norm());
    }
    EXPECT_LT(worst, limit) << bits;
    EXPECT_GT(worst, limit / 2) << bits;
  }
  for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0, -1, 0)})
    EXPECT_LT((back(axis, 12) - axis).norm(), 7e-4f);
}

// Bytes and positions must be equal on machines of any kind.
TEST(Codec, EveryInstructionSetWritesTheSameBytesAndReadsTheSamePositions) {
  struct Golden {
    Codec codec;
    uint64_t positions, bytes;
  };
  const Golden expected[] = {{Codec::kFloat32, 0xdad6e42292e9b4b8, 0xdad6e42292e9b4b8},
                             {Codec::kDelta16, 0xc73503b1d3d3d241, 0x316f6054c4b03ce9},
                             {Codec::kOctahedral12, 0xb25d105aa2d6702c, 0x2785e45c35c5c4e0},
                             {Codec::kOctahedral16, 0xe046143764831636, 0xa938f4729ac388d9},
                             {Codec::kTangent, 0xfba34289de7c7b50, 0x5201cf24f03b0ff9},
                             {Codec::kTemporal, 0x41fe3264a2e2fea8, 0x6a6b5763383e22ed}};
  const std::vector<StrandCoder> coders = runnableStrandCoders();
  ASSERT_FALSE(coders.empty());
  EXPECT_EQ(coders.front().name, strandCoder().name);
  const GroomDescription groom = goldenGroom();
  for (const Golden& golden : expected) {
    for (const StrandCoder& coder : coders) {
      GuideEncoder encoder({golden.codec}, coder);
      GuideDecoder decoder(coder);
      encoder.setGroom(groom.guides);
      decoder.setGroom(groom.guides);
      ContentHash bytes, positions;
      GuideChunk chunk;
      for (uint64_t number = 1; number <= 4; ++number) {
        const GuideFrame frame = goldenFrame(number);
        for (uint32_t i = 0; i < encoder.runs().size(); ++i) {
          encoder.encode(frame, i, chunk);
          bytes.add(chunk.payload.data(), chunk.payload.size());
          std::vector<Vec3> decoded(chunk.vertex_count);
          ASSERT_EQ(decoder.decode(chunk, decoded), DecodeResult::kDone);
          positions.add(decoded.data(), decoded.size() * sizeof(Vec3));
        }
      }
      EXPECT_EQ(positions.value(), golden.positions) << nameOf(golden.codec) << ' ' << coder.name;
      EXPECT_EQ(bytes.value(), golden.bytes) << nameOf(golden.codec) << ' ' << coder.name;
    }
  }
}

TEST(Codec, ThreadsWriteTheSameChunksInOrder) {
  const GroomDescription groom = head();
  for (const CodecInfo& info : codecList()) {
    CodecOptions options{info.codec};
    GuideEncoder alone(options);
    options.threads = 3;
    GuideEncoder together(options);
    alone.setGroom(groom.guides);
    together.setGroom(groom.guides);
    ASSERT_GT(alone.runs().size(), 6u) << "more chunks than are under way at once";
    GuideChunk expected;
    for (uint64_t number = 1; number <= 4; ++number) {
      const GuideFrame frame = hairFrame(groom, number);
      if (number == 3) {
        EXPECT_THROW(together.encodeAll(frame, [](GuideChunk&) { throw Error("no network", "here", ""); }),
                     Error);
        together.setGroom(groom.guides);
        alone.setGroom(groom.guides);
        continue;
      }
      uint32_t next = 0;
      together.encodeAll(frame, [&](GuideChunk& chunk) {
        alone.encode(frame, next, expected);
        EXPECT_EQ(chunk.chunk_index, next++) << info.name;
        EXPECT_EQ(chunk.encoding, expected.encoding) << info.name;
        EXPECT_EQ(chunk.key_frame, expected.key_frame) << info.name;
        EXPECT_EQ(chunk.payload, expected.payload) << info.name;
        GuideChunk().payload.swap(chunk.payload);
      });
      EXPECT_EQ(next, alone.runs().size());
      EXPECT_EQ(together.report().frame_bytes, alone.report().frame_bytes);
      EXPECT_EQ(together.report().strands_sent_finer, alone.report().strands_sent_finer);
      EXPECT_EQ(together.report().worst_error, alone.report().worst_error);
    }
  }
}

TEST(Codec, DamagedPayloadsAreRefusedOrHarmless) {
  std::mt19937 random(6);
  size_t taken = 0, runs = 0;
  for (const FuzzSeeds& seeds : payloadSeeds()) {
    for (const std::vector<uint8_t>& sound : seeds.inputs) {
      EXPECT_TRUE(fuzzPayload(sound.data(), sound.size())) << seeds.of << " undamaged";
      for (int run = 0; run < 4000; ++run, ++runs) {
        std::vector<uint8_t> bytes = sound;
        if (run % 32 == 31) bytes[0] = static_cast<uint8_t>(random());
        if (run % 4 == 1) bytes.resize(1 + random() % bytes.size());
        const size_t reach = run % 2 == 0 ? std::min<size_t>(bytes.size(), 64) : bytes.size();
        for (uint32_t i = 0; reach > 1 && i < 1 + random() % 3; ++i)
          bytes[1 + random() % (reach - 1)] = static_cast<uint8_t>(random());
        taken += fuzzPayload(bytes.data(), bytes.size()) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(taken, runs / 50) << "damage no longer reaches past the checks";
  EXPECT_LT(taken, runs);
}

TEST(Codec, BadOptionsAreRefused) {
  EXPECT_NE(errorOf([] { codecNamed("mp3", "--codec"); }).find("choose one of float32, delta16"),
            std::string::npos);
  for (const CodecInfo& info : codecList()) EXPECT_EQ(codecNamed(info.name, ""), info.codec);
  for (const float error : {0.0f, -1.0f, 0.5e-6f, 2e-3f, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_NE(errorOf([&] { checkCodecOptions({Codec::kDelta16, error}, "here"); }), "") << error;
  EXPECT_NE(errorOf([] { checkCodecOptions({Codec::kTemporal, 1e-5f, 0}, "here"); }), "");
  EXPECT_EQ(errorOf([] { checkCodecOptions({}, "here"); }), "");
}

}  // namespace
}  // namespace strandcast
