// The clocks of a live source of poses, and the pace of frames that follows them.
#include "service/pose_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>

#include "service/frame_pacer.h"

namespace strandcast {
namespace {

constexpr int64_t kInterval = 16'666'667;  ///< ns, of 60 Hz

int64_t nanoseconds(double seconds) { return std::llround(1e9 * seconds); }

TEST(PoseClock, FollowsADriftOf200PpmWithinTwoMilliseconds) {
  for (const double drift : {200e-6, -200e-6}) {
    PoseClock clock;
    for (int64_t sent = 5 * kNsPerSecond; sent < 600 * kNsPerSecond; sent += kInterval) {
      const int64_t sender =
          1000 * kNsPerSecond + nanoseconds(1e-9 * static_cast<double>(sent) * (1 + drift));
      clock.arrive(sender, sent + kNsPerMillisecond);
      ASSERT_LE(std::abs(clock.offset() - (sent + kNsPerMillisecond - sender)), 2 * kNsPerMillisecond)
          << drift;
      ASSERT_LE(clock.lateness(), 2 * kNsPerMillisecond) << drift;
    }
  }
}

TEST(PoseClock, RemembersTheGreatestLatenessForTenSeconds) {
  std::mt19937 random(1);
  PoseClock clock;
  const auto lastLatenessAfter = [&](int64_t from, int64_t until, int64_t jitter) {
    std::uniform_int_distribution<int64_t> delay(0, jitter);
    for (int64_t sent = from; sent < until; sent += kInterval)
      clock.arrive(sent, sent + kNsPerSecond + delay(random));
    return clock.lateness();
  };
  EXPECT_LE(lastLatenessAfter(0, 20 * kNsPerSecond, kNsPerMillisecond), kNsPerMillisecond);
  EXPECT_NEAR(
      static_cast<double>(lastLatenessAfter(20 * kNsPerSecond, 30 * kNsPerSecond, 50 * kNsPerMillisecond)),
      50e6, 5e6);
  EXPECT_NEAR(static_cast<double>(lastLatenessAfter(30 * kNsPerSecond, 38 * kNsPerSecond, kNsPerMillisecond)),
              50e6, 5e6);
  EXPECT_LE(lastLatenessAfter(38 * kNsPerSecond, 41 * kNsPerSecond, kNsPerMillisecond), kNsPerMillisecond);
  EXPECT_GE(clock.offset(), kNsPerSecond);
  EXPECT_LE(clock.offset(), kNsPerSecond + kNsPerMillisecond);

  EXPECT_EQ(clock.wallOf(7, 5, kNsPerSecond), 7 + clock.offset() + clock.lateness() + kNsPerMillisecond + 5);
  EXPECT_EQ(clock.wallOf(7, 5, 100), 7 + clock.offset() + 100) << "never longer than is allowed";
}

TEST(PoseClock, KeepsItsOffsetInSilenceAndForgetsItWithTheNextArrival) {
  PoseClock clock;
  EXPECT_EQ(clock.offset(), 0);
  clock.arrive(100, 1100);
  EXPECT_EQ(clock.offset(), 1000);
  clock.arrive(100 + 12 * kNsPerSecond, 12 * kNsPerSecond + 5100);
  EXPECT_EQ(clock.offset(), 5000) << "older arrivals are beyond ten seconds";
  EXPECT_EQ(clock.lateness(), 0);
  clock.restart();
  clock.arrive(3600 * kNsPerSecond, 13 * kNsPerSecond);
  EXPECT_EQ(clock.offset(), -3587 * kNsPerSecond) << "arrivals before a restart do not count";
}

/// A daemon at 60 Hz that takes each message at once, and a sender whose clock the test sets.
class PoseLocks : public ::testing::Test {
 protected:
  /// A step; the sender has sent a message since the step before, unless it is silent.
  void step(bool is_silent = false, bool is_new_epoch = false) {
    now_ += kInterval;
    sender_ += kInterval;
    was_near_ = is_silent || lock_.arrive(sender_, is_new_epoch, now_, now_);
    if (!lock_.lockIfDue(now_)) return;
    EXPECT_GE(now_ - locked_at_, kNsPerSecond / 2);
    ++locks_;
    locked_at_ = now_;
    EXPECT_FALSE(is_silent);
    EXPECT_EQ(lock_.timeOf(now_), sender_) << "the step takes the newest sample";
  }
  void steps(int count, bool is_silent = false) {
    for (int i = 0; i < count; ++i) step(is_silent);
  }

  PoseLock lock_;
  int64_t now_ = 100 * kNsPerSecond, sender_ = 7 * kNsPerSecond, locked_at_ = 0;
  bool was_near_ = false;
  int locks_ = 0;
};

TEST_F(PoseLocks, LockOnceWhileTheSenderGoesOn) {
  steps(30, true);
  EXPECT_FALSE(lock_.isLocked());
  steps(1000);
  steps(300, true);
  steps(100);
  EXPECT_EQ(locks_, 1);
}

TEST_F(PoseLocks, FollowAClockThatIsSetAfterEightMessages) {
  for (const int64_t change : {-3600 * kNsPerSecond, 3600 * kNsPerSecond, kNsPerSecond, -kNsPerSecond}) {
    steps(100);
    sender_ += change;
    const int before = locks_;
    steps(7);
    EXPECT_FALSE(was_near_);
    EXPECT_EQ(locks_, before);
    steps(1);
    EXPECT_EQ(locks_, before + 1);
    steps(100);
    EXPECT_TRUE(was_near_);
    EXPECT_EQ(locks_, before + 1);
    sender_ = 7000 * kNsPerSecond;
    steps(50);
  }
}

TEST_F(PoseLocks, FollowASenderWhoseClockStoodWhileItPaused) {
  steps(100);
  for (int i = 0; i < 600; ++i) {
    sender_ -= kInterval;
    step(true);
  }
  EXPECT_EQ(locks_, 1) << "nothing locks in silence";
  steps(20);
  EXPECT_EQ(locks_, 2);
}

TEST_F(PoseLocks, LockAtOnceWithANewEpochOfAFarClockOnly) {
  steps(100);
  step(false, true);
  EXPECT_EQ(locks_, 1) << "a jump of the motion alone";
  sender_ -= 3600 * kNsPerSecond;
  step(false, true);
  EXPECT_EQ(locks_, 2);
}

TEST_F(PoseLocks, LockAtMostTwiceASecond) {
  for (int i = 0; i < 600; ++i) {
    sender_ += 10 * kNsPerSecond;
    step(false, true);
    lock_.release();
  }
  EXPECT_GE(locks_, 15);
  EXPECT_LE(locks_, 20);
}

TEST_F(PoseLocks, KeepTheirDelayUntilAnArrivalAfterARelease) {
  steps(100);
  const int64_t delay = now_ - lock_.timeOf(now_);
  sender_ += kNsPerSecond / 4;
  lock_.release();
  steps(5, true);
  EXPECT_TRUE(lock_.isLocked());
  EXPECT_EQ(now_ - lock_.timeOf(now_), delay);
  steps(1);
  EXPECT_EQ(now_ - lock_.timeOf(now_), delay - kNsPerSecond / 4);
}

TEST_F(PoseLocks, KeepTheTimelineOfASenderThatWentOnMeanwhile) {
  steps(100);
  EXPECT_TRUE(lock_.beganTimeline()) << "the first";
  lock_.release();
  steps(1);
  EXPECT_EQ(locks_, 2);
  EXPECT_FALSE(lock_.beganTimeline());
  // The daemon's clock of steps stands for 10 s.
  const int64_t end = now_;
  for (int i = 0; i < 600; ++i) {
    now_ += kInterval;
    sender_ += kInterval;
    EXPECT_TRUE(lock_.arrive(sender_, false, now_, end)) << i;
    lock_.release();
  }
  EXPECT_TRUE(lock_.lockIfDue(end));
  EXPECT_EQ(lock_.timeOf(end), sender_);
  EXPECT_FALSE(lock_.beganTimeline());
}

TEST_F(PoseLocks, BeginATimelineWhereTheSendersClockWasSet) {
  for (const int64_t change : {-3600 * kNsPerSecond, kNsPerSecond}) {
    for (const bool is_released : {false, true}) {
      steps(100);
      sender_ += change;
      if (is_released) lock_.release();
      const int before = locks_;
      for (int i = 0; i < 8 && locks_ == before; ++i) {
        step();
        EXPECT_FALSE(was_near_);
      }
      EXPECT_EQ(locks_, before + 1);
      EXPECT_TRUE(lock_.beganTimeline());
    }
  }
}

TEST_F(PoseLocks, TakeAPhaseSlowlyOrWithinHalfAStepAtOnce) {
  steps(1);
  const int64_t time = lock_.timeOf(now_);
  lock_.followPhase(1000, kInterval);
  EXPECT_EQ(lock_.timeOf(now_), time - 1000);
  lock_.followPhase(-kNsPerMillisecond, kInterval);
  EXPECT_EQ(lock_.timeOf(now_), time - 1000 + kInterval / 200);
  lock_.takePhase(kInterval, kInterval);
  EXPECT_EQ(lock_.timeOf(now_), time - 1000 + kInterval / 200) << "too far";
  lock_.takePhase(5 * kNsPerMillisecond, kInterval);
  EXPECT_EQ(lock_.timeOf(now_), time - 1000 + kInterval / 200 - 5 * kNsPerMillisecond);
}

using Wall = FramePacer::Clock::time_point;
using std::chrono::milliseconds;

Wall wall(int64_t ns) { return Wall(std::chrono::nanoseconds(ns)); }

TEST(FramePacer, KeepsTheIntervalAndBeginsAnewAfterALateFrame) {
  const Wall start = wall(kNsPerSecond);
  FramePacer pacer(100, start);
  EXPECT_EQ(pacer.next(start + milliseconds(3)), start + milliseconds(10));
  EXPECT_EQ(pacer.next(start + milliseconds(20)), start + milliseconds(20)) << "just in time";
  EXPECT_EQ(pacer.lateFrames(), 0u);
  EXPECT_EQ(pacer.next(start + milliseconds(34)), start + milliseconds(34));
  EXPECT_EQ(pacer.lateFrames(), 1u);
  EXPECT_EQ(pacer.next(start + milliseconds(35)), start + milliseconds(44));
  EXPECT_EQ(pacer.next(start + std::chrono::seconds(9)), start + std::chrono::seconds(9));
  EXPECT_EQ(pacer.lateFrames(), 2u);
  EXPECT_FALSE(pacer.isTooSlow()) << "nothing waits";
}

TEST(FramePacer, IsTooSlowWhereALateFrameIsFarBehindItsPoses) {
  FramePacer pacer(100, wall(kNsPerSecond));
  int64_t now = kNsPerSecond;
  const auto behind = [&](int64_t ns, int64_t work) {
    now += work;
    const Wall due = pacer.next(wall(now), wall(now - ns));
    now = std::max(now, due.time_since_epoch().count());
    return pacer.isTooSlow();
  };
  EXPECT_FALSE(behind(240 * kNsPerMillisecond, 12 * kNsPerMillisecond));
  EXPECT_TRUE(behind(260 * kNsPerMillisecond, 12 * kNsPerMillisecond));
  EXPECT_FALSE(behind(260 * kNsPerMillisecond, kNsPerMillisecond)) << "a frame in time catches up by itself";
}

/// The loop of a daemon at 60 Hz over a sender at 60 Hz, whose samples travel for up to 1 ms, then up to 50
/// ms, then up to 1 ms.
TEST(FramePacer, FollowsTheSendersClockByTwoPercentOfTheIntervalAtMost) {
  for (const double drift : {200e-6, -200e-6}) {
    std::mt19937 random(3);
    PoseClock clock;
    PoseLock lock;
    FramePacer pacer(60, wall(kNsPerSecond));
    std::map<int64_t, int64_t> on_the_way;  ///< sender's time by arrival
    int64_t now = kNsPerSecond, simulated = 0, sent = 0;
    int steps = 0, hasty_steps = 0;
    while (now < 120 * kNsPerSecond) {
      const bool is_rough = now > 40 * kNsPerSecond && now < 80 * kNsPerSecond;
      std::uniform_int_distribution<int64_t> delay(0, (is_rough ? 50 : 1) * kNsPerMillisecond);
      for (; sent <= now; sent += kInterval)
        on_the_way[sent + delay(random)] = nanoseconds(1e-9 * static_cast<double>(sent) * (1 + drift));
      simulated += kInterval;
      for (; !on_the_way.empty() && on_the_way.begin()->first <= now; on_the_way.erase(on_the_way.begin())) {
        const auto [arrival, time] = *on_the_way.begin();
        EXPECT_TRUE(lock.arrive(time, false, arrival, simulated));
        clock.arrive(time, arrival);
      }
      lock.lockIfDue(simulated);
      const int64_t wanted = clock.wallOf(lock.timeOf(simulated + kInterval), 0, kNsPerSecond / 4);
      const int64_t due = pacer.next(wall(now), wall(wanted)).time_since_epoch().count();
      ASSERT_LE(std::abs(due - now - kInterval), kInterval / 50 + 1);
      now = due;
      // 2 % of the interval are 50 ms after 2.5 s. The lateness is forgotten after 10 s.
      if (now < 5 * kNsPerSecond || (now > 40 * kNsPerSecond && now < 45 * kNsPerSecond)) continue;
      const bool is_lateness_kept = now > 40 * kNsPerSecond && now < 95 * kNsPerSecond;
      ++steps;
      hasty_steps += wanted - now > kNsPerMillisecond;
      ASSERT_LE(now - wanted, (is_lateness_kept ? 60 : 3) * kNsPerMillisecond) << now;
    }
    EXPECT_GT(steps, 6000);
    EXPECT_LE(hasty_steps, steps / 1000) << "frames wait for their poses";
    EXPECT_EQ(pacer.lateFrames(), 0u);
  }
}

}  // namespace
}  // namespace strandcast
