#include "transport/in_process.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "core/error.h"
#include "sample_messages.h"

namespace strandcast {
namespace {

using std::chrono::milliseconds;

TEST(InProcess, DescriptionsAndFramesArrive) {
  auto [publisher, subscriber] = makeInProcessChannel(7);
  EXPECT_EQ(subscriber->groom(), nullptr);
  EXPECT_FALSE(subscriber->waitForGroom(milliseconds(1)));
  const GroomDescription groom = uniformGroom(10, 4);
  publisher->announce(groom, sampleBody(4));
  ASSERT_TRUE(subscriber->waitForGroom(milliseconds(0)));
  EXPECT_EQ(subscriber->groom()->guides.positions, groom.guides.positions);
  EXPECT_EQ(subscriber->groom()->groom_id, 7u);
  EXPECT_EQ(subscriber->body()->mesh.triangles.size(), 9u);
  EXPECT_EQ(subscriber->waitForFrame(0, milliseconds(1)), nullptr);
  publisher->publish(sampleFrame(groom, 1));
  const auto frame = subscriber->waitForFrame(0, milliseconds(0));
  ASSERT_TRUE(frame);
  EXPECT_TRUE(isSampleFrame(*frame));
  EXPECT_EQ(frame->groom_id, 7u);
  EXPECT_EQ(publisher->matchedReaders(), 1u);
  EXPECT_FALSE(publisher->conflict());
}

TEST(InProcess, WaitForFrameGivesTheOldestNewerOne) {
  auto [publisher, subscriber] = makeInProcessChannel(1);
  const GroomDescription groom = uniformGroom(10, 4);
  publisher->announce(groom, sampleBody(4));
  for (uint64_t number = 1; number <= 5; ++number) publisher->publish(sampleFrame(groom, number));
  for (uint64_t number = 1; number <= 5; ++number) {
    EXPECT_EQ(subscriber->waitForFrame(number - 1, milliseconds(0))->frame, number);
  }
  EXPECT_EQ(subscriber->waitForFrame(5, milliseconds(1)), nullptr);
  EXPECT_EQ(subscriber->frame()->frame, 5u);
  for (uint64_t number = 6; number <= 30; ++number) publisher->publish(sampleFrame(groom, number));
  EXPECT_EQ(subscriber->waitForFrame(5, milliseconds(0))->frame, 31 - kFrameQueueLength);
  subscriber->keepFrames(20);
  for (uint64_t number = 31; number <= 60; ++number) publisher->publish(sampleFrame(groom, number));
  EXPECT_EQ(subscriber->waitForFrame(30, milliseconds(0))->frame, 41u);
  subscriber->keepFrames(2);
  EXPECT_EQ(subscriber->waitForFrame(30, milliseconds(0))->frame, 59u);
  EXPECT_EQ(subscriber->statistics().frames_lost, 0u) << "frames not looked at are not lost";
  EXPECT_EQ(subscriber->statistics().frames_received, 60u);
}

TEST(InProcess, FrameNumbersOfAnEarlierSessionDoNotHideNewFrames) {
  auto [publisher, subscriber] = makeInProcessChannel(1);
  GroomDescription groom = uniformGroom(10, 4);
  publisher->announce(groom, sampleBody(4));
  publisher->publish(sampleFrame(groom, 500));
  groom.session = 99;
  publisher->announce(groom, sampleBody(4));
  EXPECT_EQ(subscriber->frame(), nullptr) << "the old frame does not fit the new groom";
  publisher->publish(sampleFrame(groom, 1));
  EXPECT_EQ(subscriber->waitForFrame(500, milliseconds(0))->frame, 1u);
}

TEST(InProcess, AReaderThatKeepsItsLastFrameMissesNoneOfTheNextSession) {
  auto [publisher, subscriber] = makeInProcessChannel(1);
  GroomDescription groom = uniformGroom(10, 4);
  publisher->announce(groom, sampleBody(4));
  for (uint64_t number = 1; number <= 3; ++number) publisher->publish(sampleFrame(groom, number));
  std::shared_ptr<const GuideFrame> last;
  while (const auto frame = subscriber->waitForNext(last.get(), milliseconds(0))) last = frame;
  EXPECT_EQ(last->frame, 3u);
  groom.session = 99;
  publisher->announce(groom, sampleBody(4));
  for (uint64_t number = 1; number <= 5; ++number) publisher->publish(sampleFrame(groom, number));
  for (uint64_t number = 1; number <= 5; ++number) {
    last = subscriber->waitForNext(last.get(), milliseconds(0));
    ASSERT_TRUE(last);
    EXPECT_EQ(last->frame, number);
  }
  EXPECT_EQ(subscriber->waitForNext(last.get(), milliseconds(0)), nullptr);
}

TEST(InProcess, FramesOfAnotherTopologyAreDropped) {
  auto [publisher, subscriber] = makeInProcessChannel(1);
  GroomDescription groom = uniformGroom(10, 4);
  publisher->publish(sampleFrame(groom, 1));  // before the announcement
  publisher->announce(groom, sampleBody(4));
  EXPECT_THROW(publisher->announce(groom, sampleBody(4)), Error) << "the same revision again";
  GuideFrame frame = sampleFrame(groom, 2);
  frame.revision = 9;
  publisher->publish(frame);
  frame = sampleFrame(groom, 3);
  frame.positions.pop_back();
  publisher->publish(frame);
  EXPECT_EQ(subscriber->frame(), nullptr);
}

TEST(InProcess, AReaderThatKeepsUpSeesEveryFrame) {
  auto [publisher, subscriber] = makeInProcessChannel(1);
  const GroomDescription groom = uniformGroom(100, 16);
  publisher->announce(groom, sampleBody(4));
  constexpr uint64_t kFrames = 500;
  std::atomic<uint64_t> reached{0};
  std::thread writer([&, end = publisher.get()] {
    for (uint64_t number = 1; number <= kFrames; ++number) {
      while (number > reached + kFrameQueueLength) std::this_thread::yield();
      end->publish(sampleFrame(groom, number));
    }
  });
  for (uint64_t number = 1; number <= kFrames; ++number) {
    const auto frame = subscriber->waitForFrame(number - 1, milliseconds(5000));
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->frame, number);
    EXPECT_TRUE(isSampleFrame(*frame));
    reached = number;
  }
  writer.join();
  EXPECT_EQ(subscriber->statistics().frames_lost, 0u);
  EXPECT_GE(subscriber->statistics().latency_ms_p99, subscriber->statistics().latency_ms_p50);
}

TEST(InProcess, CommandsAndStatusArrive) {
  auto [publisher, subscriber] = makeInProcessChannel(3);
  EXPECT_FALSE(publisher->takeCommand());
  for (uint64_t id = 1; id <= 3; ++id) {
    Command command;
    command.id = id;
    command.kind = CommandKind::kSetParameter;
    command.name = "wind";
    command.values = {1, 2, static_cast<double>(id)};
    subscriber->send(command);
    subscriber->send(command);  // as a sender without an answer does
  }
  for (uint64_t id = 1; id <= 3; ++id) EXPECT_EQ(publisher->takeCommand()->id, id);
  EXPECT_FALSE(publisher->takeCommand());
  Command bad;
  EXPECT_THROW(subscriber->send(bad), Error) << "id 0";
  bad.id = 1;
  bad.groom_id = 4;
  EXPECT_THROW(subscriber->send(bad), Error) << "another groom";
  EXPECT_FALSE(subscriber->status());
  Status status;
  status.last_command = 2;
  status.last_command_error = "no such wind";
  publisher->publishStatus(status);
  status.last_command = 3;
  status.last_command_error.clear();
  publisher->publishStatus(status);
  EXPECT_EQ(subscriber->waitForAnswer(2, std::chrono::milliseconds(0)), "no such wind");
  EXPECT_EQ(subscriber->waitForAnswer(3, std::chrono::milliseconds(0)), "");
  EXPECT_FALSE(subscriber->waitForAnswer(4, std::chrono::milliseconds(1)));
  EXPECT_EQ(subscriber->status()->last_command, 3u);
  EXPECT_EQ(subscriber->status()->groom_id, 3u);
  EXPECT_EQ(subscriber->allStatuses().size(), 1u);
  publisher.reset();
  EXPECT_EQ(subscriber->waitForAnswer(3, std::chrono::milliseconds(0)), "") << "kept";
  bad.groom_id = 3;
  EXPECT_THROW(subscriber->send(bad), Error) << "nobody is left";
}

TEST(InProcess, ACommandThatNeverFitsIsNotAskedAgain) {
  auto [publisher, subscriber] = makeInProcessChannel(3);
  Command command{.id = 1, .kind = CommandKind::kAddCollider, .name = "ball", .values = {HUGE_VAL}};
  int looks = 0;
  EXPECT_THROW(ask(*subscriber, command, [&] { return ++looks > 1000; }), Error);
  EXPECT_EQ(looks, 0);
  command.values = {1};
  publisher.reset();
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THROW(ask(*subscriber, command, [&] { return ++looks >= 5; }), Error) << "nobody is there yet";
  EXPECT_GE(std::chrono::steady_clock::now() - start, milliseconds(60)) << "nor is the machine kept busy";
}

}  // namespace
}  // namespace strandcast
