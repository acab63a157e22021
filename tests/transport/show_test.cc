#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "transport/show.h"

namespace strandcast {
namespace {

Show sampleShow(size_t vertices) {
  Show show;
  show.session = 5;
  show.revision = 3;
  show.simulation_time = 12.5;
  show.entries = {{ShowKind::kFingerprint, "strands", {20, 1, 2}},
                  {ShowKind::kParameter, "wind", {7, 0, 1}},
                  {ShowKind::kCollider, "a ball", {0, 0, 1, 2, 3, 0, 0, 0, 1}},
                  {ShowKind::kAnswered, "12345 refused: because", {}},
                  {ShowKind::kPaused, "", {}}};
  for (size_t v = 0; v < vertices; ++v) {
    const auto x = static_cast<float>(v);
    show.hair.positions.emplace_back(x, 1, 2);
    show.hair.velocities.emplace_back(3, x, 4);
    show.hair.frames.emplace_back(0.6f, 0, 0.8f, 0);
    show.hair.tensions.push_back(x);
    show.hair.contacts.emplace_back(0, 0, x);
  }
  return show;
}

void expectSame(const Show& a, const Show& b) {
  EXPECT_EQ(a.session, b.session);
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_EQ(a.simulation_time, b.simulation_time);
  EXPECT_EQ(a.entries, b.entries);
  EXPECT_EQ(a.hair.positions, b.hair.positions);
  EXPECT_EQ(a.hair.velocities, b.hair.velocities);
  EXPECT_EQ(a.hair.tensions, b.hair.tensions);
  EXPECT_EQ(a.hair.contacts, b.hair.contacts);
  ASSERT_EQ(a.hair.frames.size(), b.hair.frames.size());
  for (size_t i = 0; i < a.hair.frames.size(); ++i)
    EXPECT_EQ(a.hair.frames[i].coeffs(), b.hair.frames[i].coeffs());
}

TEST(ShowChunks, AShowComesBackFromItsChunksInAnyOrder) {
  for (const size_t vertices : {size_t{0}, size_t{10}, size_t{5000}}) {
    const Show show = sampleShow(vertices);
    std::vector<ShowChunk> chunks = splitShow(show, 9);
    EXPECT_EQ(chunks.size() > 1, vertices == 5000) << chunks.size();
    std::reverse(chunks.begin(), chunks.end());
    ShowAssembler assembler(9, vertices > 0 ? ShowChunk::kStateAndHair : ShowChunk::kState);
    std::optional<Show> back;
    for (ShowChunk& chunk : chunks) back = assembler.add(std::move(chunk));
    ASSERT_TRUE(back) << vertices;
    expectSame(*back, show);
    EXPECT_EQ(assembler.chunksRejected(), 0u);
  }
}

TEST(ShowChunks, ChunksOfTwoShowsMakeNone) {
  Show first = sampleShow(5000), second = first;
  second.revision = 4;
  second.hair.positions[0].x() = 99;
  std::vector<ShowChunk> old_chunks = splitShow(first, 9), chunks = splitShow(second, 9);
  ASSERT_GT(chunks.size(), 2u);
  ShowAssembler assembler(9, ShowChunk::kStateAndHair);
  EXPECT_FALSE(assembler.add(ShowChunk(old_chunks[0])));
  for (size_t i = 1; i < chunks.size(); ++i) EXPECT_FALSE(assembler.add(ShowChunk(chunks[i])));
  EXPECT_FALSE(assembler.add(ShowChunk(old_chunks[0]))) << "an older one does not fill the gap";
  const std::optional<Show> back = assembler.add(ShowChunk(chunks[0]));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->hair.positions[0].x(), 99);
}

TEST(ShowChunks, WhatDoesNotFitIsRefusedAndCounted) {
  const auto refused = [](auto change) {
    ShowChunk chunk = splitShow(sampleShow(0), 9)[0];
    change(chunk);
    ShowAssembler assembler(9, ShowChunk::kState);
    return !assembler.add(std::move(chunk)) && assembler.chunksRejected() == 1;
  };
  EXPECT_TRUE(refused([](ShowChunk& c) { c.session = 0; }));
  EXPECT_TRUE(refused([](ShowChunk& c) { c.groom_id = 8; }));
  EXPECT_TRUE(refused([](ShowChunk& c) { c.part = 1; }));
  EXPECT_TRUE(refused([](ShowChunk& c) { c.chunk_count = 0; }));
  EXPECT_TRUE(refused([](ShowChunk& c) { c.chunk_count = kMaxChunks + 1; }));
  EXPECT_TRUE(refused([](ShowChunk& c) { c.chunk_index = c.chunk_count; }));
  EXPECT_TRUE(refused([](ShowChunk& c) { c.payload.clear(); }));
  EXPECT_TRUE(refused([](ShowChunk& c) { c.payload.resize(kMaxChunkBytes + 1); }));
  EXPECT_TRUE(refused([](ShowChunk& c) { c.payload.push_back(0); }));
  EXPECT_TRUE(refused([](ShowChunk& c) { c.payload.pop_back(); }));
}

TEST(ShowBytes, UnsoundShowsAreRefused) {
  const auto refused = [](auto change) {
    Show show = sampleShow(4);
    change(show);
    return !showOf(showBytes(show));
  };
  EXPECT_FALSE(refused([](Show&) {}));
  EXPECT_FALSE(refused([](Show& s) { s.hair.frames.clear(); })) << "another solver has none";
  EXPECT_TRUE(refused([](Show& s) { s.simulation_time = NAN; }));
  EXPECT_TRUE(refused([](Show& s) { s.entries[1].values[0] = INFINITY; }));
  EXPECT_TRUE(refused([](Show& s) { s.entries[1].values.resize(kMaxShowValues + 1); }));
  EXPECT_TRUE(refused([](Show& s) { s.entries[1].name = "two\nlines"; }));
  EXPECT_TRUE(refused([](Show& s) { s.entries[1].name.assign(300, 'x'); }));
  EXPECT_TRUE(refused([](Show& s) { s.entries[1].kind = static_cast<ShowKind>(kShowKinds); }));
  EXPECT_TRUE(refused([](Show& s) { s.hair.velocities.pop_back(); }));
  EXPECT_TRUE(refused([](Show& s) { s.hair.positions[2].y() = NAN; }));
}

TEST(ShowBytes, DamagedBytesAreRefusedOrSound) {
  const std::vector<uint8_t> sound = showBytes(sampleShow(6));
  std::mt19937 random(3);
  int read = 0;
  for (int run = 0; run < 2000; ++run) {
    std::vector<uint8_t> bytes = sound;
    if (run % 4 == 0) bytes.resize(random() % bytes.size());
    for (uint32_t i = 0; !bytes.empty() && i < 1 + random() % 3; ++i)
      bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
    const std::optional<Show> show = showOf(bytes);
    if (!show) continue;
    ++read;
    for (const Vec3& position : show->hair.positions) EXPECT_TRUE(position.allFinite());
  }
  EXPECT_GT(read, 0);
  EXPECT_LT(read, 2000);
}

}  // namespace
}  // namespace strandcast
