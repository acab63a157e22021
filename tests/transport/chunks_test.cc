#include "transport/chunks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "chunk_fuzz.h"
#include "core/error.h"
#include "sample_messages.h"
#include "tests/expect_error.h"
#include "transport/assembler.h"
#include "transport/frame_queue.h"

namespace strandcast {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

size_t payloadBytes(const GroomChunk& c) {
  return 4 * (c.vertex_counts.size() + c.positions.size() + c.radii.size() + c.uvs.size()) + c.pinned.size() +
         2 * c.parts.size();
}

void expectSame(const GroomDescription& a, const GroomDescription& b) {
  EXPECT_EQ(a.groom_id, b.groom_id);
  EXPECT_EQ(a.session, b.session);
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.hair_radius, b.hair_radius);
  EXPECT_EQ(a.guides.offsets, b.guides.offsets);
  EXPECT_EQ(a.guides.positions, b.guides.positions);
  EXPECT_EQ(a.guides.pinned, b.guides.pinned);
  EXPECT_EQ(a.guides.radii, b.guides.radii);
  EXPECT_EQ(a.guides.uvs, b.guides.uvs);
  EXPECT_EQ(a.guides.parts, b.guides.parts);
}

void expectSame(const BodyDescription& a, const BodyDescription& b) {
  EXPECT_EQ(a.session, b.session);
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_EQ(a.mesh.name, b.mesh.name);
  EXPECT_EQ(a.mesh.positions, b.mesh.positions);
  EXPECT_EQ(a.mesh.normals, b.mesh.normals);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.head_weights, b.head_weights);
}

/// Feeds the chunks in a seeded random order, each twice before the last one; the message must complete
/// exactly once.
template <class Assembler, class Chunk>
auto assembleShuffled(Assembler& assembler, std::vector<Chunk> chunks) {
  std::shuffle(chunks.begin(), chunks.end(), std::mt19937(3));
  decltype(assembler.add(Chunk(chunks[0]))) result;
  for (size_t i = 0; i < chunks.size(); ++i) {
    EXPECT_EQ(result, nullptr) << "complete before chunk " << i << " of " << chunks.size();
    if (i > 0) {
      EXPECT_EQ(assembler.add(Chunk(chunks[i - 1])), nullptr);
    }
    result = assembler.add(Chunk(chunks[i]));
  }
  return result;
}

void expectGroomRoundTrip(const GroomDescription& groom, size_t min_chunks) {
  const std::vector<GroomChunk> chunks = splitGroom(groom);
  EXPECT_GE(chunks.size(), min_chunks);
  for (const GroomChunk& chunk : chunks) EXPECT_LE(payloadBytes(chunk), kMaxChunkBytes);
  GroomAssembler assembler(groom.groom_id);
  const auto result = assembleShuffled(assembler, chunks);
  ASSERT_TRUE(result);
  expectSame(groom, *result);
  EXPECT_EQ(assembler.chunksRejected(), 0u);
}

TEST(Chunks, GroomOfMixedVertexCountsComesBack) {
  const auto mixed = [](size_t s) { return 1 + s * 37 % 123; };
  expectGroomRoundTrip(sampleGroom(1003, mixed), 10);
}
TEST(Chunks, GroomWithoutOptionalArraysComesBack) {
  expectGroomRoundTrip(sampleGroom(
                           777, [](size_t s) { return 2 + s % 5; }, false),
                       1);
}
TEST(Chunks, GroomOfOneStrandComesBack) { expectGroomRoundTrip(uniformGroom(1, 2), 1); }
TEST(Chunks, GroomOfOneVertexComesBack) { expectGroomRoundTrip(uniformGroom(1, 1), 1); }
TEST(Chunks, GroomOf20000StrandsComesBack) { expectGroomRoundTrip(uniformGroom(20000, 16), 90); }
TEST(Chunks, StrandsOfTheLargestVertexCountComeBack) {
  expectGroomRoundTrip(uniformGroom(3, kMaxWireVertices), 3);
}

TEST(Chunks, BodiesComeBack) {
  for (const BodyDescription& body :
       {sampleBody(120), sampleBody(120, false), sampleBody(2), sampleBody(0)}) {
    BodyAssembler assembler(1);
    const auto result = assembleShuffled(assembler, splitBody(body));
    ASSERT_TRUE(result);
    expectSame(body, *result);
    EXPECT_EQ(assembler.chunksRejected(), 0u);
  }
}

TEST(Chunks, FramesComeBack) {
  for (const GroomDescription& groom : {sampleGroom(1003, [](size_t s) { return 1 + s * 37 % 123; }),
                                        uniformGroom(1, 2), uniformGroom(20000, 16)}) {
    GuideAssembler assembler;
    assembler.setGroom(std::make_shared<GroomDescription>(groom));
    const GuideFrame frame = sampleFrame(groom, 5);
    const std::vector<GuideChunk> chunks = splitFrame(groom, frame);
    for (const GuideChunk& chunk : chunks) EXPECT_LE(chunk.payload.size(), kMaxChunkBytes);
    const auto result = assembleShuffled(assembler, chunks);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->positions, frame.positions);
    EXPECT_EQ(result->head.position, frame.head.position);
    EXPECT_EQ(result->head.rotation.coeffs(), frame.head.rotation.coeffs());
    EXPECT_EQ(result->frame, 5u);
    EXPECT_EQ(result->simulation_time, frame.simulation_time);
    EXPECT_EQ(result->publish_time, frame.publish_time);
    EXPECT_EQ(assembler.statistics().frames_received, 1u);
    EXPECT_EQ(assembler.statistics().frames_lost, 0u);
    EXPECT_EQ(assembler.chunksRejected(), 0u);
  }
}

TEST(Chunks, AFramesFirstChunkHasRoomForItsColliders) {
  for (const size_t vertices : {size_t{2}, size_t{16}, size_t{2000}, kMaxWireVertices}) {
    const GroomDescription groom = uniformGroom(100, vertices);
    GuideFrame frame = sampleFrame(groom, 5);
    SurfaceBend bend;
    bend.terms[0].x() = 0.01f;
    frame.colliders.clear();
    for (uint32_t id = 1; id <= kMaxPlacedColliders; ++id) frame.colliders.push_back({id, Pose{}, bend});
    const std::vector<GuideChunk> chunks = splitFrame(groom, frame);
    const GuideChunk& first = chunks[0];
    EXPECT_EQ(first.bent_colliders.size(), kMaxPlacedColliders);
    EXPECT_LE(12 * size_t{first.vertex_count} +
                  bytesOf(first.colliders, first.collider_poses, first.bent_colliders, first.collider_bends),
              vertices < kMaxWireVertices ? kMaxChunkBytes : 65000)
        << "a datagram";
    GuideAssembler assembler;
    assembler.setGroom(std::make_shared<GroomDescription>(groom));
    const auto result = assembleShuffled(assembler, chunks);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->positions, frame.positions);
  }
}

TEST(Chunks, AnnouncementRefusesWhatReceiversWould) {
  const auto expect_refusal = [](const char* why,
                                 const std::function<void(GroomDescription&, BodyDescription&)>& spoil) {
    GroomDescription groom = uniformGroom(4, 3);
    BodyDescription body = sampleBody(3);
    EXPECT_NO_THROW(checkAnnouncement(groom, body, "here"));
    spoil(groom, body);
    EXPECT_THROW(checkAnnouncement(groom, body, "here"), Error) << why;
  };
  expect_refusal("no strands", [](auto& g, auto&) { g.guides = StrandSet(); });
  expect_refusal("offsets beyond positions", [](auto& g, auto&) { g.guides.offsets.back() += 1; });
  expect_refusal("offsets go back",
                 [](auto& g, auto&) { std::swap(g.guides.offsets[1], g.guides.offsets[2]); });
  expect_refusal("NaN", [](auto& g, auto&) { g.guides.positions[1].x() = kNan; });
  expect_refusal("short radii", [](auto& g, auto&) { g.guides.radii.pop_back(); });
  expect_refusal("negative radius", [](auto& g, auto&) { g.guides.radii[0] = -1e-4f; });
  expect_refusal("negative hair radius", [](auto& g, auto&) { g.hair_radius = -1; });
  expect_refusal("long strand", [](auto& g, auto&) { g = uniformGroom(1, kMaxWireVertices + 1); });
  expect_refusal("triangle out of range", [](auto&, auto& b) { b.mesh.triangles[0][2] = 9; });
  expect_refusal("weight out of range", [](auto&, auto& b) { b.head_weights[0] = 1.5f; });
  expect_refusal("NaN in the body", [](auto&, auto& b) { b.mesh.positions[0].z() = kNan; });
}

TEST(Chunks, CommandsThatDoNotFitTheWireAreRefused) {
  Command command;
  command.id = 1;
  command.name = "wind";
  EXPECT_NO_THROW(checkCommand(command, 1));
  for (const char* name : {"a\nb", "\x1b[2J", "a\x7f"}) {
    command.name = name;
    EXPECT_THROW(checkCommand(command, 1), Error) << "its name may forge a line of a log";
  }
  command.name = "chair";
  command.kind = CommandKind::kAddColliderFile;
  EXPECT_NO_THROW(checkCommand(command, 1));
  command.kind = static_cast<CommandKind>(15);
  EXPECT_THROW(checkCommand(command, 1), Error) << "of no known kind";
}

// ---- damage: every damaged chunk is refused and counted, and does not affect its message

template <class Chunk>
struct Damage {
  const char* name;
  std::function<void(Chunk&)> apply;
};

/// The damaged copy of chunk 1 comes first, or after chunk 0; then the valid chunks complete the message.
template <class MakeAssembler, class Chunk>
void expectRefusal(MakeAssembler make, const std::vector<Chunk>& chunks,
                   const std::vector<Damage<Chunk>>& damages) {
  ASSERT_GE(chunks.size(), 3u);
  for (const auto& damage : damages) {
    auto assembler = make();
    Chunk damaged = chunks[1];
    damage.apply(damaged);
    EXPECT_EQ(assembler.add(Chunk(chunks[0])), nullptr);
    EXPECT_EQ(assembler.add(std::move(damaged)), nullptr) << damage.name;
    EXPECT_EQ(assembler.chunksRejected(), 1u) << damage.name;
    bool is_complete = false;
    for (size_t i = 1; i < chunks.size(); ++i) is_complete = assembler.add(Chunk(chunks[i])) != nullptr;
    EXPECT_TRUE(is_complete) << damage.name;
  }
}

TEST(Chunks, DamagedGroomChunksAreRefused) {
  using C = GroomChunk;
  expectRefusal([] { return GroomAssembler(1); }, splitGroom(uniformGroom(1500, 10)),
                std::vector<Damage<C>>{
                    {"session 0", [](C& c) { c.session = 0; }},
                    {"groom id", [](C& c) { c.groom_id = 2; }},
                    {"index beyond count", [](C& c) { c.chunk_index = c.chunk_count; }},
                    {"count 0", [](C& c) { c.chunk_count = 0; }},
                    {"huge count", [](C& c) { c.chunk_count = 0xffffffff; }},
                    {"another count", [](C& c) { ++c.chunk_count; }},
                    {"another total", [](C& c) { ++c.total_strands; }},
                    {"huge total", [](C& c) { c.total_vertices = 0xffffffff; }},
                    {"strands out of range", [](C& c) { c.first_strand = 0xffffffff; }},
                    {"vertices out of range", [](C& c) { c.first_vertex = 0xfffffff0; }},
                    {"no strands", [](C& c) { c.vertex_counts.clear(); }},
                    {"vertex count 0", [](C& c) { c.vertex_counts[0] = 0; }},
                    {"huge vertex count", [](C& c) { c.vertex_counts[0] = 0xffffffff; }},
                    {"counts that sum up to 2^32 more",
                     [](C& c) { c.vertex_counts[0] += 0x80000000, c.vertex_counts[1] += 0x80000000; }},
                    {"short positions", [](C& c) { c.positions.pop_back(); }},
                    {"short pinned", [](C& c) { c.pinned.pop_back(); }},
                    {"no radii", [](C& c) { c.radii.clear(); }},
                    {"long uvs", [](C& c) { c.uvs.push_back(0); }},
                    {"short parts", [](C& c) { c.parts.pop_back(); }},
                    {"other arrays", [](C& c) { c.arrays ^= 1; }},
                    {"unknown arrays", [](C& c) { c.arrays |= 16; }},
                    {"NaN position", [](C& c) { c.positions[7] = kNan; }},
                    {"infinite radius", [](C& c) { c.radii[7] = INFINITY; }},
                    {"NaN uv", [](C& c) { c.uvs[0] = kNan; }},
                    {"negative radius", [](C& c) { c.radii[7] = -1e-4f; }},
                    {"NaN hair radius", [](C& c) { c.hair_radius = kNan; }},
                    {"negative hair radius", [](C& c) { c.hair_radius = -1; }},
                    {"long name", [](C& c) { c.name.assign(kMaxTextBytes + 1, 'x'); }},
                    {"another name", [](C& c) { c.name = "other"; }},
                });
}

TEST(Chunks, DamagedBodyChunksAreRefused) {
  using C = BodyChunk;
  expectRefusal([] { return BodyAssembler(1); }, splitBody(sampleBody(100)),
                std::vector<Damage<C>>{
                    {"another total", [](C& c) { ++c.total_positions; }},
                    {"positions out of range", [](C& c) { c.first_position = 0xffffffff; }},
                    {"triangles out of range", [](C& c) { c.first_triangle = 0xffffffff; }},
                    {"short positions", [](C& c) { c.positions.pop_back(); }},
                    {"one position less", [](C& c) { c.positions.resize(c.positions.size() - 3); }},
                    {"short normals", [](C& c) { c.normals.pop_back(); }},
                    {"no weights", [](C& c) { c.head_weights.clear(); }},
                    {"weight above 1", [](C& c) { c.head_weights[0] = 1.01f; }},
                    {"NaN weight", [](C& c) { c.head_weights[0] = kNan; }},
                    {"NaN normal", [](C& c) { c.normals[0] = kNan; }},
                    {"half a triangle", [](C& c) { c.triangles.push_back(0); }},
                    {"index out of range",
                     [](C& c) {
                       c.triangles = {0, 1, c.total_positions};
                     }},
                    {"unknown arrays", [](C& c) { c.arrays |= 4; }},
                });
}

TEST(Chunks, DamagedGuideChunksAreRefused) {
  using C = GuideChunk;
  const auto groom = std::make_shared<GroomDescription>(uniformGroom(1500, 10));
  const auto make = [&] {
    GuideAssembler assembler;
    assembler.setGroom(groom);
    return assembler;
  };
  expectRefusal(make, splitFrame(*groom, sampleFrame(*groom, 5)),
                std::vector<Damage<C>>{
                    {"another session", [](C& c) { ++c.session; }},
                    {"another revision", [](C& c) { ++c.revision; }},
                    {"another groom", [](C& c) { ++c.groom_id; }},
                    {"frame 0", [](C& c) { c.frame = 0; }},
                    {"index beyond count", [](C& c) { c.chunk_index = c.chunk_count; }},
                    {"huge count", [](C& c) { c.chunk_count = 0xffffffff; }},
                    {"another count", [](C& c) { ++c.chunk_count; }},
                    {"no strands", [](C& c) { c.strand_count = 0; }},
                    {"strands out of range", [](C& c) { c.first_strand = 0xffffffff; }},
                    {"too many strands", [](C& c) { c.strand_count = 0xffffffff; }},
                    {"shifted strands", [](C& c) { ++c.first_strand; }},
                    {"shifted vertices", [](C& c) { ++c.first_vertex; }},
                    {"another vertex count", [](C& c) { --c.vertex_count; }},
                    {"short payload", [](C& c) { c.payload.pop_back(); }},
                    {"no payload", [](C& c) { c.payload.clear(); }},
                    {"unknown encoding", [](C& c) { c.encoding = static_cast<Encoding>(99); }},
                    {"another encoding", [](C& c) { c.encoding = Encoding::kDelta16; }},
                    {"a key frame", [](C& c) { c.key_frame = 1; }},
                    {"NaN position", [](C& c) { c.payload[3] = 0x7f, c.payload[2] = 0xc0; }},
                    {"NaN head", [](C& c) { c.head_position[1] = kNan; }},
                    {"no rotation",
                     [](C& c) {
                       c.head_rotation = {0, 0, 0, 0};
                     }},
                    {"another head", [](C& c) { c.head_position[1] += 1; }},
                    {"another publish time", [](C& c) { c.publish_time += 1; }},
                    {"infinite time", [](C& c) { c.simulation_time = INFINITY; }},
                });
}

TEST(Chunks, FramesWhoseChunksOverlapAreRefused) {
  const auto groom = std::make_shared<GroomDescription>(uniformGroom(1500, 10));
  GuideAssembler assembler;
  assembler.setGroom(groom);
  std::vector<GuideChunk> chunks = splitFrame(*groom, sampleFrame(*groom, 1));
  GuideChunk overlapping = chunks[0];
  overlapping.chunk_index = 1;  // valid alone, but its strands came already
  overlapping.colliders.clear();
  overlapping.collider_poses.clear();
  overlapping.bent_colliders.clear();
  overlapping.collider_bends.clear();
  chunks[1] = overlapping;
  for (const GuideChunk& chunk : chunks) EXPECT_EQ(assembler.add(chunk), nullptr);
  EXPECT_EQ(assembler.chunksRejected(), chunks.size());
}

TEST(Chunks, DescriptionsInChunksBeyondTheLimitAreRefused) {
  const auto joined = [](auto to, const auto& next) {
    to.chunk_count = 1;
    const auto append = [](auto& array, const auto& more) {
      array.insert(array.end(), more.begin(), more.end());
    };
    append(to.positions, next.positions);
    if constexpr (requires { to.vertex_counts; }) {
      append(to.vertex_counts, next.vertex_counts);
    } else {
      append(to.triangles, next.triangles);
    }
    return to;
  };
  const auto groom = splitGroom(sampleGroom(
      400, [](size_t) { return 16; }, false));
  ASSERT_EQ(groom.size(), 2u);
  GroomAssembler grooms(1);
  EXPECT_EQ(grooms.add(joined(groom[0], groom[1])), nullptr);
  EXPECT_EQ(grooms.chunksRejected(), 1u);
  const auto body = splitBody(sampleBody(46));
  ASSERT_EQ(body.size(), 2u);
  BodyAssembler bodies(1);
  EXPECT_EQ(bodies.add(joined(body[0], body[1])), nullptr);
  EXPECT_EQ(bodies.chunksRejected(), 1u);
}

TEST(Chunks, LostFramesAreCountedExactly) {
  const auto groom = std::make_shared<GroomDescription>(uniformGroom(1500, 10));
  GuideAssembler assembler;
  const auto add = [&](uint64_t number, size_t left_out) {
    bool is_complete = false;
    const std::vector<GuideChunk> chunks = splitFrame(*groom, sampleFrame(*groom, number));
    for (size_t i = 0; i < chunks.size(); ++i) {
      if (i != left_out) is_complete = assembler.add(chunks[i]) != nullptr || is_complete;
    }
    return is_complete;
  };
  constexpr size_t kAll = 99;
  EXPECT_FALSE(add(1, kAll));  // no groom yet
  EXPECT_EQ(assembler.chunksRejected(), 0u);
  assembler.setGroom(groom);
  EXPECT_FALSE(add(9, 0));  // before the first complete one: not lost
  EXPECT_TRUE(add(10, kAll));
  EXPECT_EQ(assembler.statistics().frames_lost, 0u);
  EXPECT_FALSE(add(11, 1));  // incomplete, with nothing newer: not lost yet
  EXPECT_EQ(assembler.statistics().frames_lost, 0u);
  EXPECT_TRUE(add(12, kAll));  // now it is lost
  EXPECT_EQ(assembler.statistics().frames_lost, 1u);
  EXPECT_TRUE(add(16, kAll));  // 13, 14, 15
  EXPECT_EQ(assembler.statistics().frames_lost, 4u);
  EXPECT_FALSE(add(14, kAll));  // late: counted already
  EXPECT_EQ(assembler.statistics().frames_lost, 4u);
  EXPECT_EQ(assembler.statistics().frames_received, 3u);
  assembler.setGroom(groom);  // as after every new groom
  EXPECT_TRUE(add(30, kAll));
  EXPECT_EQ(assembler.statistics().frames_lost, 4u);
  EXPECT_EQ(assembler.statistics().frames_received, 4u);
}

TEST(Chunks, InterleavedFramesAllComplete) {
  const auto groom = std::make_shared<GroomDescription>(uniformGroom(1500, 10));
  GuideAssembler assembler;
  assembler.setGroom(groom);
  const auto a = splitFrame(*groom, sampleFrame(*groom, 1)), b = splitFrame(*groom, sampleFrame(*groom, 2));
  for (size_t i = 0; i < a.size(); ++i) {
    const bool is_last = i + 1 == a.size();
    EXPECT_EQ(assembler.add(a[i]) != nullptr, is_last);
    EXPECT_EQ(assembler.add(b[i]) != nullptr, is_last);
  }
  EXPECT_EQ(assembler.statistics().frames_lost, 0u);
}

TEST(Chunks, DamagedFrameNumbersDoNotStarveSoundFrames) {
  const auto groom = std::make_shared<GroomDescription>(uniformGroom(1500, 10));
  GuideAssembler assembler;
  assembler.setGroom(groom);
  for (uint64_t bogus = 1; bogus <= 20; ++bogus)
    assembler.add(splitFrame(*groom, sampleFrame(*groom, bogus << 40))[0]);
  bool is_complete = false;
  for (const GuideChunk& chunk : splitFrame(*groom, sampleFrame(*groom, 1)))
    is_complete = assembler.add(chunk) != nullptr;
  EXPECT_TRUE(is_complete);
}

/// Numbered frames of one chunk, or of several.
struct NumberedFrames {
  explicit NumberedFrames(size_t strands, bool conceals = false)
      : groom(std::make_shared<GroomDescription>(uniformGroom(strands, 10))), assembler(conceals) {
    assembler.setGroom(groom);
  }
  /// The number of the frame that its chunks completed; 0 = none.
  uint64_t add(uint64_t number) {
    uint64_t complete = 0;
    for (GuideChunk& chunk : splitFrame(*groom, sampleFrame(*groom, 1 + number % 1000))) {
      chunk.frame = number;
      for (const auto& frame : {assembler.add(chunk), assembler.concealOverdue()})
        if (frame && frame->strands_concealed == 0) complete = frame->frame;
    }
    return complete;
  }
  const std::shared_ptr<GroomDescription> groom;
  GuideAssembler assembler;
};

TEST(Chunks, AWrongFrameNumberDoesNotEndTheStream) {
  for (const uint64_t wrong : {uint64_t{5000}, uint64_t{1} << 40, ~uint64_t{0}}) {
    NumberedFrames frames(4);
    EXPECT_EQ(frames.add(10), 10u);
    for (uint64_t number = 11; number < 30; ++number) {
      EXPECT_EQ(frames.add(number % 3 == 0 ? wrong : wrong - number), 0u);
      EXPECT_EQ(frames.add(number), number);
    }
    EXPECT_EQ(frames.assembler.statistics().frames_lost, 0u);
    EXPECT_EQ(frames.assembler.chunksRejected(), 19u);
  }
}

TEST(Chunks, AStreamThatRanOnUnheardIsFollowed) {
  NumberedFrames frames(1500);
  EXPECT_EQ(frames.add(10), 10u);
  EXPECT_EQ(frames.add(4000), 4000u) << "a minute of silence";
  EXPECT_EQ(frames.assembler.statistics().frames_lost, 3989u);
  EXPECT_EQ(frames.add(100000), 0u);
  EXPECT_EQ(frames.add(100001), 0u);
  for (uint64_t number = 100002; number < 100010; ++number) EXPECT_EQ(frames.add(number), number);
  EXPECT_EQ(frames.assembler.statistics().frames_lost, 3989u) << "a leap is no loss";
}

TEST(Chunks, AStreamIsFollowedBackFromAWrongFirstNumber) {
  for (const uint64_t wrong : {uint64_t{100}, uint64_t{1} << 40, ~uint64_t{0}}) {
    NumberedFrames frames(1500);
    EXPECT_EQ(frames.add(wrong), wrong);
    uint64_t followed = 0, number = 0;
    while (followed == 0 && ++number < 100) followed = frames.add(number);
    EXPECT_EQ(followed, 3u);
    EXPECT_EQ(frames.add(4), 4u);
    EXPECT_EQ(frames.assembler.statistics().frames_lost, 0u);
  }
}

TEST(Chunks, APieceOfALaterFrameDoesNotBreakThoseBeforeIt) {
  NumberedFrames frames(1500, true);
  EXPECT_EQ(frames.add(10), 10u);
  frames.assembler.add(splitFrame(*frames.groom, sampleFrame(*frames.groom, 2000))[0]);
  int broken = 0;
  for (uint64_t number = 11; number < 60; ++number) broken += frames.add(number) == number ? 0 : 1;
  EXPECT_LE(broken, 8) << "until it is forgotten";
}

TEST(Chunks, AReaderIsGivenFramesWhoseCountBeganAnew) {
  const GroomDescription groom = uniformGroom(4, 3);
  FrameQueue queue;
  queue.setGroom(std::make_shared<GroomDescription>(groom));
  const auto push = [&](uint64_t number) {
    queue.push(std::make_shared<GuideFrame>(sampleFrame(groom, number)), 0);
    return queue.frame();
  };
  const auto last = push(1000);
  EXPECT_EQ(queue.waitForNext(last.get(), std::chrono::milliseconds(0)), nullptr);
  push(3);
  push(4);
  const auto next = queue.waitForNext(last.get(), std::chrono::milliseconds(0));
  ASSERT_TRUE(next);
  EXPECT_EQ(next->frame, 3u);
  EXPECT_EQ(queue.waitForNext(next.get(), std::chrono::milliseconds(0))->frame, 4u);
}

TEST(Chunks, ArbitraryBytesNeverBreakAnAssembler) {
  const std::vector<std::vector<uint8_t>> seeds = chunkSeeds()[0].inputs;
  EXPECT_GT(seeds.size(), 100u) << "small bytes no longer complete messages";
  std::mt19937 random(11);
  size_t completed = 0;
  for (int run = 0; run < 20000; ++run) {
    std::vector<uint8_t> bytes = seeds[random() % seeds.size()];
    for (size_t times = 1 + random() % 4; times > 0; --times)
      bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
    completed += fuzzChunks(bytes.data(), bytes.size());
  }
  EXPECT_GT(completed, 1000u) << "the bytes no longer reach past the checks";
}

TEST(CheckCommand, ANameThatDoesNotFitIsCalledAName) {
  const auto refusal = [](const std::string& name) {
    Command command;
    command.id = 1;
    command.name = name;
    return errorOf([&] { checkCommand(command, 7); });
  };
  EXPECT_EQ(refusal(std::string(255, 'x')), "");
  const std::string too_long = refusal(std::string(300, 'x'));
  EXPECT_NE(too_long.find("the name is too long: 300 bytes"), std::string::npos) << too_long;
  EXPECT_LT(too_long.size(), 200u) << "it is not repeated in full";
  for (const char* const name : {"two\nlines", "a\ttab", "bell\a"})
    EXPECT_NE(refusal(name).find("the name has a line break or another control character"), std::string::npos)
        << name;
}

}  // namespace
}  // namespace strandcast
