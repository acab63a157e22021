// Who takes more than its share waits: the rule alone, on a clock of the test.
#include "service/rate_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "service/frame_pacer.h"

namespace strandcast {
namespace {

using Time = StagePressure::Clock::time_point;

/// `ms` after an hour: the clock's epoch stands for never.
Time at(double ms) {
  return Time(std::chrono::hours(1)) + std::chrono::duration_cast<StagePressure::Clock::duration>(
                                           std::chrono::duration<double, std::milli>(ms));
}

constexpr double kRate = 100, kInterval = 10;  // frames/s, ms

TEST(RateBudget, ChangesNothingWithoutPressure) {
  StagePressure pressure;
  RateBudget heavy(2, kRate, pressure);
  EXPECT_EQ(heavy.addFrame(50, true, at(0)), 1) << "it is late because of itself";
  EXPECT_EQ(heavy.addFrame(50, true, at(60)), 1);
  EXPECT_EQ(pressure.at(at(60)), 0);
}

TEST(RateBudget, WhoIsAboveItsBudgetWaitsOnceAnotherWasLate) {
  StagePressure pressure;
  RateBudget heavy(2, kRate, pressure), light(2, kRate, pressure);
  EXPECT_EQ(heavy.addFrame(8, false, at(0)), 1);
  EXPECT_EQ(light.addFrame(1, true, at(10)), 1) << "it keeps its budget";
  EXPECT_DOUBLE_EQ(heavy.addFrame(8, false, at(20)), 4);
  EXPECT_DOUBLE_EQ(heavy.addFrame(8, false, at(1000)), 4);
}

TEST(RateBudget, ThePaceReturnsSlowlyWhileNobodyIsLate) {
  StagePressure pressure;
  RateBudget heavy(2, kRate, pressure), light(2, kRate, pressure);
  light.addFrame(1, true, at(0));
  double before = 5;
  for (double ms = 1000; ms <= 10000; ms += 500) {
    const double slowdown = heavy.addFrame(8, false, at(ms));
    EXPECT_LE(slowdown, before);
    before = slowdown;
    if (ms == 5500) {
      EXPECT_NEAR(slowdown, 2.5, 1e-9);
    }
  }
  EXPECT_EQ(before, 1);
  light.addFrame(1, true, at(11000));
  EXPECT_DOUBLE_EQ(heavy.addFrame(8, false, at(11001)), 4);
}

TEST(RateBudget, TheCostIsTheMeanOfTheLastFrames) {
  StagePressure pressure;
  pressure.addLateFrame(at(0));
  RateBudget budget(2, kRate, pressure);
  EXPECT_EQ(budget.cost(), 0);
  budget.addFrame(6, false, at(1));
  EXPECT_DOUBLE_EQ(budget.addFrame(2, false, at(2)), 2) << "4 ms of 2";
  for (size_t i = 0; i < RateBudget::kFrames; ++i) budget.addFrame(1, false, at(3));
  EXPECT_DOUBLE_EQ(budget.cost(), 1);
}

TEST(RateBudget, WhoseFramesTakeLongerThanTheirIntervalIsNoMeasureOfTheOthers) {
  StagePressure pressure;
  RateBudget generous(50, kRate, pressure);  // a budget above the interval
  generous.addFrame(20, true, at(0));
  EXPECT_EQ(pressure.at(at(1)), 0);
}

TEST(RateBudget, NoIntervalGetsLongerThanHalfASecond) {
  StagePressure pressure;
  pressure.addLateFrame(at(0));
  RateBudget huge(1, kRate, pressure), rare(1, 1, pressure);
  EXPECT_DOUBLE_EQ(huge.addFrame(400, false, at(1)), RateBudget::kLongestInterval / kInterval);
  EXPECT_EQ(rare.addFrame(400, false, at(1)), 1) << "a frame a second was asked for";
}

/// Characters on `cores` processors that are shared evenly among the threads that have work (processor
/// sharing), as a fair scheduler does.
struct Actor {
  double cost;     ///< ms of processor time of a frame, all threads together
  double threads;  ///< that work on a frame at once
  FramePacer pacer;
  RateBudget budget;
  double left;     ///< ms of the present frame
  double due = 0;  ///< ms
  int frames = 0;
};

/// Simulates `seconds`. Returns the actors.
std::vector<Actor> cast(double heavy_threads, bool has_budgets, double seconds) {
  constexpr double kCores = 2, kTick = 0.05, kBudget = kInterval / (10 / kCores);
  StagePressure pressure;
  std::vector<Actor> actors;
  for (int i = 0; i < 10; ++i) {
    const double threads = i == 0 ? heavy_threads : 1, cost = i == 0 ? 100.0 : 1.5;
    actors.push_back(
        {cost, threads, FramePacer(kRate, at(0)), RateBudget(kBudget / threads, kRate, pressure), cost});
  }
  for (double now = 0; now < 1000 * seconds; now += kTick) {
    double working = 0;
    for (const Actor& actor : actors) working += now >= actor.due ? actor.threads : 0;
    const double share = std::min(1.0, kCores / std::max(working, 1.0)) * kTick;  // of a thread
    for (Actor& actor : actors) {
      if (now < actor.due) continue;
      actor.left -= share * actor.threads;
      if (actor.left > 0) continue;
      ++actor.frames;
      actor.left = actor.cost;
      actor.due = std::chrono::duration<double, std::milli>(actor.pacer.next(at(now)) - at(0)).count();
      if (has_budgets)
        actor.pacer.setSlowdown(
            actor.budget.addFrame(actor.cost / actor.threads, actor.pacer.isLate(), at(now)));
    }
  }
  return actors;
}

TEST(RateBudget, OneHeavyHeadDoesNotSlowNineLightOnes) {
  const std::vector<Actor> with = cast(1, true, 20), without = cast(1, false, 20);
  for (size_t i = 1; i < with.size(); ++i) EXPECT_EQ(with[i].pacer.lateFrames(), 0u);
  EXPECT_EQ(with[0].frames, without[0].frames) << "who disturbs nobody keeps its pace";
}

TEST(RateBudget, AHeavyHeadOfManyThreadsTakesLittleOfNineLightOnes) {
  constexpr double kSeconds = 60;
  const std::vector<Actor> with = cast(8, true, kSeconds), without = cast(8, false, kSeconds);
  for (size_t i = 1; i < with.size(); ++i) {
    EXPECT_GE(with[i].frames, 0.95 * kSeconds * kRate) << i << ": late only beside a frame of the heavy head";
    EXPECT_LE(without[i].frames, 0.8 * kSeconds * kRate) << i;
  }
  EXPECT_GT(with[0].frames, kSeconds * 1.5) << "the heavy head goes on";
  EXPECT_LT(with[0].frames, without[0].frames / 2);
}

TEST(FramePacer, ASlowerPaceIsNotLate) {
  FramePacer pacer(kRate, at(0));
  EXPECT_EQ(pacer.next(at(4)), at(10));
  pacer.setSlowdown(3);
  EXPECT_EQ(pacer.next(at(25)), at(40));
  EXPECT_FALSE(pacer.isLate());
  EXPECT_FALSE(pacer.isTooSlow());
  EXPECT_EQ(pacer.next(at(41), at(-200)), at(70) - std::chrono::microseconds(200)) << "2 % nearer";
  EXPECT_TRUE(pacer.isTooSlow()) << "the poses for it were here 269.8 ms before";
  pacer.setSlowdown(1);
  EXPECT_EQ(pacer.next(at(71)), at(80) - std::chrono::microseconds(200));
  EXPECT_EQ(pacer.lateFrames(), 0u);
}

}  // namespace
}  // namespace strandcast
