#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "sample_messages.h"
#include "tests/expect_error.h"
#include "transport/assembler.h"
#include "transport/chunks.h"
#include "transport/in_process.h"
#include "transport/subscriber.h"

namespace strandcast {
namespace {

std::shared_ptr<const ColliderSet> assembled(std::vector<ColliderChunk> chunks) {
  ColliderAssembler assembler(1);
  std::shared_ptr<const ColliderSet> whole;
  for (ColliderChunk& chunk : chunks)
    if (auto done = assembler.add(std::move(chunk))) whole = std::move(done);
  return whole;
}

/// A field of this many bricks, all stored.
ColliderSet withField(uint32_t bricks) {
  ColliderSet set = sampleColliders();
  auto field = std::make_shared<DistanceField>(*set.colliders[1].shapes.back().field);
  field->grid.bricks[0] = bricks;
  field->index.clear();
  for (uint32_t b = 0; b < bricks; ++b) field->index.push_back(b);
  field->samples.assign(size_t{bricks} * kBrickWords, 5);
  field->corners.assign((size_t{bricks} + 1) * 4, 0.5f);
  set.colliders[1].shapes.back().field = field;
  return set;
}

TEST(Colliders, OfEveryKindComeAsTheyWent) {
  const ColliderSet set = sampleColliders();
  checkColliders(set, "here");
  std::vector<ColliderChunk> chunks = splitColliders(set);
  EXPECT_EQ(chunks.size(), 2u) << "shapes, and what they consist of";
  const auto received = assembled(chunks);
  ASSERT_TRUE(received);
  EXPECT_TRUE(areAlike(*received, set));
  EXPECT_EQ(received->revision, 1u);
  EXPECT_EQ(received->session, 11u);
}

TEST(Colliders, ManyChunksInAnyOrder) {
  ColliderSet set = withField(300);
  for (uint32_t id = 100; id < 1000; ++id) set.colliders.push_back({id, true, true, set.colliders[0].shapes});
  std::vector<ColliderChunk> chunks = splitColliders(set);
  EXPECT_GT(chunks.size(), 8u);
  std::shuffle(chunks.begin(), chunks.end(), std::mt19937(3));
  for (const ColliderChunk& chunk : chunks)
    EXPECT_LE(4 * chunk.words.size() + 64 * chunk.kinds.size(), kMaxChunkBytes);
  const auto received = assembled(chunks);
  ASSERT_TRUE(received);
  EXPECT_TRUE(areAlike(*received, set));
  ColliderSet none;
  none.groom_id = 1;
  none.session = 11;
  const auto nothing = assembled(splitColliders(none));
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->colliders.empty());
}

TEST(Colliders, AFieldThatIsTooLargeIsReported) {
  const ColliderSet set = withField(static_cast<uint32_t>(kMaxColliderWords / kBrickWords) + 1);
  const auto received = assembled(splitColliders(set));
  ASSERT_TRUE(received);
  EXPECT_TRUE(received->colliders[0].is_whole);
  EXPECT_FALSE(received->colliders[1].is_whole);
  EXPECT_EQ(received->colliders[1].shapes.size(), set.colliders[1].shapes.size() - 1);
}

TEST(Colliders, BadOnesAreRefused) {
  ColliderSet set = sampleColliders();
  set.colliders[1].id = 0;
  EXPECT_NE(errorOf([&] { checkColliders(set, "here"); }), "");
  set = sampleColliders();
  set.colliders[0].shapes[0].radius = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(errorOf([&] { checkColliders(set, "here"); }), "");
  set = sampleColliders();
  set.colliders[0].shapes.assign(kMaxColliderShapes, set.colliders[0].shapes[0]);
  EXPECT_NE(errorOf([&] { checkColliders(set, "here"); }), "");
  // Checks of the receiver.
  const std::vector<ColliderChunk> sound = splitColliders(sampleColliders());
  const auto isTaken = [&](const auto& damage) {
    std::vector<ColliderChunk> chunks = sound;
    damage(chunks);
    return assembled(chunks) != nullptr;
  };
  EXPECT_TRUE(isTaken([](auto&) {}));
  EXPECT_FALSE(isTaken([](auto& c) { c[0].numbers[3] = std::numeric_limits<float>::infinity(); }));
  EXPECT_FALSE(isTaken([](auto& c) { c[0].numbers[3] = 3e38f; })) << "whose distance is not a number";
  EXPECT_FALSE(isTaken([](auto& c) {
    const auto ellipsoid = std::find(c[0].kinds.begin(), c[0].kinds.end(), uint8_t{4}) - c[0].kinds.begin();
    std::fill_n(c[0].numbers.begin() + 16 * ellipsoid + 9, 3, 1e-44f);  // half axes
  })) << "in units of which no distance is a number (found by libFuzzer)";
  EXPECT_FALSE(isTaken([](auto& c) { c[0].kinds[2] = 9; }));
  EXPECT_FALSE(isTaken([](auto& c) { ++c[0].word_counts.back(); }));
  EXPECT_FALSE(isTaken([](auto& c) { c[0].colliders[3] = 0; }));
  EXPECT_FALSE(isTaken([](auto& c) { c[0].follows_head[4] = 1; }));
  EXPECT_FALSE(isTaken([](auto& c) { c[0].total_words = c[1].total_words = 0xFFFFFFFF; }));
  EXPECT_FALSE(isTaken([](auto& c) { c[1].words.pop_back(); }));
  // Words of the field: bricks, then index.
  const size_t field = sound[1].words.size() - (9 + 2 + kBrickWords + 12);
  EXPECT_FALSE(isTaken([&](auto& c) { c[1].words[field + 4] = 0xFFFFFFFF; }));
  EXPECT_FALSE(isTaken([&](auto& c) { c[1].words[field + 9] = 1; })) << "a brick that is not stored";
  EXPECT_FALSE(isTaken([&](auto& c) { c[1].words[field + 8] = 0; }));
}

TEST(Colliders, FramesSayWhereTheyAre) {
  const auto groom = std::make_shared<GroomDescription>(uniformGroom(1500, 10));
  GuideAssembler assembler;
  assembler.setGroom(groom);
  GuideFrame frame = sampleFrame(*groom, 4);
  std::vector<GuideChunk> chunks = splitFrame(*groom, frame);
  ASSERT_GT(chunks.size(), 1u);
  EXPECT_TRUE(chunks[1].colliders.empty()) << "once is enough";
  std::shared_ptr<const GuideFrame> received;
  for (const GuideChunk& chunk : chunks) received = assembler.add(chunk);
  ASSERT_TRUE(received);
  EXPECT_TRUE(isSampleFrame(*received));
  EXPECT_EQ(received->colliders[0].pose.rotation.coeffs(), frame.colliders[0].pose.rotation.coeffs());
  for (const auto& damage : std::vector<std::function<void(GuideChunk&)>>{
           [](GuideChunk& c) { c.collider_poses[5] = 2; }, [](GuideChunk& c) { c.collider_poses.pop_back(); },
           [](GuideChunk& c) { c.colliders.assign(kMaxPlacedColliders + 1, 0); },
           [](GuideChunk& c) { c.bent_colliders[0] = 9; }, [](GuideChunk& c) { c.collider_bends.pop_back(); },
           [](GuideChunk& c) { c.collider_bends[20] = std::numeric_limits<float>::quiet_NaN(); },
           [](GuideChunk& c) { c.collider_bends[20] = 2 * kMaxBendNumber; },
           [](GuideChunk& c) {
             c.bent_colliders.push_back(c.bent_colliders[0]);
             c.collider_bends.resize(2 * kBendNumbers);
           }}) {
    chunks = splitFrame(*groom, sampleFrame(*groom, 5));
    damage(chunks[0]);
    EXPECT_FALSE(assembler.add(chunks[0]));
  }
  EXPECT_EQ(assembler.statistics().chunks_rejected, 8u);
}

TEST(Colliders, TheNewestOfTheGroomsSessionAreShown) {
  auto [publisher, subscriber] = makeInProcessChannel(1);
  GroomDescription groom = uniformGroom(3, 4);
  ColliderSet set = sampleColliders();
  publisher->announceColliders(set);
  EXPECT_FALSE(subscriber->colliders()) << "of no groom yet";
  publisher->announce(groom, sampleBody(3));
  ASSERT_TRUE(subscriber->colliders());
  EXPECT_TRUE(areAlike(*subscriber->colliders(), set));
  set.revision = 2;
  set.colliders.pop_back();
  publisher->announceColliders(set);
  EXPECT_EQ(subscriber->colliders()->colliders.size(), 1u);
  set.revision = 1;
  publisher->announceColliders(sampleColliders());
  EXPECT_EQ(subscriber->colliders()->colliders.size(), 1u) << "an older one changes nothing";
  groom.session = 12;
  publisher->announce(groom, sampleBody(3));
  EXPECT_FALSE(subscriber->colliders()) << "those of another session are not its";
}

TEST(Colliders, MoveBetweenFramesAsHairDoes) {
  auto [publisher, subscriber] = makeInProcessChannel(1);
  const GroomDescription groom = uniformGroom(3, 4);
  publisher->announce(groom, sampleBody(3));
  FramePlayer player(*subscriber, Playout::kSmooth);
  for (uint64_t number = 1; number <= 2; ++number) {
    publisher->publish(sampleFrame(groom, number));
    player.next();
  }
  // Relative to the arrival, so that delays of this machine do not matter.
  const std::chrono::steady_clock::time_point start(
      std::chrono::nanoseconds(subscriber->waitForFrame(0, std::chrono::milliseconds(0))->arrival_time));
  bool between = false;
  for (int ms = 0; ms < 60; ++ms) {
    const auto frame = player.next(std::nullopt, start + std::chrono::milliseconds(ms));
    ASSERT_TRUE(frame);
    ASSERT_EQ(frame->colliders.size(), 2u);
    const double expected = frame->simulation_time * 60, z = frame->colliders[0].pose.position.z();
    EXPECT_NEAR(z, expected, 1e-4);
    EXPECT_NEAR(frame->colliders[0].bend.terms[9].z(), sampleBend(0).terms[9].z() + z, 1e-3);
    between |= z > 1.1 && z < 1.9;
  }
  EXPECT_TRUE(between);
}

}  // namespace
}  // namespace strandcast
