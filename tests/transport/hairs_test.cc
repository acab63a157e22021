#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <random>

#include "bound_hairs.h"
#include "tests/expect_error.h"
#include "tests/io/scratch_folder.h"
#include "transport/assembler.h"
#include "transport/codec/hair_codec.h"
#include "transport/in_process.h"
#include "transport/recording/recorder.h"
#include "transport/recording/recording.h"

namespace strandcast {
namespace {

constexpr float kError = 1.001f * kDefaultHairError;  // m

std::shared_ptr<const GroomDescription> someGroom(uint32_t revision = 1) {
  auto groom = std::make_shared<GroomDescription>(hairGroom(200, [](size_t s) { return 2 + s % 30; }));
  groom->revision = revision;
  groom->growth = GroomDescription::kHairs;
  return groom;
}

std::vector<HairChunk> chunksOf(const GroomDescription& groom, const HairDescription& hairs) {
  HairDescription own = hairs;
  own.revision = groom.revision;
  return encodeHairs(own, groom.guides, kDefaultHairError);
}

TEST(Hairs, ComeBackFromTheirChunksInAnyOrder) {
  const auto groom = someGroom();
  const HairDescription hairs = boundHairs(groom->guides, 6000);
  std::vector<HairChunk> chunks = chunksOf(*groom, hairs);
  ASSERT_GT(chunks.size(), 3u);
  std::shuffle(chunks.begin(), chunks.end(), std::mt19937(3));
  HairAssembler assembler(1);
  EXPECT_FALSE(assembler.setGroom(groom));
  std::shared_ptr<const HairDescription> complete;
  for (const HairChunk& chunk : chunks) {
    EXPECT_FALSE(complete);
    complete = assembler.add(HairChunk(chunk));
    if (!complete) {
      EXPECT_FALSE(assembler.add(HairChunk(chunk))) << "a repeated chunk changes nothing";
    }
  }
  ASSERT_TRUE(complete);
  EXPECT_TRUE(areAlike(*complete, hairs, kError));
  EXPECT_EQ(complete->session, 11u);
  EXPECT_EQ(complete->revision, 1u);
  EXPECT_EQ(assembler.chunksRejected(), 0u);
}

TEST(Hairs, WaitForTheirGroom) {
  const auto groom = someGroom(), next = someGroom(2);
  const HairDescription hairs = boundHairs(groom->guides, 3000);
  HairAssembler assembler(1);
  for (HairChunk& chunk : chunksOf(*groom, hairs)) EXPECT_FALSE(assembler.add(std::move(chunk)));
  for (HairChunk& chunk : chunksOf(*next, hairs)) EXPECT_FALSE(assembler.add(std::move(chunk)));
  EXPECT_FALSE(assembler.setGroom(groom)) << "hairs of a later revision have replaced its own";
  const auto complete = assembler.setGroom(next);
  ASSERT_TRUE(complete);
  EXPECT_EQ(complete->revision, 2u);
  EXPECT_TRUE(areAlike(*complete, hairs, kError));
  EXPECT_FALSE(assembler.setGroom(next)) << "each hairs once";
  EXPECT_EQ(assembler.chunksRejected(), 0u);
}

TEST(Hairs, ChunksThatDoNotFitAreRefusedAndCounted) {
  const auto groom = someGroom();
  const std::vector<HairChunk> chunks = chunksOf(*groom, boundHairs(groom->guides, 3000));
  ASSERT_GT(chunks.size(), 1u);
  const auto refused = [&](const std::function<void(HairChunk&)>& damage) {
    HairAssembler assembler(1);
    assembler.setGroom(groom);
    assembler.add(HairChunk(chunks[0]));
    HairChunk chunk = chunks[1];
    damage(chunk);
    const bool is_complete = assembler.add(std::move(chunk)) != nullptr;
    return !is_complete && assembler.chunksRejected() == 1;
  };
  EXPECT_FALSE(refused([](HairChunk&) {}));
  EXPECT_TRUE(refused([](HairChunk& c) { c.session = 0; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.groom_id = 2; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.chunk_count = 0; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.chunk_count = kMaxChunks + 1; }));
  EXPECT_TRUE(refused([](HairChunk& c) { ++c.chunk_count; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.chunk_index = c.chunk_count; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.total_hairs = kMaxHairs + 1; }));
  EXPECT_TRUE(refused([](HairChunk& c) { ++c.total_hairs; }));
  EXPECT_TRUE(refused([](HairChunk& c) { ++c.total_vertices; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.first_hair = c.total_hairs; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.first_vertex = c.total_vertices; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.hair_count = 0; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.hair_count = 0xffffffff; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.vertex_count = c.hair_count; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.arrays = 32; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.encoding = 1; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.step *= 2; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.radius_step = 0; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.uv_box[3] += 1; }));
  EXPECT_TRUE(refused([](HairChunk& c) { c.payload.resize(kMaxChunkBytes + 1); }));
}

TEST(Hairs, ADamagedPayloadOrAGapSpoilsAllOfThem) {
  const auto groom = someGroom();
  const std::vector<HairChunk> chunks = chunksOf(*groom, boundHairs(groom->guides, 3000));
  const auto spoiled = [&](const std::function<void(HairChunk&)>& damage) {
    HairAssembler assembler(1);
    assembler.setGroom(groom);
    std::shared_ptr<const HairDescription> complete;
    for (HairChunk chunk : chunks) {
      if (chunk.chunk_index == 1) damage(chunk);
      complete = assembler.add(std::move(chunk));
    }
    return !complete && assembler.chunksRejected() == chunks.size();
  };
  EXPECT_FALSE(spoiled([](HairChunk&) {}));
  EXPECT_TRUE(spoiled([](HairChunk& c) { c.payload.pop_back(); }));
  EXPECT_TRUE(spoiled([](HairChunk& c) { c.payload.push_back(0); }));
  EXPECT_TRUE(spoiled([](HairChunk& c) { --c.first_hair; }));
  EXPECT_TRUE(spoiled([](HairChunk& c) { --c.first_vertex; }));
  EXPECT_TRUE(spoiled([](HairChunk& c) { --c.hair_count; }));
}

TEST(Hairs, OfAnInProcessChannelAreExactAndThoseOfItsGroom) {
  auto [publisher, subscriber] = makeInProcessChannel(7);
  const auto groom = someGroom();
  const HairDescription hairs = boundHairs(groom->guides, 500);
  expectError([&, end = publisher.get()] { end->announceHairs(hairs); }, {"no groom was announced"});
  publisher->announce(*groom, sampleBody(4));
  EXPECT_FALSE(subscriber->hairs());
  EXPECT_FALSE(subscriber->waitForGroom(std::chrono::milliseconds(1))) << "it says that hairs follow";
  publisher->announceHairs(hairs);
  EXPECT_TRUE(subscriber->waitForGroom(std::chrono::milliseconds(1)));
  const auto got = subscriber->hairs();  // a late reader calls this first
  ASSERT_TRUE(got);
  EXPECT_TRUE(areAlike(*got, hairs, 0));
  EXPECT_EQ(got->groom_id, 7u);
  EXPECT_EQ(got->revision, 1u);
  publisher->announce(*someGroom(2), sampleBody(4));
  EXPECT_FALSE(subscriber->hairs()) << "they followed the guides of another revision";
  publisher->announceHairs(hairs);
  ASSERT_TRUE(subscriber->hairs());
  EXPECT_EQ(subscriber->hairs()->revision, 2u);
  HairDescription stray = hairs;
  stray.bindings[3].guides[1] = 200;
  expectError([&, end = publisher.get()] { end->announceHairs(stray); }, {"guide that does not exist"});
}

TEST(Hairs, AreInRecordingsBehindTheirGroom) {
  const ScratchFolder folder;
  const HairDescription hairs = boundHairs(someGroom()->guides, 3000);
  {
    RecordingPublisher publisher(std::move(makeInProcessChannel(1).first));
    publisher.open(folder / "a.rec", {});
    for (const uint32_t revision : {1u, 2u, 3u}) {
      const auto groom = someGroom(revision);
      publisher.announce(*groom, sampleBody(4));
      if (revision != 2) publisher.announceHairs(hairs);
      publisher.publish(hairFrame(*groom, 10 * revision));
      publisher.publish(hairFrame(*groom, 10 * revision + 1));
    }
    EXPECT_EQ(publisher.close(), "");
  }
  Recording recording(folder / "a.rec");
  ASSERT_EQ(recording.frames(), 6u);
  RecordedFrame read;
  for (const uint64_t number : {5u, 0u, 2u, 3u, 1u}) {
    recording.read(number, read);
    EXPECT_EQ(read.groom->revision, 1 + number / 2);
    ASSERT_EQ(read.hairs != nullptr, number / 2 != 1) << number;
    if (!read.hairs) continue;
    EXPECT_EQ(read.hairs->revision, read.groom->revision);
    EXPECT_TRUE(areAlike(*read.hairs, hairs, kError));
  }
}

TEST(Hairs, ARecordingThatWasCutKeepsThem) {
  const ScratchFolder folder;
  const auto groom = someGroom();
  const HairDescription hairs = boundHairs(groom->guides, 3000);
  uint64_t bytes = 0;
  {
    Recorder recorder(folder / "a.rec", {});
    expectError([&] { recorder.setHairs(hairs); }, {"no groom is recorded"});
    recorder.setGroom(*groom, sampleBody(4));
    recorder.setHairs(hairs);
    for (uint64_t number = 1; number <= 3; ++number) recorder.addFrame(hairFrame(*groom, number));
    bytes = recorder.bytes();
  }
  std::filesystem::resize_file(folder / "a.rec", bytes - 10);
  Recording recording(folder / "a.rec");
  EXPECT_TRUE(recording.isCut());
  ASSERT_EQ(recording.frames(), 2u);
  RecordedFrame read;
  recording.read(1, read);
  ASSERT_TRUE(read.hairs);
  EXPECT_TRUE(areAlike(*read.hairs, hairs, kError));
}

}  // namespace
}  // namespace strandcast
