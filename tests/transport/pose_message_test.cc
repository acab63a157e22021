#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "transport/chunks.h"
#include "transport/pose_inbox.h"

namespace strandcast {
namespace {

/// Two samples of a head, a joint and a body, and of one weight.
PoseSamples twoSamples() {
  PoseSamples samples;
  samples.source = 7;
  samples.time = 2'000'000'000;
  samples.newest = 41;
  samples.names = "head joint:left%20arm body:chair";
  samples.weight_names = "smile";
  samples.ages = {0, 16'666'667};
  for (int i = 0; i < 6; ++i)
    samples.poses.insert(samples.poses.end(), {0.1f * static_cast<float>(i), 1, 2, 0, 0.6f, 0, 0.8f});
  samples.weights = {0.5f, 0.25f};
  return samples;
}

/// Whether the message is still sound after `change`.
template <class Change>
bool soundAfter(const Change& change) {
  PoseSamples samples = twoSamples();
  change(samples);
  return isSound(samples);
}

TEST(PoseMessage, NamesSayWhatEachPoseMoves) {
  PoseSamples samples = twoSamples();
  samples.names = "head joint:left%20arm bone:100%25 body:chair camera";
  EXPECT_EQ(posedNames(samples), (std::vector<PosedName>{{PosedKind::kHead, ""},
                                                         {PosedKind::kJoint, "left arm"},
                                                         {PosedKind::kBone, "100%"},
                                                         {PosedKind::kBody, "chair"},
                                                         {PosedKind::kOther, "camera"}}));
  EXPECT_EQ(weightNames(samples), std::vector<std::string>{"smile"});
}

TEST(PoseMessage, SoundOnesAreAccepted) {
  EXPECT_TRUE(isSound(twoSamples()));
  EXPECT_TRUE(soundAfter([](PoseSamples& s) { s.names.clear(), s.weight_names.clear(); })) << "sent before";
  EXPECT_TRUE(soundAfter([](PoseSamples& s) { s.scales.resize(2 * 3 * 3, 1.5f); }));
  EXPECT_TRUE(soundAfter([](PoseSamples& s) { s.weights.clear(), s.weight_names.clear(); }));
  EXPECT_TRUE(soundAfter([](PoseSamples& s) { s.poses.clear(), s.names.clear(); })) << "weights alone";
  EXPECT_TRUE(soundAfter([](PoseSamples& s) { s.names = "head light:key body:chair"; })) << "a later kind";
}

TEST(PoseMessage, OthersAreRefused) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(isSound(PoseSamples()));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.source = 0; }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.ages[0] = 1; }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.ages[1] = 0; }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.time = s.ages[1] - 1; })) << "a sample before time 0";
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.ages.clear(); }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.ages.push_back(20'000'000); })) << "a sample without poses";
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.names += " body:floor"; }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.names = "head  body:chair"; }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.names = "head body:chair head"; }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.names.clear(); })) << "one list alone";
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.weight_names += " frown"; }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.scales.resize(3, 1); }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.scales.resize(2 * 3 * 3); })) << "scale 0";
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.poses.pop_back(); }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.poses[7] = 1000.5f; }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.poses[8] = kNan; }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.poses[4] = s.poses[6] = 0.3f; })) << "a short quaternion";
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.poses[3] = kNan; }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.weights[1] = -10.5f; }));
  EXPECT_FALSE(soundAfter([](PoseSamples& s) { s.weights[1] = kNan; }));
}

TEST(PoseMessage, TheFullestFitADatagram) {
  PoseSamples samples;
  samples.source = 1;
  samples.ages = {0};
  for (size_t i = 0; i < kMaxPoseNames; ++i) {
    samples.names += (i == 0 ? "joint:" : " joint:") + std::string(20, 'j') + std::to_string(1000 + i);
    samples.poses.insert(samples.poses.end(), {0, 0, 0, 0, 0, 0, 1});
    samples.scales.insert(samples.scales.end(), {1, 1, 1});
  }
  for (size_t i = 0; i < kMaxWeightNames; ++i) {
    samples.weight_names += (i == 0 ? "" : " ") + std::string(27, 'w') + std::to_string(1000 + i);
    samples.weights.push_back(0.5f);
  }
  EXPECT_TRUE(isSound(samples));
  PoseSamples more = samples;
  more.names += " joint:one";
  more.poses.insert(more.poses.end(), {0, 0, 0, 0, 0, 0, 1});
  more.scales.insert(more.scales.end(), {1, 1, 1});
  EXPECT_FALSE(isSound(more));
  more = samples;
  more.names.clear(), more.weight_names.clear();
  more.time = 10;
  for (uint32_t age = 1; age < 3; ++age) {
    more.ages.push_back(age);
    more.poses.insert(more.poses.end(), samples.poses.begin(), samples.poses.end());
    more.scales.insert(more.scales.end(), samples.scales.begin(), samples.scales.end());
    more.weights.insert(more.weights.end(), samples.weights.begin(), samples.weights.end());
    EXPECT_EQ(isSound(more), age == 1) << "at most kMaxChunkBytes";
  }
}

TEST(PoseInbox, NormalisesAndStampsWhatItTakes) {
  PoseInbox inbox(3);
  PoseSamples samples = twoSamples();
  samples.groom_id = 4;
  EXPECT_FALSE(inbox.push(samples)) << "for another groom";
  samples.groom_id = 3;
  samples.poses[4] = 0.9f, samples.poses[6] = 1.2f;
  EXPECT_TRUE(inbox.push(samples));
  EXPECT_TRUE(inbox.push(twoSamples())) << "for every groom";
  samples.source = 0;
  EXPECT_FALSE(inbox.push(samples));
  const std::optional<PoseSamples> first = inbox.take(), second = inbox.take();
  ASSERT_TRUE(first && second);
  EXPECT_FALSE(inbox.take());
  EXPECT_EQ(first->groom_id, 3u);
  EXPECT_NEAR(first->poses[4], 0.6f, 1e-6f);
  EXPECT_NEAR(first->poses[6], 0.8f, 1e-6f);
  EXPECT_GT(first->arrival_time, 0u);
  EXPECT_GE(second->arrival_time, first->arrival_time);
}

TEST(PoseInbox, DropsTheOldest) {
  PoseInbox inbox(1);
  PoseSamples samples = twoSamples();
  for (samples.newest = 0; samples.newest < kMaxQueuedPoses + 5; ++samples.newest) inbox.push(samples);
  for (uint32_t number = 5; number < kMaxQueuedPoses + 5; ++number) {
    const std::optional<PoseSamples> taken = inbox.take();
    ASSERT_TRUE(taken);
    ASSERT_EQ(taken->newest, number);
  }
  EXPECT_FALSE(inbox.take());
}

}  // namespace
}  // namespace strandcast
