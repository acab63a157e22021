// Daemons at work while readers join, leave and are killed: the memory of persistent processes must not grow.
// A few seconds by default; STRANDCAST_SOAK_SECONDS sets the duration.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/transport/dds_domain.h"
#include "tests/transport/peer.h"
#include "transport/dds.h"
#include "transport/lcm.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSampleEvery = 0.5, kVisitorEvery = 3, kCommandEvery = 10;  // s
/// Fraction of the run after which malloc arenas and the networks' tables have reached their final size.
constexpr double kWarmUpPart = 0.4;
constexpr int kStops = 4;
constexpr double kLongRun = 600;  // s, long enough to separate a slope from noise
constexpr double kMaxKbPerMinute = 30;
constexpr double kMaxShortGrowth = 4096;  // kB

double soakSeconds() {
  const char* const text = std::getenv("STRANDCAST_SOAK_SECONDS");
  return text != nullptr ? std::atof(text) : 16;
}

/// Anonymous resident memory of a process, kB (RssAnon); 0 when it has ended.
double residentKb(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string word; status >> word;) {
    double kb = 0;
    if (word == "RssAnon:" && status >> kb) return kb;
  }
  return 0;
}

struct Sample {
  double minutes, kb;
};

/// kB per minute, by least squares.
double slopeOf(const std::vector<Sample>& samples) {
  double n = 0, t = 0, m = 0, tt = 0, tm = 0;
  for (const Sample& s : samples)
    n += 1, t += s.minutes, m += s.kb, tt += s.minutes * s.minutes, tm += s.minutes * s.kb;
  return (n * tm - t * m) / (n * tt - t * t);
}

/// A process that runs to the end.
struct Resident {
  std::string name;
  std::unique_ptr<Peer> process;
  std::vector<Sample> samples;

  void sample(double seconds, double of) {
    const double kb = residentKb(process->pid());
    if (seconds >= kWarmUpPart * of && kb > 0) samples.push_back({seconds / 60, kb});
  }
};

struct Network {
  std::string name, read;  // verb of transport_peer
  int domain = 0;
};

std::vector<Network> networks() {
  std::vector<Network> out;
  if (ddsAvailable()) out.push_back({"dds", "read", testDomain(1)});
  if (lcmAvailable()) out.push_back({"lcm", "read_lcm", testDomain(2)});
  return out;
}

TEST(Soak, MemoryOfDaemonsAndReadersStaysFlat) {
  const std::vector<Network> all = networks();
  if (all.empty()) GTEST_SKIP() << "neither DDS nor LCM";
  const double seconds = soakSeconds();
  std::vector<Resident> residents;
  for (const Network& network : all) {
    const std::string domain = std::to_string(network.domain);
    // LCM repairs no losses: no codec with delta frames.
    std::vector<std::string> daemon = {
        "--scene",    "wavy",     "--strands", "200",     "--vertices",
        "16",         "--motion", "turn",      "--quiet", "--transport",
        network.name, "--domain", domain,      "--codec", network.name == "dds" ? "temporal" : "delta16"};
    residents.push_back(
        {network.name + " daemon", std::make_unique<Peer>(std::move(daemon), STRANDCAST_DAEMON), {}});
  }
  const double stop_seconds = seconds >= kLongRun ? 5 : 0.5;
  for (const Network& network : all) {
    // Making a scene may take long on a busy machine.
    const DdsOptions dds{network.domain, 1, 0, {}};
    const auto listener = network.name == "dds" ? makeDdsSubscriber(dds)
                                                : makeLcmSubscriber({lcmUrl(network.domain), 1, 0, {}});
    ASSERT_TRUE(listener->waitForGroom(std::chrono::seconds(60))) << network.name;
  }
  for (const Network& network : all) {
    const double stay = seconds + kStops * (stop_seconds + 1) + 5;
    std::vector<std::string> reader = {network.read, std::to_string(network.domain), std::to_string(stay),
                                       "0"};
    residents.push_back({network.name + " reader", std::make_unique<Peer>(std::move(reader)), {}});
  }
  for (Resident& resident : residents) {
    if (resident.name.ends_with("reader")) {
      ASSERT_TRUE(resident.process->waitFor("first_frame")) << resident.process->text();
    }
  }
  // An LCM queue keeps the memory of its longest backlog, so a backlog is provoked before memory is sampled.
  for (int stop = 0; stop < kStops; ++stop) {
    for (const Resident& resident : residents) {
      if (resident.name.ends_with("reader")) kill(resident.process->pid(), SIGSTOP);
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(stop_seconds));
    for (const Resident& resident : residents) kill(resident.process->pid(), SIGCONT);
    std::this_thread::sleep_for(std::chrono::duration<double>(1));
  }
  size_t waves = 0, visitors = 0, killed = 0, commands = 0;
  std::vector<std::unique_ptr<Peer>> visiting;
  double visitor_due = 2, command_due = 4;
  const auto start = Clock::now();
  for (double now = 0; now < seconds; now = std::chrono::duration<double>(Clock::now() - start).count()) {
    for (Resident& resident : residents) resident.sample(now, seconds);
    if (now >= visitor_due) {
      visitor_due += kVisitorEvery;
      // Every other wave has ended by now; the others are killed while they run.
      if (waves % 2 == 0) {
        for (auto& visitor : visiting) visitor->kill(), ++killed;
      }
      visiting.clear();
      for (const Network& network : all) {
        const std::string stay = waves % 2 == 0 ? "1.5" : "60";
        visiting.push_back(std::make_unique<Peer>(
            std::vector<std::string>{network.read, std::to_string(network.domain), stay, "0"}));
        ++visitors;
      }
      ++waves;
    }
    if (now >= command_due && ddsAvailable()) {
      command_due += kCommandEvery;
      Peer sender({"send", std::to_string(all.front().domain), std::to_string(++commands)});
      sender.finish();
      EXPECT_EQ(sender.exitCode(), 0) << sender.text();
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(kSampleEvery));
  }
  visiting.clear();
  std::printf("%.0f s, %zu visitors, %zu of them killed, %zu commands\n", seconds, visitors, killed,
              commands);
  for (Resident& resident : residents) {
    ASSERT_GT(resident.samples.size(), 4u) << resident.name << ' ' << resident.process->exitReport();
    const double slope = slopeOf(resident.samples);
    const double first = resident.samples.front().kb, last = resident.samples.back().kb;
    std::printf("%-10s  %.0f kB, then %.0f kB: %.2f kB/min\n", resident.name.c_str(), first, last, slope);
    if (seconds >= kLongRun) {
      EXPECT_LT(slope, kMaxKbPerMinute) << resident.name;
    }
    EXPECT_LT(last - first, kMaxShortGrowth) << resident.name;
    if (resident.name.ends_with("reader")) {
      const Results& read = resident.process->finish();
      ASSERT_TRUE(read.contains("received")) << resident.process->text();
      EXPECT_GT(read.at("received"), 20 * seconds) << resident.name << " got less than a third of the frames";
      std::printf("%-10s  %.0f frames, %.0f lost, %.0f concealed\n", resident.name.c_str(),
                  read.at("received"), read.at("lost"), read.at("concealed"));
    }
  }
}

}  // namespace
}  // namespace strandcast
