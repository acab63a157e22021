// Functions that programs which draw or record a stream rely on.
#include <csignal>

#include "core/error.h"
#include "options/console.h"
#include "service/commands.h"
#include "service/network.h"
#include "service/stream.h"
#include "tests/apps/daemon_fixture.h"
#include "tests/expect_error.h"
#include "tests/io/scratch_folder.h"
#include "tests/transport/true_within.h"
#include "transport/lcm.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

template <class Description>
std::shared_ptr<const Description> described(uint64_t session, uint32_t revision) {
  Description made;
  made.session = session;
  made.revision = revision;
  return std::make_shared<Description>(made);
}

TEST(Interrupts, OfEitherKindEndProgramsAlike) {
  struct sigaction before_int {
  }, before_term{};
  sigaction(SIGINT, nullptr, &before_int);
  sigaction(SIGTERM, nullptr, &before_term);
  for (const int signal : {SIGINT, SIGTERM}) {
    catchInterrupts();
    raise(signal);
    EXPECT_TRUE(g_interrupted) << signal;
    g_interrupted = false;
  }
  sigaction(SIGINT, &before_int, nullptr);
  sigaction(SIGTERM, &before_term, nullptr);
}

TEST(StreamScene, FitsFramesOfItsDaemonAloneAndOnlyWhole) {
  const auto groom = described<GroomDescription>(11, 2);
  const auto body = described<BodyDescription>(11, 2);
  GuideFrame frame;
  frame.session = 11;
  frame.revision = 2;
  EXPECT_TRUE((StreamScene{groom, body}.fits(frame)));
  EXPECT_FALSE((StreamScene{groom, nullptr}.fits(frame))) << "the body of a daemon started anew is to come";
  EXPECT_FALSE((StreamScene{nullptr, body}.fits(frame)));
  EXPECT_FALSE((StreamScene{groom, described<BodyDescription>(12, 2)}.fits(frame)));
  EXPECT_FALSE((StreamScene{groom, described<BodyDescription>(11, 1)}.fits(frame)));
  GroomDescription with_hairs = *groom;
  with_hairs.growth = GroomDescription::kHairs;
  StreamScene scene{std::make_shared<GroomDescription>(with_hairs), body};
  EXPECT_FALSE(scene.fits(frame)) << "its hairs are to come";
  scene.hairs = described<HairDescription>(11, 1);
  EXPECT_FALSE(scene.fits(frame));
  scene.hairs = described<HairDescription>(11, 2);
  EXPECT_TRUE(scene.fits(frame));
  frame.session = 12;
  EXPECT_FALSE((StreamScene{groom, body}.fits(frame)));
}

TEST(ClaimGroom, NobodyElseIsListenedForInALog) {
  if (!lcmAvailable()) GTEST_SKIP() << "this build has no LCM";
  const ScratchFolder folder;
  Settings settings;
  settings.transport = "lcm";
  settings.lcm_url = "file://" + (folder.path() / "a.log").string() + "?mode=w";
  const auto start = std::chrono::steady_clock::now();
  EXPECT_NE(claimGroom(settings, 1), nullptr);
  EXPECT_LT(std::chrono::steady_clock::now() - start, kConflictListenTime);
}

TEST(AnswerWait, LastsAsLongAsStepsAreTakenAndNoLonger) {
  using std::chrono::milliseconds;
  const auto steps_until_over = [](double asked, double between) {  // s, of which it waits 0.3
    AnswerWait wait(0.3, asked);
    Status status;
    status.parameters = parameterTable(Parameters{});
    for (int steps = 0; steps < 100; ++steps) {
      const auto next = std::chrono::steady_clock::now() + std::chrono::duration<double>(between);
      while (std::chrono::steady_clock::now() < next) {
        if (wait.isOver(status)) return steps;
        std::this_thread::sleep_for(milliseconds(5));
      }
      status.simulation_time += static_cast<double>(Parameters{}.time_step);
    }
    return 100;
  };
  const int slow = steps_until_over(8, 0.1);
  EXPECT_GE(slow, 8) << "they are being taken";
  EXPECT_LE(slow, 12);
  EXPECT_LE(steps_until_over(0, 0.1), 3) << "no steps";
  EXPECT_LE(steps_until_over(2, 0.02), 20) << "a simulation that heard nothing";
}

class StreamTest : public DaemonFixture {};

TEST_F(StreamTest, ASimulationThatFailsEndsItsReaderWithTheError) {
  const Stream stream(fewStrands(), true, 10, [](Simulation& simulation) {
    if (simulation.time() > 0.05) throw Error("the simulation fails", "at 0.05 s", "");
  });
  const auto failure = [&] { return errorOf([&] { stream.checkAlive(); }); };
  EXPECT_TRUE(trueWithin(std::chrono::seconds(30), [&] { return !failure().empty(); }));
  EXPECT_NE(failure().find("the simulation fails: at 0.05 s"), std::string::npos) << failure();
  EXPECT_NE(failure(), "") << "whenever it is asked";
}

TEST_F(StreamTest, FramesThatWaitToBeDrawnTakeNoMoreThanTheirRoom) {
  Stream stream(fewStrands(), true, 10);
  FrameCapture capture(stream, {.frames = 1000, .fps = 60, .skip = 0, .timeout = 10, .room = 1});
  EXPECT_TRUE(trueWithin(std::chrono::seconds(30), [&] { return capture.skippedFrames() >= 5; }));
  const auto first = capture.next(), second = capture.next();
  ASSERT_TRUE(first && second);
  EXPECT_GT(second->frame->frame, first->frame->frame + 5)
      << "one waits, and those after it were passed over";
}

TEST_F(StreamTest, AnInterruptDoesNotWaitForWhatIsStillToBeDrawn) {
  Stream stream(fewStrands(), true, 10);
  FrameCapture capture(stream, {.frames = 1000, .fps = 60, .skip = 0, .timeout = 10});
  ASSERT_TRUE(capture.next());
  ASSERT_TRUE(stream.subscriber().waitForFrame(10, std::chrono::seconds(30)));
  g_interrupted = true;
  EXPECT_FALSE(capture.next());
  g_interrupted = false;
}

TEST_F(StreamTest, OfADaemonThatIsPausedTheMomentIsPickedThatItHas) {
  Stream stream(fewStrands(), true, 10);
  Command pause;
  pause.id = 1;
  pause.kind = CommandKind::kPause;
  pause.values = {1};
  stream.subscriber().send(pause);
  ASSERT_EQ(stream.subscriber().waitForAnswer(1, std::chrono::seconds(30)), "");
  for (const double skip : {0.0, 100.0}) {
    FrameCapture capture(stream, {.frames = 3, .fps = 60, .skip = skip, .timeout = 0.5});
    EXPECT_TRUE(capture.next());
    EXPECT_FALSE(capture.next());
    EXPECT_TRUE(capture.isPaused());
  }
}

TEST_F(StreamTest, ARecordingThatIsHeldUpMissesNoFrame) {
  Stream stream(fewStrands(), true, 10);
  const ScratchFolder folder;
  StreamRecording recording(stream.subscriber(), folder / "held_up.rec", {});
  ASSERT_TRUE(recording.take(std::chrono::seconds(30)));
  const uint64_t first = stream.subscriber().frame()->frame;
  ASSERT_TRUE(stream.subscriber().waitForFrame(first + 2 * kFrameQueueLength, std::chrono::seconds(30)));
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(recording.take(std::chrono::seconds(30)));
  EXPECT_EQ(recording.skipped(), 0u);
}

TEST_F(StreamTest, ASimulationThatRunsIsNoError) {
  Stream stream(fewStrands(), true, 10);
  ASSERT_TRUE(stream.subscriber().waitForFrame(3, std::chrono::seconds(30)));
  EXPECT_NO_THROW(stream.checkAlive());
}

}  // namespace
}  // namespace strandcast
