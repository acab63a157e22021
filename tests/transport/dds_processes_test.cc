#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "core/error.h"
#include "dds_domain.h"
#include "peer.h"
#include "transport/dds.h"
#include "transport/lcm.h"
#include "transport/publisher.h"

namespace strandcast {
namespace {

constexpr int kNoNamespace = 77;

class DdsProcesses : public testing::Test {
 protected:
  void SetUp() override {
    std::string reason;
    if (!ddsAvailable(&reason)) GTEST_SKIP() << reason;
  }
  std::string domain(int test) { return std::to_string(testDomain(test)); }
};

void expectNothingLost(const Results& read, double at_least, const std::string& text) {
  ASSERT_TRUE(read.contains("lost")) << text;
  EXPECT_EQ(read.at("lost"), 0) << text;
  EXPECT_EQ(read.at("wrong"), 0) << text;
  EXPECT_EQ(read.at("rejected"), 0) << text;
  EXPECT_GE(read.at("received"), at_least) << text;
}

TEST_F(DdsProcesses, AFullGroomAt60HzLosesNothing) {
  Peer reader({"read", domain(8), "5", "0"});
  Peer slow_reader({"read", domain(8), "5", "200"});
  Peer publisher({"cast", domain(8), "4"});
  const Results published = publisher.finish();
  const Results read = reader.finish(), slow = slow_reader.finish();
  ASSERT_TRUE(published.contains("published")) << publisher.text();
  // The readers wait, so they are matched before the first frame or within some frames; on a slow machine
  // within 60.
  for (const auto& [one, peer] : {std::pair{&read, &reader}, {&slow, &slow_reader}}) {
    ASSERT_TRUE(one->contains("first_frame")) << peer->text();
    EXPECT_LE(one->at("first_frame"), 60) << peer->text();
    expectNothingLost(*one, published.at("published") - one->at("first_frame"), peer->text());
  }
  EXPECT_EQ(read.at("skipped"), 0) << "a renderer that keeps up sees every frame";
  EXPECT_GT(slow.at("skipped"), 100) << "one that does not skips frames, which are not lost";
  std::printf("%d x 16 at 60 Hz: latency p50 %.2f ms, p99 %.2f ms; slowest publish %.2f ms\n", kPeerGuides,
              read.at("latency_ms_p50"), read.at("latency_ms_p99"), published.at("slowest_publish_ms"));
}

TEST_F(DdsProcesses, AKilledDaemonDoesNotBlockTheNextStart) {
  Peer reader({"read", domain(10), "60", "0"});
  auto first = std::make_unique<Peer>(std::vector<std::string>{"publish", domain(10), "60"});
  ASSERT_TRUE(reader.waitFor("first_frame")) << reader.text();
  {
    Peer conflict({"publish", domain(10), "1"});
    EXPECT_TRUE(conflict.waitFor("rival")) << conflict.text();
  }
  const auto watcher = makeDdsPublisher({testDomain(10), 1, 77, {Codec::kFloat32}});
  const auto wait_for_rival = [&](bool expected) {
    for (int i = 0; i < 600 && watcher->conflict().has_value() != expected; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return watcher->conflict().has_value() == expected;
  };
  EXPECT_TRUE(wait_for_rival(true));
  first->kill();
  const auto killed = std::chrono::steady_clock::now();
  EXPECT_TRUE(wait_for_rival(false)) << "a killed daemon is forgotten";
  EXPECT_LT(std::chrono::steady_clock::now() - killed, std::chrono::seconds(5));
}

TEST_F(DdsProcesses, OneShotCommandsReachTheDaemonAndAreAcknowledged) {
  Peer publisher({"cast", domain(12), "60"});
  const auto observer = makeDdsSubscriber({testDomain(12), 1, 0, {}});
  ASSERT_TRUE(observer->waitForGroom(std::chrono::milliseconds(8000)));
  for (uint64_t id = 101; id <= 103; ++id) {
    Peer sender({"send", domain(12), std::to_string(id)});
    sender.finish();
    EXPECT_EQ(sender.exitCode(), 0) << sender.text();
    for (int i = 0; i < 200 && (!observer->status() || observer->status()->last_command != id); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    const auto status = observer->status();
    ASSERT_TRUE(status && status->last_command == id)
        << "command " << id << ", status " << (status ? std::to_string(status->last_command) : "gone") << ", "
        << observer->statistics().frames_received << " frames received; the daemon "
        << publisher.exitReport();
  }
  Peer lost({"send", domain(13), "1"});
  lost.finish();
  EXPECT_EQ(lost.exitCode(), 2);
  EXPECT_NE(lost.text().find("no daemon answers"), std::string::npos) << lost.text();
}

TEST_F(DdsProcesses, LoopbackAloneIsEnough) {
  Peer peer({"alone", domain(14), "1"});
  const Results read = peer.finish();
  if (peer.exitCode() == kNoNamespace) GTEST_SKIP() << "this process may not make a network namespace";
  expectNothingLost(read, 40, peer.text());
}

TEST_F(DdsProcesses, NoNetworkAtAllIsSaid) {
  Peer peer({"offline", domain(15)});
  peer.finish();
  if (peer.exitCode() == kNoNamespace) GTEST_SKIP() << "this process may not make a network namespace";
  EXPECT_EQ(peer.exitCode(), 2);
  EXPECT_NE(peer.text().find("no IPv4 network interface is up"), std::string::npos) << peer.text();
}

TEST(LcmProcesses, AMissingRouteIsExplained) {
  std::string reason;
  if (!lcmAvailable(&reason)) GTEST_SKIP() << reason;
  Peer peer({"lcm_alone", std::to_string(testDomain(1))});
  peer.finish();
  if (peer.exitCode() == kNoNamespace) GTEST_SKIP() << "this process may not make a network namespace";
  EXPECT_EQ(peer.exitCode(), 2);
  EXPECT_NE(peer.text().find("ip route add 224.0.0.0/4 dev lo"), std::string::npos) << peer.text();
}

}  // namespace
}  // namespace strandcast
