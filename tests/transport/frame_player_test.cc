#include <gtest/gtest.h>

#include <random>

#include "moving_hair.h"
#include "transport/frame_queue.h"
#include "transport/subscriber.h"

namespace strandcast {
namespace {

using std::chrono::milliseconds;

/// Frames arrive when the test says so.
class ScriptedSubscriber final : public Subscriber {
 public:
  explicit ScriptedSubscriber(GroomDescription groom) : groom_(std::move(groom)) { begin(groom_); }
  void begin(const GroomDescription& groom) {
    groom_ = groom;
    queue_.setGroom(std::make_shared<GroomDescription>(groom));
  }
  /// Frame `number` arrives at `seconds` of the steady clock.
  void arrive(uint64_t number, double seconds) {
    auto frame = std::make_shared<GuideFrame>(hairFrame(groom_, number));
    frame->arrival_time = static_cast<uint64_t>(seconds * 1e9);
    queue_.push(std::move(frame), 0);
  }
  const GroomDescription& sent() const { return groom_; }

  std::shared_ptr<const GroomDescription> groom() const override { return queue_.groom(); }
  std::shared_ptr<const BodyDescription> body() const override { return nullptr; }
  std::shared_ptr<const ColliderSet> colliders() const override { return nullptr; }
  std::shared_ptr<const HairDescription> hairs() const override { return nullptr; }
  std::shared_ptr<const GuideFrame> frame() const override { return queue_.frame(); }
  void keepFrames(size_t count) override { queue_.keep(count); }
  std::shared_ptr<const GuideFrame> waitForFrame(uint64_t after, milliseconds timeout) override {
    return queue_.waitForFrame(after, timeout);
  }
  std::shared_ptr<const GuideFrame> waitForNext(const GuideFrame* last, milliseconds timeout) override {
    return queue_.waitForNext(last, timeout);
  }
  bool waitForGroom(milliseconds) override { return true; }
  std::optional<Status> status() const override { return std::nullopt; }
  std::vector<Status> allStatuses() const override { return {}; }
  void send(const Command&, const std::function<bool()>&) override {}
  std::optional<std::string> waitForAnswer(uint64_t, milliseconds) override { return std::nullopt; }
  ReceiveStatistics statistics() const override { return {}; }

 private:
  GroomDescription groom_;
  FrameQueue queue_;
};

GroomDescription someHair() {
  return hairGroom(20, [](size_t) { return 16; });
}

std::chrono::steady_clock::time_point at(double seconds) {
  return std::chrono::steady_clock::time_point(
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(
          std::chrono::duration<double>(seconds)));
}

TEST(FramePlayer, LatestShowsTheNewestAndSaysWhenItRepeats) {
  ScriptedSubscriber stream(someHair());
  FramePlayer player(stream, Playout::kLatest);
  EXPECT_FALSE(player.next());
  stream.arrive(1, 10);
  stream.arrive(2, 10);
  EXPECT_EQ(player.next()->frame, 2u);
  EXPECT_EQ(player.next()->frame, 2u);
  EXPECT_EQ(player.statistics().pictures, 2u);
  EXPECT_EQ(player.statistics().repeated, 1u);
}

TEST(FramePlayer, ExactShowsEachFrameOnceInOrder) {
  ScriptedSubscriber stream(someHair());
  FramePlayer player(stream, Playout::kExact);
  for (uint64_t number = 1; number <= 5; ++number) stream.arrive(number, 10);
  for (uint64_t number = 1; number <= 5; ++number) EXPECT_EQ(player.next()->frame, number);
  EXPECT_FALSE(player.next());
  stream.arrive(6, 11);
  EXPECT_EQ(player.next()->frame, 6u);
  EXPECT_EQ(player.statistics().repeated, 0u);
}

TEST(FramePlayer, SmoothMovesEvenlyThroughJitter) {
  constexpr double kStart = 1000, kInterval = 1.0 / 60, kPicture = 1.0 / 144;
  ScriptedSubscriber stream(someHair());
  FramePlayer player(stream, Playout::kSmooth);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> jitter(0, 0.6 * kInterval);
  uint64_t arrived = 0;
  double due = kStart + kInterval + jitter(random), shown = 0, largest_step = 0, min_step = 1, worst = 0;
  for (int picture = 0; picture < 600; ++picture) {
    const double now = kStart + picture * kPicture;
    while (due <= now) {
      stream.arrive(++arrived, due);
      due = kStart + static_cast<double>(arrived + 1) * kInterval + jitter(random);
    }
    const auto frame = player.next(std::nullopt, at(now));
    if (!frame) continue;
    if (picture >= 250) {  // the clock offset has converged
      largest_step = std::max(largest_step, frame->simulation_time - shown);
      min_step = std::min(min_step, frame->simulation_time - shown);
      // The exact position of the hair at that time.
      GuideFrame truth = hairFrame(stream.sent(), frame->frame);
      const double number = frame->simulation_time * 60;
      EXPECT_LE(number, static_cast<double>(frame->frame) + 1e-6);
      EXPECT_GE(number, static_cast<double>(frame->frame) - 1 - 1e-6);
      for (size_t v = 0; v < truth.positions.size(); ++v)
        worst = std::max(worst, static_cast<double>((truth.positions[v] - frame->positions[v]).norm()));
    }
    shown = frame->simulation_time;
  }
  EXPECT_NEAR(largest_step, kPicture, 0.25 * kPicture);
  EXPECT_NEAR(min_step, kPicture, 0.25 * kPicture);
  EXPECT_LT(worst, 0.02) << "m, of motion within a frame";
  const PlayoutStatistics statistics = player.statistics();
  EXPECT_GE(statistics.delay_ms, 1e3 * kInterval);
  EXPECT_LE(statistics.delay_ms, 2e3 * kInterval);
  EXPECT_NEAR(statistics.jitter_ms, 1e3 * 0.6 * kInterval, 2.5);
}

TEST(FramePlayer, SmoothStandsStillWhereFramesStayAwayAndStartsAnewWithASession) {
  ScriptedSubscriber stream(someHair());
  FramePlayer player(stream, Playout::kSmooth);
  for (uint64_t number = 1; number <= 20; ++number)
    stream.arrive(number, 5 + static_cast<double>(number) / 60);
  EXPECT_EQ(player.next(std::nullopt, at(9))->simulation_time, 20.0 / 60);
  const auto still = player.next(std::nullopt, at(10));
  EXPECT_EQ(still->simulation_time, 20.0 / 60);
  EXPECT_EQ(still->positions, hairFrame(stream.sent(), 20).positions);
  GroomDescription other = someHair();
  other.session = 99;
  stream.begin(other);
  EXPECT_FALSE(player.next(std::nullopt, at(11))) << "frames of the old groom do not fit the new one";
  stream.arrive(1, 11);
  EXPECT_EQ(player.next(std::nullopt, at(11))->session, 99u);
}

TEST(FramePlayer, HairIsDrawnOnTheNewestHead) {
  ScriptedSubscriber stream(someHair());
  FramePlayer player(stream, Playout::kLatest);
  stream.arrive(30, 10);
  const Pose newest{Vec3(1, 2, 3), Quat(Eigen::AngleAxisf(0.4f, Eigen::Vector3f::UnitX()))};
  const auto moved = player.next(newest), as_sent = player.next();
  EXPECT_EQ(moved->head.position, newest.position);
  for (size_t v = 0; v < moved->positions.size(); ++v) {
    const Vec3 expected = newest.apply(as_sent->head.inverse().apply(as_sent->positions[v]));
    EXPECT_LT((moved->positions[v] - expected).norm(), 1e-6f);
  }
}

}  // namespace
}  // namespace strandcast
