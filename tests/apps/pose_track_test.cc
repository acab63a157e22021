// The poses that steps take of a live source's samples.
#include "service/pose_track.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <random>

#include "bench/counted_memory.h"
#include "service/frame_pacer.h"
#include "service/pose_clock.h"
#include "tests/thorough.h"

namespace strandcast {
namespace {

constexpr int64_t kStep = 16'666'667;  ///< ns, of 60 Hz
constexpr double kExtrapolate = 0.1;   ///< s

double seconds(int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// A head that shakes at 2 Hz by 0.1 m, and nods.
Pose shaken(double t) {
  const double phase = 2 * EIGEN_PI * 2 * t;
  return {Vec3(static_cast<float>(0.1 * std::sin(phase)), 0, 0.01f),
          Quat(Eigen::AngleAxisf(static_cast<float>(0.3 * std::sin(phase + 1)), Vec3(Vec3::UnitX())))};
}

using Motion = std::function<Pose(double)>;

PoseSample sampleOf(uint32_t number, int64_t time, const Motion& motion = shaken) {
  return {.number = number, .time_ns = time, .poses = {motion(seconds(time))}, .scales = {}, .weights = {}};
}

PoseTrack trackOf(const Vec3& pivot = Vec3::Zero()) {
  return PoseTrack({.pivots = {pivot}, .carrier = 0}, kExtrapolate);
}

const Vec3& placeOf(const PoseTrack::Step& step) { return step.shown.poses[0].position; }

bool areEqual(const PoseSample& a, const PoseSample& b) {
  return a.poses.size() == b.poses.size() &&
         std::memcmp(a.poses.data(), b.poses.data(), a.poses.size() * sizeof(Pose)) == 0 &&
         a.weights == b.weights && a.number == b.number;
}

TEST(PoseTrack, TakesEachSampleBitForBit) {
  for (const double rate : {60.0, 120.0, 59.94}) {
    PoseTrack track = trackOf();
    PoseLock lock;
    const int64_t period = std::llround(1e9 / rate);
    uint32_t sent = 0, next = 0;
    for (int step = 1; step <= 10'000; ++step) {
      const int64_t end = step * kStep;
      // The pace of frames follows the sender: what a step needs is here. The sender's clock began 5 s
      // earlier.
      const int64_t here = lock.isLocked() ? lock.timeOf(end) + kNsPerMillisecond : 5 * kNsPerSecond;
      for (; sent * period + 5 * kNsPerSecond <= here; ++sent) {
        const PoseSample sample = sampleOf(sent, sent * period + 5 * kNsPerSecond);
        EXPECT_TRUE(lock.arrive(sample.time_ns, false, end, end));
        EXPECT_EQ(track.add(sample), PoseTrack::Arrival::kNew);
      }
      lock.lockIfDue(end);
      const int64_t time = lock.timeOf(end);
      const PoseTrack::Step& taken = track.advance(time, kStep);
      ASSERT_TRUE(taken.is_exact) << rate << " Hz, step " << step;
      ASSERT_EQ(taken.state, PoseState::kLive);
      ASSERT_TRUE(areEqual(taken.shown, sampleOf(taken.shown.number, taken.shown.time_ns)));
      ASSERT_EQ(taken.shown.number, next) << rate << " Hz";
      next = taken.shown.number + (rate == 120 ? 2 : 1);
      lock.followPhase(time - taken.shown.time_ns, kStep);
    }
  }
}

TEST(PoseTrack, DoesNotDependOnTheOrderOfArrival) {
  std::vector<PoseSample> samples;
  for (uint32_t i = 0; i < 40; ++i) {
    samples.push_back(sampleOf(i, 2 * i * kStep + (i % 3) * kNsPerMillisecond));
    samples.back().epoch = i / 15 - 1;  // wraps; and the second epoch sets the clock back
    if (i >= 15) samples.back().time_ns -= 5 * kStep;
    samples.back().poses[0].position.y() = static_cast<float>(samples.back().epoch + 1);
  }
  std::mt19937 random(7);
  std::vector<PoseSample> expected;
  for (int round = 0; round < 50; ++round) {
    PoseTrack track = trackOf();
    std::vector<PoseSample> arriving = samples;
    if (round > 0) arriving.insert(arriving.end(), samples.begin(), samples.begin() + 20);
    if (round > 0) std::shuffle(arriving.begin(), arriving.end(), random);
    for (const PoseSample& sample : arriving) track.add(sample);
    for (int step = 0; step < 80; ++step) {
      const PoseSample& shown = track.advance(step * kStep + 1000, kStep).shown;
      if (round == 0) expected.push_back(shown);
      ASSERT_EQ(shown.epoch, (step >= 25) + (step >= 55) - 1u) << "each ends that before it, step " << step;
      ASSERT_TRUE(areEqual(shown, expected[static_cast<size_t>(step)])) << round << ' ' << step;
    }
  }
}

TEST(PoseTrack, DoesNotDependOnWhenSamplesArriveInTime) {
  PoseTrack early = trackOf(), just = trackOf();  // 30 Hz: every other step is between two samples
  std::mt19937 random(5);
  uint32_t sent_early = 0, sent_just = 0;
  int interpolated = 0;
  for (int step = 0; step < 1000; ++step) {
    const int64_t time = step * kStep;
    const auto period = 2 * kStep;
    const auto ahead = static_cast<uint32_t>(2 + random() % 9);
    for (; sent_early * period < time + ahead * period; ++sent_early)
      early.add(sampleOf(sent_early, sent_early * period));
    for (; sent_just * period < time + period; ++sent_just) just.add(sampleOf(sent_just, sent_just * period));
    const PoseTrack::Step &a = early.advance(time, kStep), &b = just.advance(time, kStep);
    ASSERT_TRUE(areEqual(a.shown, b.shown)) << step;
    ASSERT_EQ(a.state, PoseState::kLive);
    interpolated += !a.is_exact;
  }
  EXPECT_EQ(interpolated, 500);
}

TEST(PoseTrack, ALateSampleChangesNoStepOfALiveMotion) {
  for (const uint32_t late : {1u, 5u, 100u}) {
    for (const int64_t period : {kStep, 3 * kStep}) {  // exact, and mostly interpolated
      PoseTrack with = trackOf(), without = trackOf();
      for (uint32_t i = 0; i < 200; ++i) {
        if (i == 50) continue;
        with.add(sampleOf(i, i * period));
        without.add(sampleOf(i, i * period));
      }
      for (int64_t time = 0; time < 190 * period; time += kStep) {
        const int64_t arrives = 50 * period + late * kStep;
        if (time > arrives && time <= arrives + kStep) {
          EXPECT_EQ(with.add(sampleOf(50, 50 * period)), PoseTrack::Arrival::kLate);
        }
        const PoseTrack::Step &a = with.advance(time, kStep), &b = without.advance(time, kStep);
        ASSERT_TRUE(areEqual(a.shown, b.shown)) << late;
      }
    }
  }
}

TEST(PoseTrack, ComesToRestWithContinuousSpeedAfterItsLastSample) {
  const double speed = 1.5, turn = 2;
  const auto straight = [&](double t) {
    return Pose{Vec3(0, static_cast<float>(speed * t), 0),
                Quat(Eigen::AngleAxisf(static_cast<float>(turn * t), Vec3(Vec3::UnitY())))};
  };
  PoseTrack track = trackOf();
  const uint32_t last = 20;
  for (uint32_t i = 0; i <= last; ++i) track.add(sampleOf(i, i * kStep, straight));
  const float end = static_cast<float>(speed * seconds(last * kStep));
  float before = 0;
  double speed_before = speed;
  for (int step = 1; step < 100; ++step) {
    const PoseTrack::Step& taken = track.advance(step * kStep, kStep);
    const double speed_now = (placeOf(taken).y() - before) / seconds(kStep);
    ASSERT_LE(std::fabs(speed_now - speed_before), speed * seconds(kStep) / kExtrapolate + 1e-3) << step;
    ASSERT_GE(speed_now, -1e-6);
    before = placeOf(taken).y();
    speed_before = speed_now;
    const double silence = seconds((step - int{last}) * kStep);
    EXPECT_EQ(taken.state, silence <= 0             ? PoseState::kLive
                           : silence < kExtrapolate ? PoseState::kExtrapolating
                                                    : PoseState::kResting);
    ASSERT_LE(placeOf(taken).y(), end + speed * kExtrapolate / 2 + 1e-6);
    if (silence < kExtrapolate) continue;
    EXPECT_NEAR(placeOf(taken).y(), end + speed * kExtrapolate / 2, 1e-6);
    EXPECT_NEAR(taken.shown.poses[0].rotation.angularDistance(
                    straight(seconds(last * kStep) + kExtrapolate / 2).rotation),
                0, 1e-5);
  }
}

TEST(PoseTrack, AHeadThatTurnsAboutItsNeckStaysOnItWithoutSamples) {
  const Vec3 neck(100, 1.6f, -50);
  const auto turned = [&](double t) {
    const Quat rotation(Eigen::AngleAxisf(static_cast<float>(6 * t), Vec3(Vec3::UnitX())));
    return Pose{neck - rotation * neck, rotation};
  };
  PoseTrack track = trackOf(neck);
  for (uint32_t i = 0; i < 10; ++i) track.add(sampleOf(i, i * kStep, turned));
  for (int step = 0; step < 30; ++step) {
    const Pose pose = track.advance(step * kStep + kStep / 2, kStep).shown.poses[0];
    EXPECT_LT((pose.apply(neck) - neck).norm(), 1e-4f) << step;
  }
}

TEST(PoseTrack, RejoinsWithoutAJumpAndEndsOnTheMotion) {
  const double fastest = 2 * EIGEN_PI * 2 * 0.1 * seconds(kStep);  // m in a step
  for (int gap = 1; gap <= 200; ++gap) {
    const int64_t lost = 40, found = lost + gap;
    PoseTrack track = trackOf();
    Vec3 before = Vec3::Zero();
    double error = 0, longest = 0;
    int64_t rejoined = 0;
    for (int64_t step = 0; step < found + 70; ++step) {
      const Vec3 truth = shaken(seconds(step * kStep)).position;
      const Vec3 last_truth = shaken(seconds((step - 1) * kStep)).position;
      if (step < lost || step >= found) track.add(sampleOf(static_cast<uint32_t>(step), step * kStep));
      const PoseTrack::Step& taken = track.advance(step * kStep, kStep);
      ASSERT_FALSE(taken.is_cut);
      if (step == found) {
        error = std::max((before - last_truth).norm(), (before - truth).norm());
        longest = std::max({std::min(gap, 15), 7, static_cast<int>(std::ceil(error / 2 / seconds(kStep)))});
      }
      if (step >= found && rejoined == 0) {
        // What the motion did in the gap is not known, only that it was not faster.
        const double own = step == found ? fastest : (truth - last_truth).norm();
        const double offset_speed = std::min(error / std::clamp(gap, 2, 15), 2 * seconds(kStep));
        ASSERT_LE((placeOf(taken) - before).norm(), own + 1.9 * offset_speed + 1e-6) << gap << ' ' << step;
        if (taken.state == PoseState::kLive) rejoined = step;
      }
      if (rejoined > 0) {
        ASSERT_EQ(placeOf(taken), truth) << gap << ' ' << step;
      }
      before = placeOf(taken);
    }
    ASSERT_GT(rejoined, 0) << gap;
    EXPECT_LE(static_cast<double>(rejoined - found), longest) << gap;
  }
}

TEST(PoseTrack, FollowsSamplesThatAllComeLate) {
  PoseTrack track = trackOf();
  Vec3 before = shaken(0).position;
  for (int64_t step = 0; step < 300; ++step) {
    if (step < 60) track.add(sampleOf(static_cast<uint32_t>(step), step * kStep));
    // From now on each comes two steps after its own.
    if (step >= 62) track.add(sampleOf(static_cast<uint32_t>(step - 2), (step - 2) * kStep));
    const PoseTrack::Step& taken = track.advance(step * kStep, kStep);
    if (step > 62) {
      EXPECT_EQ(taken.state, PoseState::kExtrapolating);
    }
    const Vec3 truth = shaken(seconds(step * kStep)).position;
    ASSERT_LT((placeOf(taken) - truth).norm(), 0.025f) << step;
    ASSERT_LT((placeOf(taken) - before).norm(), 0.032f) << "1.5 times the fastest true motion";
    before = placeOf(taken);
  }
}

TEST(PoseTrack, AnEpochAndAnImpossibleSpeedAreCutsAtTheirStep) {
  for (const bool is_epoch : {true, false}) {
    PoseTrack track = trackOf();
    for (uint32_t i = 0; i < 60; ++i) {
      PoseSample sample = sampleOf(i, 2 * i * kStep);
      sample.epoch = is_epoch && i >= 30 ? 8 : 7;
      if (i >= 30) sample.poses[0].position.y() += is_epoch ? 0.01f : 1.2f;
      track.add(sample);
    }
    for (int step = 0; step < 110; ++step) {
      const PoseTrack::Step& taken = track.advance(step * kStep, kStep);
      ASSERT_EQ(taken.is_cut, step == 60) << step;
      ASSERT_EQ(placeOf(taken).y() > 0.005f, step >= 60) << "nothing is interpolated across a cut";
      ASSERT_EQ(taken.state == PoseState::kExtrapolating, step == 59) << "nor is it known there";
    }
  }
}

TEST(PoseTrack, ADifferenceTooLargeToVanishIsACut) {
  for (const float far : {1.9f, 2.1f}) {
    PoseTrack track = trackOf();
    const auto at = [&](uint32_t i, float x) {
      return sampleOf(i, i * kStep, [x](double) { return Pose{Vec3(x, 0, 0), Quat::Identity()}; });
    };
    for (uint32_t i = 0; i < 10; ++i) track.add(at(i, 0));
    int cuts = 0;
    for (uint32_t step = 0; step < 200; ++step) {
      if (step >= 100) track.add(at(step, far));
      cuts += track.advance(step * kStep, kStep).is_cut;
    }
    EXPECT_EQ(cuts, far > 2 ? 1 : 0);
  }
}

TEST(PoseTrack, StepsWhoseTimesJumpRejoinAndThenAreAsWithoutTheJump) {
  const int64_t period = 2 * kStep;
  for (const int64_t jump : {-15 * kStep, -kStep / 3, kStep / 3, kStep, 120 * kStep}) {
    PoseTrack track = trackOf(), straight = trackOf();
    for (uint32_t i = 0; i < 160; ++i) {
      track.add(sampleOf(i, i * period));
      straight.add(sampleOf(i, i * period));
    }
    for (int step = 0; step < 100; ++step) track.advance(step * kStep, kStep);
    Vec3 before = shaken(seconds(99 * kStep)).position;
    int rejoining = 0;
    for (int step = 100; step < 190; ++step) {
      const int64_t time = step * kStep + jump;
      const PoseTrack::Step &taken = track.advance(time, kStep), &expected = straight.advance(time, kStep);
      ASSERT_FALSE(taken.is_cut);
      rejoining += taken.state == PoseState::kRejoining;
      EXPECT_EQ(taken.state == PoseState::kRejoining, rejoining == step - 99) << "once, from the jump on";
      if (taken.state == PoseState::kLive) {
        ASSERT_TRUE(areEqual(taken.shown, expected.shown)) << jump << ' ' << step;
      }
      // The motion's own 21 mm in a step, and 1.9 times the offset's mean speed of 2 m/s.
      ASSERT_LT((placeOf(taken) - before).norm(), 0.021f + 1.9f * 2 * 0.0167f) << jump << ' ' << step;
      before = placeOf(taken);
    }
    EXPECT_GE(rejoining, 1) << jump;
    EXPECT_LE(rejoining, 15) << jump;
    EXPECT_EQ(track.add(sampleOf(1000, 150 * kStep + jump + 1)), PoseTrack::Arrival::kLate);
  }
}

TEST(PoseTrack, ASetClockLeavesItsPosesBehindAndRejoins) {
  PoseTrack track = trackOf();
  for (uint32_t i = 0; i < 60; ++i) track.add(sampleOf(i, 3600 * kNsPerSecond + i * kStep));
  for (int i = 0; i < 60; ++i) track.advance(3600 * kNsPerSecond + i * kStep, kStep);
  const Vec3 before = shaken(seconds(3600 * kNsPerSecond + 59 * kStep)).position;
  track.forget();
  EXPECT_EQ(track.advance(3600 * kNsPerSecond + 60 * kStep, kStep).state, PoseState::kResting);
  for (uint32_t i = 0; i < 60; ++i)
    EXPECT_EQ(track.add(sampleOf(100 + i, i * kStep)), PoseTrack::Arrival::kNew);
  const PoseTrack::Step& first = track.advance(0, kStep);
  EXPECT_EQ(first.state, PoseState::kRejoining);
  EXPECT_LT((placeOf(first) - before).norm(), 0.05f);
  EXPECT_EQ(track.advance(50 * kStep, kStep).state, PoseState::kRejoining) << "the step's time jumps";
}

TEST(PoseTrack, ASetClockOfANewEpochIsACut) {
  PoseTrack track = trackOf();
  track.add(sampleOf(0, 3600 * kNsPerSecond));
  EXPECT_FALSE(track.advance(3600 * kNsPerSecond, kStep).is_cut);
  track.forget();
  PoseSample sample = sampleOf(1, kStep);
  sample.epoch = 1;
  track.add(sample);
  const PoseTrack::Step& taken = track.advance(kStep, kStep);
  EXPECT_TRUE(taken.is_cut);
  EXPECT_EQ(taken.state, PoseState::kLive);
  EXPECT_TRUE(areEqual(taken.shown, sample));
}

TEST(PoseTrack, InterpolatesAShakeWithinFiveMicrometres) {
  PoseTrack track = trackOf();
  float worst = 0, worst_turn = 0;
  for (uint32_t i = 0; i < 200; ++i) track.add(sampleOf(i, i * kStep));
  for (int64_t step = 5; step < 198; ++step) {
    const int64_t time = step * kStep + kStep / 2;
    const PoseTrack::Step& taken = track.advance(time, kStep);
    ASSERT_FALSE(taken.is_exact);
    worst = std::max(worst, (placeOf(taken) - shaken(seconds(time)).position).norm());
    worst_turn =
        std::max(worst_turn, taken.shown.poses[0].rotation.angularDistance(shaken(seconds(time)).rotation));
  }
  EXPECT_LT(worst, 5e-6f);
  EXPECT_LT(worst_turn, 15e-6f);
}

TEST(PoseTrack, InterpolatesScalesAndWeightsAndHoldsThemWithoutSamples) {
  PoseTrack track({.pivots = {Vec3::Zero(), Vec3::UnitY()}, .has_scales = true, .weights = 2, .carrier = {}});
  for (uint32_t i = 0; i < 10; ++i) {
    const auto x = static_cast<float>(i);
    track.add({.number = i,
               .time_ns = i * kStep,
               .poses = std::vector<Pose>(2),
               .scales = {Vec3(1 + x, 1, 1), Vec3::Ones()},
               .weights = {-x, 0.5f}});
  }
  const PoseTrack::Step* taken = &track.advance(5 * kStep + kStep / 2, kStep);
  EXPECT_NEAR(taken->shown.scales[0].x(), 6.5f, 1e-5f);
  EXPECT_NEAR(taken->shown.weights[0], -5.5f, 1e-5f);
  EXPECT_EQ(taken->shown.weights[1], 0.5f);
  for (int step = 6; step < 20; ++step) taken = &track.advance(step * kStep, kStep);
  EXPECT_EQ(taken->state, PoseState::kResting);
  EXPECT_EQ(taken->shown.scales[0].x(), 10);
  EXPECT_EQ(taken->shown.weights[0], -9);
}

TEST(PoseTrack, AllocatesNothingAndKeepsABoundedNumberOfSamples) {
  PoseTrack track(
      {.pivots = std::vector<Vec3>(3, Vec3::UnitY()), .has_scales = true, .weights = 5, .carrier = {}});
  PoseSample sample = {.poses = std::vector<Pose>(3),
                       .scales = std::vector<Vec3>(3, Vec3::Ones()),
                       .weights = std::vector<float>(5)};
  const uint32_t count = thorough() ? 10'000'000 : 300'000;
  const uint64_t before = allocations();
  for (uint32_t i = 0; i < count; ++i) {
    sample.number = i;
    sample.time_ns = i * kNsPerMillisecond;
    sample.epoch = i / 40'000;
    sample.poses[0].position.x() = static_cast<float>(std::sin(0.001 * i));
    if (i % 1000 > 700 || i % 7 == 3) continue;  // losses and silence
    track.add(sample);
    if (i % 17 == 0) track.advance((int64_t{i} - 30) * kNsPerMillisecond, kStep);
  }
  EXPECT_EQ(allocations(), before);
  ASSERT_TRUE(track.nearest(0));
  EXPECT_GT(*track.nearest(0), (int64_t{count} - 2000) * kNsPerMillisecond) << "the oldest go";
}

TEST(PoseTrack, TwoSamplesAloneAreInterpolatedLinearly) {
  PoseTrack track = trackOf();
  const auto straight = [](double t) { return Pose{Vec3(static_cast<float>(t), 0, 0), Quat::Identity()}; };
  track.add(sampleOf(0, 0, straight));
  track.add(sampleOf(1, 4 * kStep, straight));
  for (int step = 0; step < 4; ++step)
    EXPECT_NEAR(placeOf(track.advance(step * kStep, kStep)).x(), seconds(step * kStep), 1e-7);
}

/// A sender whose messages repeat the two samples before the newest, and whose clock is 80 ppm slow.
struct Stream {
  int64_t period = kStep;
  int64_t jitter = 0;      ///< ns, greatest delay
  double loss = 0;         ///< share of messages
  bool is_silent = false;  ///< for 3 s and 7 s

  int64_t sentAt(uint32_t number) const { return number * period; }
  int64_t senderTime(uint32_t number) const {
    return 7 * kNsPerSecond + std::llround(static_cast<double>(sentAt(number)) * (1 + 80e-6));
  }
  bool isSilentAt(uint32_t number) const {
    const double t = seconds(sentAt(number));
    return is_silent && ((t > 30 && t < 33) || (t > 60 && t < 67));
  }
};

/// Steps of a run by what they took.
struct Steps {
  int all = 0, exact = 0, interpolated = 0, extrapolated = 0, rested = 0, locks = 0;
};

/// 110 s of a daemon at 60 Hz with clock, lock, track and pacer, after 10 s.
Steps takeStream(const Stream& stream) {
  using Time = FramePacer::Clock::time_point;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> chance(0, 1);
  PoseTrack track = trackOf();
  PoseClock clock;
  PoseLock lock;
  FramePacer pacer(60, Time(std::chrono::seconds(1)));
  std::multimap<int64_t, uint32_t> on_the_way;  ///< numbers of newest samples by arrival
  int64_t now = kNsPerSecond, simulated = 0;
  uint32_t sent = 0;
  bool has_rested = false;
  Vec3 before = Vec3::Zero();
  Steps steps;
  while (now < 120 * kNsPerSecond) {
    for (; stream.sentAt(sent) <= now; ++sent) {
      const double delay = chance(random) * static_cast<double>(stream.jitter);
      if (!stream.isSilentAt(sent) && chance(random) >= stream.loss)
        on_the_way.emplace(stream.sentAt(sent) + static_cast<int64_t>(delay), sent);
    }
    simulated += kStep;
    for (; !on_the_way.empty() && on_the_way.begin()->first <= now; on_the_way.erase(on_the_way.begin())) {
      const auto [arrival, newest] = *on_the_way.begin();
      EXPECT_TRUE(lock.arrive(stream.senderTime(newest), false, arrival, simulated));
      for (uint32_t number = newest < 2 ? 0 : newest - 2; number <= newest; ++number) {
        if (stream.isSilentAt(number)) continue;
        if (track.add(sampleOf(number, stream.senderTime(number))) != PoseTrack::Arrival::kRepeated)
          clock.arrive(stream.senderTime(number), arrival);
      }
    }
    steps.locks += lock.lockIfDue(simulated);
    if (has_rested && track.nearest(lock.timeOf(simulated)))
      lock.takePhase(lock.timeOf(simulated) - *track.nearest(lock.timeOf(simulated)), kStep);
    const PoseTrack::Step& taken = track.advance(lock.timeOf(simulated), kStep);
    has_rested = taken.state == PoseState::kResting;
    if (taken.is_exact) lock.followPhase(lock.timeOf(simulated) - taken.shown.time_ns, kStep);
    EXPECT_FALSE(taken.is_cut);
    EXPECT_LT((placeOf(taken) - before).norm(), 0.06f) << "2.5 times the fastest true motion";
    before = placeOf(taken);
    if (now > 10 * kNsPerSecond) {
      ++steps.all;
      steps.exact += taken.is_exact;
      steps.extrapolated += taken.state == PoseState::kExtrapolating;
      steps.rested += taken.state == PoseState::kResting;
    }
    const int64_t wait = stream.period > kStep ? stream.period : 0;  // where steps are between samples
    const int64_t wanted = clock.wallOf(lock.timeOf(simulated + kStep), wait, kNsPerSecond / 4);
    const Time due = pacer.next(Time(std::chrono::nanoseconds(now)), Time(std::chrono::nanoseconds(wanted)));
    now = due.time_since_epoch().count();
  }
  steps.interpolated = steps.all - steps.exact - steps.extrapolated - steps.rested;
  return steps;
}

TEST(PoseTrack, AStreamWithJitterLossesAndSilencesIsTakenAlmostAlwaysExactly) {
  for (const int64_t jitter : {0, 5, 20, 50}) {
    const double loss = jitter < 20 ? 0 : 0.01;
    const Steps steps = takeStream({.jitter = jitter * kNsPerMillisecond, .loss = loss});
    EXPECT_EQ(steps.locks, 1);
    EXPECT_GE(steps.exact, steps.all - (loss > 0 ? steps.all / 200 : 0)) << jitter << " ms";
    EXPECT_EQ(steps.rested, 0);
  }
  const Steps silent = takeStream({.jitter = 50 * kNsPerMillisecond, .loss = 0.01, .is_silent = true});
  EXPECT_EQ(silent.locks, 1);
  EXPECT_GE(silent.exact, silent.all - silent.rested - silent.all / 200);
  EXPECT_LE(silent.rested, 10 * 60);
  const Steps slow = takeStream({.period = 2 * kStep, .jitter = 50 * kNsPerMillisecond, .loss = 0.01});
  EXPECT_EQ(slow.locks, 1);
  EXPECT_NEAR(slow.exact, slow.all / 2, slow.all / 200);
  EXPECT_NEAR(slow.interpolated, slow.all / 2, slow.all / 200);
}

}  // namespace
}  // namespace strandcast
