#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "core/error.h"
#include "sample_messages.h"
#include "transport/cdr.h"
#include "transport/chunks.h"
#include "transport/in_process.h"
#include "transport/pose_inbox.h"
#include "transport/pose_sender.h"

namespace strandcast {
namespace {

/// Whether the message is still sound after `change`.
template <class Change>
bool soundAfter(const Change& change) {
  PoseSamples samples = samplePoses();
  change(samples);
  return isSound(samples);
}

TEST(PoseMessage, NamesSayWhatEachPoseMoves) {
  PoseSamples samples = samplePoses();
  samples.names = "head joint:left%20arm bone:100%25 body:chair camera";
  EXPECT_EQ(posedNames(samples), (std::vector<PosedName>{{PosedKind::kHead, ""},
                                                         {PosedKind::kJoint, "left arm"},
                                                         {PosedKind::kBone, "100%"},
                                                         {PosedKind::kBody, "chair"},
                                                         {PosedKind::kOther, "camera"}}));
  EXPECT_EQ(weightNames(samples), std::vector<std::string>{"smile"});
}

TEST(PoseMessage, SoundOnesAreAccepted) {
  EXPECT_TRUE(isSound(samplePoses()));
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

TEST(PoseMessage, LongNamesAreNotCutToOthers) {
  PoseSamples samples = samplePoses(), back;
  samples.names += std::string(kMaxPoseNameBytes - samples.names.size(), 'r');
  std::vector<uint8_t> bytes(writeCdr(samples, {}));
  writeCdr(samples, bytes);
  ASSERT_TRUE(readCdr(std::span<const uint8_t>(bytes), back));
  EXPECT_TRUE(isSound(back));
  samples.names += 'r';
  bytes.resize(writeCdr(samples, {}));
  writeCdr(samples, bytes);
  ASSERT_TRUE(readCdr(std::span<const uint8_t>(bytes), back));
  EXPECT_FALSE(isSound(back));
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
  PoseSamples samples = samplePoses();
  samples.groom_id = 4;
  EXPECT_FALSE(inbox.push(samples)) << "for another groom";
  samples.groom_id = 3;
  samples.poses[4] = 0.9f, samples.poses[6] = 1.2f;
  EXPECT_TRUE(inbox.push(samples));
  EXPECT_TRUE(inbox.push(samplePoses())) << "for every groom";
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
  PoseSamples samples = samplePoses();
  for (samples.newest = 0; samples.newest < kMaxQueuedPoses + 5; ++samples.newest) inbox.push(samples);
  for (uint32_t number = 5; number < kMaxQueuedPoses + 5; ++number) {
    const std::optional<PoseSamples> taken = inbox.take();
    ASSERT_TRUE(taken);
    ASSERT_EQ(taken->newest, number);
  }
  EXPECT_FALSE(inbox.take());
}

/// Keeps its messages.
class KeptPoses final : public PoseSender {
 public:
  explicit KeptPoses(size_t samples = 1) : PoseSender(1, samples) {}
  const std::vector<PoseSamples>& messages() const { return messages_; }

 private:
  void write(PoseSamples& message) override {
    EXPECT_TRUE(isSound(message));
    messages_.push_back(message);
  }
  std::vector<PoseSamples> messages_;
};

Pose at(float x) { return {Vec3(x, 1, 2), Quat(0.8f, 0, 0.6f, 0)}; }

TEST(PoseSender, NamesWhatItMovesNowAndThen) {
  KeptPoses sender;
  sender.setNames({"head", "joint:left arm", "bone:100%"}, {"big smile"});
  const std::vector<Pose> poses{at(1), at(2), at(3)};
  const float weight = 0.5f;
  const auto start = std::chrono::steady_clock::now();
  for (uint64_t time = 0; time < 5; ++time) sender.send(time, poses, {&weight, 1});
  const auto took = std::chrono::steady_clock::now() - start;
  const PoseSamples first = sender.messages()[0], fifth = sender.messages()[4];
  EXPECT_EQ(posedNames(first),
            (std::vector<PosedName>{
                {PosedKind::kHead, ""}, {PosedKind::kJoint, "left arm"}, {PosedKind::kBone, "100%"}}));
  EXPECT_EQ(weightNames(first), std::vector<std::string>{"big smile"});
  EXPECT_EQ(first.source, sender.source());
  EXPECT_NE(first.source, KeptPoses().source());
  EXPECT_EQ(first.poses, (std::vector<float>{1, 1, 2, 0, 0.6f, 0, 0.8f,  //
                                             2, 1, 2, 0, 0.6f, 0, 0.8f,  //
                                             3, 1, 2, 0, 0.6f, 0, 0.8f}));
  EXPECT_EQ(first.weights, std::vector<float>{0.5f});
  EXPECT_TRUE((fifth.names.empty() && fifth.weight_names.empty()) || took > std::chrono::milliseconds(500));
  EXPECT_EQ(fifth.newest, first.newest + 4);
  EXPECT_EQ(fifth.epoch, first.epoch);
  sender.setNames({"body:chair"});
  sender.send(5, {poses.data(), 1});
  EXPECT_EQ(sender.messages()[5].names, "body:chair");
  EXPECT_NE(sender.messages()[5].names_revision, first.names_revision);
  std::this_thread::sleep_for(std::chrono::milliseconds(510));
  sender.send(6, {poses.data(), 1});
  EXPECT_EQ(sender.messages()[6].names, "body:chair") << "again after half a second";
}

TEST(PoseSender, RepeatsSamplesOfOneMotion) {
  KeptPoses sender(3);
  sender.setNames({"head"});
  const auto send = [&](uint64_t time, float x, bool scaled = false) -> const PoseSamples& {
    const Pose pose = at(x);
    const Vec3 scale(1, 2, 1);
    sender.send(time, {&pose, 1}, {}, {&scale, scaled ? 1u : 0u});
    return sender.messages().back();
  };
  const auto places = [](const PoseSamples& message) {
    std::vector<float> xs;
    for (size_t i = 0; i < message.poses.size(); i += 7) xs.push_back(message.poses[i]);
    return xs;
  };
  send(100, 1), send(110, 2), send(120, 3);
  const PoseSamples fourth = send(135, 4);
  EXPECT_EQ(fourth.time, 135u);
  EXPECT_EQ(fourth.ages, (std::vector<uint32_t>{0, 15, 25}));
  EXPECT_EQ(places(fourth), (std::vector<float>{4, 3, 2}));
  sender.cut();
  const PoseSamples jumped = send(50, 5);
  EXPECT_EQ(jumped.ages, std::vector<uint32_t>{0}) << "a cut divides the samples, and the clock may be set";
  EXPECT_EQ(jumped.newest, fourth.newest + 1);
  EXPECT_NE(jumped.epoch, fourth.epoch);
  EXPECT_EQ(send(60, 6).ages.size(), 2u);
  EXPECT_EQ(send(70, 7, true).ages.size(), 1u) << "samples with scales and without";
  EXPECT_EQ(places(send(80, 8, true)), (std::vector<float>{8, 7}));
  sender.setNames({"head"});
  EXPECT_EQ(send(90, 9).ages.size(), 1u);
  EXPECT_EQ(send(90 + 5'000'000'000, 10).ages.size(), 1u) << "an age beyond 32 bits";
}

TEST(PoseSender, RepeatsWhatFitsADatagram) {
  KeptPoses sender(3);
  std::vector<std::string> names;
  for (size_t i = 0; i < kMaxPoseNames; ++i) names.push_back("joint:" + std::to_string(i));
  sender.setNames(names);
  const std::vector<Pose> poses(kMaxPoseNames, at(1));
  const std::vector<Vec3> scales(kMaxPoseNames, Vec3(1, 1, 1));
  for (uint64_t time = 1; time < 5; ++time) sender.send(time, poses, {}, scales);
  EXPECT_EQ(sender.messages().back().ages.size(), 2u);
}

TEST(PoseSender, RefusesWhatNoDaemonWouldTake) {
  KeptPoses sender;
  const std::vector<Pose> poses{at(1), at(2)};
  EXPECT_THROW(sender.send(1, {}), Error) << "without names";
  EXPECT_THROW(sender.setNames({"head", "head"}), Error);
  EXPECT_THROW(sender.setNames({"head", ""}), Error);
  EXPECT_THROW(sender.setNames({""}), Error);
  EXPECT_THROW(sender.setNames({"joint:a\nb"}), Error);
  EXPECT_THROW(sender.setNames({std::string(kMaxPoseNameBytes + 1, 'n')}), Error);
  EXPECT_THROW(sender.setNames({}, std::vector<std::string>(kMaxWeightNames + 1, "w")), Error);
  sender.setNames({"head", "body:chair"});
  sender.send(5, poses);
  EXPECT_THROW(sender.send(5, poses), Error) << "the same time";
  EXPECT_THROW(sender.send(6, {poses.data(), 1}), Error);
  EXPECT_THROW(sender.send(6, poses, std::vector<float>{1}), Error);
  EXPECT_THROW(sender.send(6, poses, {}, std::vector<Vec3>{Vec3(1, 1, 1)}), Error);
  EXPECT_THROW(sender.send(6, std::vector<Pose>{at(1), at(std::nanf(""))}), Error);
  EXPECT_THROW(sender.send(6, std::vector<Pose>{at(1), at(1001)}), Error);
  EXPECT_THROW(sender.send(6, poses, {}, std::vector<Vec3>{Vec3(1, 1, 1), Vec3(0, 1, 1)}), Error);
  sender.send(6, poses);
  ASSERT_EQ(sender.messages().size(), 2u);
  EXPECT_EQ(sender.messages()[1].newest, sender.messages()[0].newest + 1) << "what was refused left no gap";
}

TEST(PoseSender, ReachesThePublisherOfItsProcess) {
  const auto [publisher, subscriber] = makeInProcessChannel(4);
  EXPECT_FALSE(publisher->takePoses());
  const auto sender = makeInProcessPoseSender(*subscriber);
  sender->setNames({"head"});
  for (uint64_t time = 1; time < 4; ++time) {
    const Pose pose = at(static_cast<float>(time));
    sender->send(time, {&pose, 1});
  }
  for (uint64_t time = 1; time < 4; ++time) {
    const std::optional<PoseSamples> taken = publisher->takePoses();
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->time, time);
    EXPECT_EQ(taken->poses[0], static_cast<float>(time));
    EXPECT_NE(taken->arrival_time, 0u);
  }
  EXPECT_FALSE(publisher->takePoses());
}

}  // namespace
}  // namespace strandcast
