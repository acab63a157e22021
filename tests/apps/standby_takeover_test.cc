// Daemons that share a groom, as real processes: readers see one continuous show, whichever daemon casts.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/apps/program_fixture.h"
#include "tests/transport/dds_domain.h"
#include "transport/dds.h"
#include "transport/parameter_table.h"
#include "transport/subscriber.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// A reader that checks a show frame by frame.
class FrameObserver {
 public:
  explicit FrameObserver(int domain) : reader_(makeDdsSubscriber({domain, 1, 0, {}})) {}

  Subscriber& reader() { return *reader_; }
  /// Receives frames until `is_over`; false after 10 s.
  bool watch(const std::function<bool()>& is_over) {
    for (const auto end = Clock::now() + std::chrono::seconds(10); Clock::now() < end;) {
      if (const auto frame = reader_->waitForFrame(newest_ ? newest_->frame : 0, milliseconds(5)))
        take(frame);
      const auto frame = reader_->frame();
      if (frame && (!newest_ || frame->session != newest_->session)) take(frame);
      if (is_over()) return true;
    }
    return false;
  }
  /// Waits until the hair is at rest in the wind, so that any later jump comes from the show. False where it
  /// does not come to rest.
  bool settles() {
    const auto stillFor = [&](milliseconds time) {
      forgetExtremes();
      return watch([&, begin = Clock::now()] { return Clock::now() - begin > time; }) && farthest_ < 1e-3;
    };
    for (int i = 0; i < 20; ++i)
      if (stillFor(milliseconds(300))) return true;
    return false;
  }
  uint64_t session() const { return newest_ ? newest_->session : 0; }
  const GuideFrame& newest() const { return *newest_; }
  /// Extremes between consecutive frames: the longest pause, s, and the largest motion of a vertex, m.
  double longestPause() const { return std::chrono::duration<double>(longest_).count(); }
  double farthestJump() const { return farthest_; }
  /// The largest step back of simulation time between consecutive frames, s, e.g. at a change of session.
  double mostBack() const { return most_back_; }
  void forgetExtremes() {
    longest_ = {};
    farthest_ = most_back_ = 0;
  }

 private:
  void take(const std::shared_ptr<const GuideFrame>& frame) {
    if (newest_ == frame) return;
    const auto now = Clock::now();
    if (newest_ && newest_->positions.size() == frame->positions.size()) {
      longest_ = std::max(longest_, now - seen_);
      for (size_t v = 0; v < frame->positions.size(); ++v)
        farthest_ =
            std::max(farthest_, static_cast<double>((frame->positions[v] - newest_->positions[v]).norm()));
      most_back_ = std::max(most_back_, newest_->simulation_time - frame->simulation_time);
    }
    newest_ = frame;
    seen_ = now;
  }

  std::unique_ptr<Subscriber> reader_;
  std::shared_ptr<const GuideFrame> newest_;
  Clock::time_point seen_;
  Clock::duration longest_{};
  double farthest_ = 0, most_back_ = 0;
};

class StandbyTakeover : public ProgramFixture {
 protected:
  void SetUp() override {
    std::string reason;
    if (!ddsAvailable(&reason)) GTEST_SKIP() << reason;
    ProgramFixture::SetUp();
  }
  pid_t claims(const std::string& strength, const std::string& strands = "40") {
    const std::string out = "daemon" + strength + "_" + std::to_string(++started_) + ".txt";
    const std::string line = "exec " + daemon_ +
                             " --scene straight --motion still --backend simd --threads 1 --strands " +
                             strands + " --domain " + std::to_string(domain_) +
                             " --duration 100 --body-contact spheres --claim " + strength + " 2>&1";
    said_ = out;
    return start({"sh", "-c", line}, out);
  }
  std::string order(FrameObserver& audience, CommandKind kind, const std::string& name,
                    std::vector<double> values) {
    const Command command{
        .groom_id = 1, .id = ++id_, .kind = kind, .name = name, .values = std::move(values)};
    const auto end = Clock::now() + std::chrono::seconds(8);
    return ask(audience.reader(), command, [end] { return Clock::now() > end; }).value_or("no answer");
  }
  std::string order(FrameObserver& audience, const std::string& ball, double x) {
    return order(audience, CommandKind::kAddCollider, ball,
                 {0, 0, x, 0.1, 0.7, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0.05, 0, 0.3, 0, 0, 0, 0, 0, 0, 1});
  }
  /// Checks wind, three balls of which one has moved, and a head that has moved.
  void expectShow(FrameObserver& audience, double third_ball) {
    const auto told = [&](const std::string& name) {
      const auto status = audience.reader().status();
      if (!status) return std::vector<double>();
      for (const auto& [known, values] : namedValues(status->parameters))
        if (known == name) return values;
      return std::vector<double>();
    };
    ASSERT_TRUE(audience.watch([&] {
      return told("wind") == std::vector<double>{3, 0, 1};
    })) << "wind is "
        << ::testing::PrintToString(told("wind")) << contents(folder_ / said_);
    std::vector<double> places;
    for (const PlacedCollider& placed : audience.newest().colliders)
      places.push_back(static_cast<double>(placed.pose.position.x()));
    std::sort(places.begin(), places.end());
    ASSERT_EQ(places.size(), 4u) << "the scene's shoulders among them";
    EXPECT_NEAR(places[0], -0.4, 1e-5);
    EXPECT_NEAR(places[2], 0.1, 1e-5);
    EXPECT_NEAR(places[3], third_ball, 1e-5);
    EXPECT_NEAR(audience.newest().head.position.x(), 0.05, 1e-5);
    EXPECT_NEAR(audience.newest().head.rotation.y(), 0.2, 1e-4);
  }
  /// Readers see no long pause between frames, and no jump of hair, head or balls.
  void expectNoBreak(FrameObserver& audience, const std::string& when) {
    EXPECT_LT(audience.longestPause(), 1.0) << when;
    EXPECT_LT(audience.farthestJump(), 5e-3) << when;
    EXPECT_LT(audience.mostBack(), 0.2) << when;
    std::printf("%s: longest pause %.0f ms, farthest jump %.1f mm, clock back by %.0f ms\n", when.c_str(),
                1e3 * audience.longestPause(), 1e3 * audience.farthestJump(), 1e3 * audience.mostBack());
    audience.forgetExtremes();
  }

  const int domain_ = testDomain(1);
  std::string said_;

 private:
  int started_ = 0;
  uint64_t id_ = static_cast<uint64_t>(getpid()) << 32;
};

TEST_F(StandbyTakeover, AShowContinuesWhicheverDaemonJoinsLeavesOrReturns) {
  FrameObserver audience(domain_);
  const pid_t weaker = claims("1");
  ASSERT_TRUE(audience.watch([&] { return audience.session() != 0; })) << contents(folder_ / said_);
  const uint64_t first = audience.session();
  EXPECT_EQ(order(audience, CommandKind::kSetParameter, "wind", {3, 0, 1}), "");
  EXPECT_EQ(order(audience, "ball a", -0.4), "");
  EXPECT_EQ(order(audience, "ball b", 0.1), "");
  EXPECT_EQ(order(audience, "ball c", 0.2), "");
  EXPECT_EQ(order(audience, CommandKind::kMoveCollider, "ball c", {0.4, 0.1, 0.7, 0, 0, 0, 1, 0.1}), "");
  EXPECT_EQ(order(audience, CommandKind::kHeadPose, "", {0.05, 0, 0, 0, 0.2, 0, 0.98}), "");
  ASSERT_TRUE(audience.watch([&, begin = Clock::now()] { return Clock::now() - begin > milliseconds(500); }));
  expectShow(audience, 0.4);
  ASSERT_TRUE(audience.settles());
  audience.forgetExtremes();

  pid_t stronger = claims("3");
  ASSERT_TRUE(audience.watch([&] { return audience.session() != first; })) << contents(folder_ / said_);
  const uint64_t second = audience.session();
  expectShow(audience, 0.4);
  expectNoBreak(audience, "a stronger one joins");

  interrupt(stronger);
  ASSERT_TRUE(audience.watch([&] { return audience.session() == first; }));
  expectShow(audience, 0.4);
  expectNoBreak(audience, "it leaves");
  wait(stronger);

  stronger = claims("3");
  ASSERT_TRUE(audience.watch([&] { return audience.session() != first; })) << contents(folder_ / said_);
  EXPECT_NE(audience.session(), second);
  expectShow(audience, 0.4);
  expectNoBreak(audience, "it comes back");
  ASSERT_TRUE(audience.settles());
  EXPECT_EQ(order(audience, CommandKind::kMoveCollider, "ball c", {0.3, 0.1, 0.7, 0, 0, 0, 1, 0}), "");
  kill(stronger, SIGKILL);
  ASSERT_TRUE(audience.watch([&] { return audience.session() == first; }));
  expectShow(audience, 0.3);
  expectNoBreak(audience, "it is killed, right after an answer");
  wait(stronger);
  EXPECT_TRUE(isRunning(weaker));
}

TEST_F(StandbyTakeover, ADaemonOfAnotherSceneDoesNotJoin) {
  FrameObserver audience(domain_);
  claims("1");
  ASSERT_TRUE(audience.watch([&] { return audience.session() != 0; })) << contents(folder_ / said_);
  const uint64_t first = audience.session();
  const pid_t other = claims("3", "50");
  EXPECT_EQ(wait(other), 2);
  EXPECT_NE(contents(folder_ / said_).find("strands (50 here, 40 there)"), std::string::npos)
      << contents(folder_ / said_);
  audience.watch([&, begin = Clock::now()] { return Clock::now() - begin > milliseconds(100); });
  EXPECT_EQ(audience.session(), first);
}

}  // namespace
}  // namespace strandcast
