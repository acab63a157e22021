// A daemon's publisher (Fast DDS) and a reader built on another vendor's DDS from the same IDL, as two
// processes.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <thread>

#include "tests/transport/dds_domain.h"
#include "tests/transport/sample_messages.h"
#include "transport/chunks.h"
#include "transport/dds.h"
#include "transport/parameter_table.h"
#include "transport/publisher.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kFrames = 120;
constexpr uint64_t kCommand = 4711;

TEST(Cyclone, ReceivesTheGroomLateAndEveryFrameAndItsCommandIsObeyed) {
  std::string reason;
  if (!ddsAvailable(&reason)) GTEST_SKIP() << reason;
  const int domain = testDomain(3);
  const auto publisher = makeDdsPublisher({domain, 1, 77, {Codec::kFloat32}});
  GroomDescription groom = uniformGroom(2000, 16);
  groom.session = 77;
  publisher->announce(groom, sampleBody(20));
  const ColliderSet colliders = sampleColliders(77);
  publisher->announceColliders(colliders);
  GuideFrame frame;
  uint64_t number = 0;
  std::optional<Command> obeyed;
  std::optional<PoseSamples> posed;
  const auto cast = [&](Clock::duration time, const std::function<bool()>& is_over) {
    const auto start = Clock::now();
    for (auto due = start; due < start + time && !is_over(); due += std::chrono::microseconds(16667)) {
      std::this_thread::sleep_until(due);
      fillSampleFrame(groom, ++number, frame);
      publisher->publish(frame);
      while (std::optional<PoseSamples> samples = publisher->takePoses()) posed = std::move(samples);
      while (const auto command = publisher->takeCommand()) {
        obeyed = command;
        Status status;
        status.last_command = command->id;
        Parameters parameters;
        setParameter(parameters, command->name, command->values, "command");
        status.parameters = parameterTable(parameters);
        publisher->publishStatus(status);
      }
    }
  };
  cast(std::chrono::milliseconds(500), [] { return false; });  // before the reader starts

  FILE* const reader = popen((std::string(STRANDCAST_CYCLONE_READER) + " " + std::to_string(domain) + " " +
                              std::to_string(kFrames) + " " + std::to_string(kCommand))
                                 .c_str(),
                             "r");
  ASSERT_NE(reader, nullptr);
  std::map<std::string, double> results;
  std::atomic<bool> has_ended{false};
  std::thread listener([&] {
    char key[64];
    for (double value = 0; std::fscanf(reader, "%63s %lf", key, &value) == 2;) results[key] = value;
    has_ended = true;
  });
  cast(std::chrono::seconds(20), [&] { return has_ended.load(); });
  listener.join();
  EXPECT_EQ(pclose(reader), 0);
  EXPECT_EQ(results["strands"], 2000);
  EXPECT_EQ(results["vertices"], 32000);
  EXPECT_EQ(results["shapes"], 1 + static_cast<double>(colliders.colliders[1].shapes.size()));
  EXPECT_EQ(results["words"], splitColliders(colliders)[0].total_words);
  EXPECT_EQ(results["spheres_of_the_head"], 1);
  EXPECT_GE(results["frames"], kFrames);
  EXPECT_EQ(results["missing"], 0);
  EXPECT_EQ(results["wrong_chunks"], 0);
  EXPECT_EQ(results["answered"], 1);
  EXPECT_EQ(results["told_parameters"], static_cast<double>(parameterList().size()));
  EXPECT_EQ(results["told_wind"], 3);
  ASSERT_TRUE(obeyed);
  EXPECT_EQ(obeyed->id, kCommand);
  EXPECT_EQ(obeyed->name, "wind");
  EXPECT_EQ(obeyed->values, (std::vector<double>{3, 0, 0}));
  ASSERT_TRUE(posed);
  EXPECT_EQ(posed->source, 99u);
  EXPECT_EQ(posed->names, "head");
  EXPECT_EQ(posed->poses, (std::vector<float>{0.25f, 0, 0, 0, 0.6f, 0, 0.8f}));
  std::printf("groom %.0f ms after the reader's start\n", results["groom_after_ms"]);
}

}  // namespace
}  // namespace strandcast
