#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "dds_domain.h"
#include "transport/dds.h"
#include "transport/lcm.h"

namespace strandcast {
namespace {

using Results = std::map<std::string, double>;
constexpr int kNoNamespace = 77;

/// A transport_peer; killed when it is still there at the end.
class Peer {
 public:
  explicit Peer(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), STRANDCAST_TRANSPORT_PEER);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    if (posix_spawn(&pid_, STRANDCAST_TRANSPORT_PEER, &actions, nullptr, pointers.data(), environ) != 0) {
      throw std::runtime_error("transport_peer cannot be started");
    }
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    output_ = fdopen(ends[0], "r");
  }
  ~Peer() {
    kill();
    std::fclose(output_);
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }
  /// Reads on until this key was printed; false when the peer ended first.
  bool waitFor(const std::string& key) {
    while (!results_.contains(key) && readLine()) {
    }
    return results_.contains(key);
  }
  /// All that it printed, at its end.
  const Results& finish() {
    while (readLine()) {
    }
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = 0;
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return results_;
  }
  /// Ends it and says how it was doing, for the message of a failed test.
  std::string autopsy() {
    int status = 0;
    const bool had_ended = waitpid(pid_, &status, WNOHANG) == pid_;
    if (had_ended) pid_ = 0;
    kill();
    while (readLine()) {
    }
    return (had_ended ? "had ended with wait status " + std::to_string(status) : std::string("was alive")) +
           ", said:\n" + text_;
  }
  int exitCode() const { return exit_code_; }
  const std::string& text() const { return text_; }

 private:
  bool readLine() {
    char line[512], key[64];
    double value = 0;
    if (!std::fgets(line, sizeof line, output_)) return false;
    text_ += line;
    if (std::sscanf(line, "%63s %lf", key, &value) == 2) results_[key] = value;
    return true;
  }
  pid_t pid_ = 0;
  FILE* output_ = nullptr;
  Results results_;
  std::string text_;
  int exit_code_ = -1;
};

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
  Peer reader({"read", domain(8), "5.5", "0"});
  Peer slow_reader({"read", domain(8), "5.5", "100"});
  Peer publisher({"publish", domain(8), "4"});
  const Results published = publisher.finish();
  const Results read = reader.finish(), slow = slow_reader.finish();
  ASSERT_TRUE(published.contains("published")) << publisher.text();
  // The readers wait, so they are matched before the first frame, or within a few frames.
  expectNothingLost(read, 230, reader.text());
  expectNothingLost(slow, 230, slow_reader.text());
  EXPECT_EQ(read.at("skipped"), 0) << "a renderer that keeps up sees every frame";
  EXPECT_GT(slow.at("skipped"), 100) << "one that does not skips frames, which are not lost";
  std::printf("%d x 16 at 60 Hz: latency p50 %.2f ms, p99 %.2f ms; slowest publish %.2f ms\n", kPeerGuides,
              read.at("latency_ms_p50"), read.at("latency_ms_p99"), published.at("slowest_publish_ms"));
}

TEST_F(DdsProcesses, LateAndRestartedReadersGetGroomAndFrames) {
  Peer publisher({"publish", domain(9), "60"});
  std::this_thread::sleep_for(kRivalListenTime + std::chrono::seconds(1));
  for (int trial = 0; trial < 3; ++trial) {  // each is late; each but the first follows a killed one
    Peer reader({"read", domain(9), "60", "0"});
    ASSERT_TRUE(reader.waitFor("first_frame")) << trial << reader.text();
    reader.kill();
  }
  Peer reader({"read", domain(9), "1", "0"});
  const Results read = reader.finish();
  expectNothingLost(read, 45, reader.text());
  EXPECT_EQ(read.at("groom"), kPeerGuides);
  EXPECT_GT(read.at("first_frame"), 30);
}

TEST_F(DdsProcesses, AKilledDaemonDoesNotBlockTheNextStart) {
  Peer reader({"read", domain(10), "60", "0"});
  auto first = std::make_unique<Peer>(std::vector<std::string>{"publish", domain(10), "60"});
  ASSERT_TRUE(reader.waitFor("first_frame")) << reader.text();
  {
    Peer rival({"publish", domain(10), "1"});
    EXPECT_TRUE(rival.waitFor("rival")) << rival.text();
  }
  const auto watcher = makeDdsPublisher({testDomain(10), 1, 77, {Codec::kFloat32}});
  const auto wait_for_rival = [&](bool expected) {
    for (int i = 0; i < 600 && watcher->rivalSession().has_value() != expected; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return watcher->rivalSession().has_value() == expected;
  };
  EXPECT_TRUE(wait_for_rival(true));
  first->kill();
  const auto killed = std::chrono::steady_clock::now();
  EXPECT_TRUE(wait_for_rival(false)) << "a killed daemon is forgotten";
  EXPECT_LT(std::chrono::steady_clock::now() - killed, std::chrono::seconds(5));
}

TEST_F(DdsProcesses, ANewDaemonTakesOverFromAKilledOneAtOnce) {
  auto first = std::make_unique<Peer>(std::vector<std::string>{"publish", domain(11), "60"});
  const auto reader = makeDdsSubscriber({testDomain(11), 1, 0, {}});
  const auto first_frame = reader->waitForFrame(0, std::chrono::milliseconds(8000));
  ASSERT_TRUE(first_frame);
  first->kill();
  Peer second({"publish", domain(11), "2"});
  uint64_t after = reader->frame()->frame;
  bool took_over = false;
  for (int i = 0; i < 300 && !took_over; ++i) {
    const auto frame = reader->waitForFrame(after, std::chrono::milliseconds(100));
    if (frame) after = frame->frame;
    took_over = frame && frame->session != first_frame->session;
  }
  EXPECT_TRUE(took_over);
  EXPECT_FALSE(second.finish().contains("rival")) << "the killed one counts as alive";
}

TEST_F(DdsProcesses, OneShotCommandsReachTheDaemonAndAreAcknowledged) {
  Peer publisher({"publish", domain(12), "60"});
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
        << observer->statistics().frames_received << " frames received; the daemon " << publisher.autopsy();
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
