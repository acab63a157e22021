// The other process of the tests over the network. Prints "key value" lines; an Error goes to standard error
// and ends it with exit code 2.
//
//   transport_peer publish DOMAIN SECONDS     daemon of groom 1 at 60 Hz, kPeerGuides x 16, 0.5 s after
//   creation transport_peer read DOMAIN SECONDS MS     reader that takes MS milliseconds over each frame
//   transport_peer send DOMAIN ID             sends one command and ends
//   transport_peer alone DOMAIN SECONDS       both of the first two where there is no network but 127.0.0.1
//   transport_peer offline DOMAIN             a reader where no interface is up
//   transport_peer lcm_alone DOMAIN           a reader over LCM where 127.0.0.1 has no route for multicast
#include <net/if.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

#include "core/error.h"
#include "dds_domain.h"
#include "sample_messages.h"
#include "transport/dds.h"
#include "transport/lcm.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kNoNamespace = 77;

/// For tests that start a peer again: prints at once, the parent reads as it comes.
void print(const char* key, double value) {
  std::printf("%s %.6f\n", key, value);
  std::fflush(stdout);
}

int publish(int domain, double seconds) {
  const auto session = static_cast<uint64_t>(getpid());
  const auto publisher = makeDdsPublisher({domain, 1, session, {Codec::kFloat32}});
  const auto start = Clock::now();
  while (Clock::now() - start < kRivalListenTime && !publisher->rivalSession()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (const auto rival = publisher->rivalSession()) {
    print("rival", static_cast<double>(*rival));
    return 0;
  }
  GroomDescription groom = uniformGroom(kPeerGuides, 16);
  groom.session = session;
  publisher->announce(groom, sampleBody(60));
  Status status;
  GuideFrame frame;
  double slowest_ms = 0;
  const auto frames = static_cast<uint64_t>(seconds * 60);
  const auto first = Clock::now();
  for (uint64_t number = 1; number <= frames; ++number) {
    std::this_thread::sleep_until(first + std::chrono::microseconds(number * 1000000 / 60));
    fillSampleFrame(groom, number, frame);
    const auto before = Clock::now();
    publisher->publish(frame);
    slowest_ms =
        std::max(slowest_ms, std::chrono::duration<double, std::milli>(Clock::now() - before).count());
    while (const auto command = publisher->takeCommand()) {
      status.last_command = command->id;
      publisher->publishStatus(status);
      print("command", static_cast<double>(command->id));
    }
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // repairs of the last frames
  print("published", static_cast<double>(frames));
  print("slowest_publish_ms", slowest_ms);
  return 0;
}

int read(int domain, double seconds, int work_ms) {
  const auto subscriber = makeDdsSubscriber({domain, 1, 0, {}});
  const auto start = Clock::now();
  if (!subscriber->waitForGroom(std::chrono::milliseconds(8000))) {
    print("groom", 0);
    return 1;
  }
  print("groom", static_cast<double>(subscriber->groom()->guides.strands()));
  print("groom_after_ms", std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  uint64_t after = 0, seen = 0, wrong = 0, skipped = 0;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end) {
    const auto frame = subscriber->waitForFrame(after, std::chrono::milliseconds(200));
    if (!frame) continue;
    if (seen == 0) print("first_frame", static_cast<double>(frame->frame));
    if (after != 0) skipped += frame->frame - after - 1;
    after = frame->frame;
    ++seen;
    wrong += isSampleFrame(*frame) ? 0 : 1;
    std::this_thread::sleep_for(std::chrono::milliseconds(work_ms));
  }
  const ReceiveStatistics statistics = subscriber->statistics();
  print("seen", static_cast<double>(seen));
  print("wrong", static_cast<double>(wrong));
  print("skipped", static_cast<double>(skipped));
  print("received", static_cast<double>(statistics.frames_received));
  print("lost", static_cast<double>(statistics.frames_lost));
  print("rejected", static_cast<double>(statistics.chunks_rejected));
  print("latency_ms_p50", statistics.latency_ms_p50);
  print("latency_ms_p99", statistics.latency_ms_p99);
  return 0;
}

int send(int domain, uint64_t id) {
  const auto subscriber = makeDdsSubscriber({domain, 1, 0, {}});
  Command command;
  command.id = id;
  subscriber->send(command);
  return 0;
}

/// Leaves the machine's network for an empty one of this process.
bool enterEmptyNetwork() { return unshare(CLONE_NEWNET) == 0 || unshare(CLONE_NEWUSER | CLONE_NEWNET) == 0; }

bool raiseLoopback() {
  const int any = socket(AF_INET, SOCK_DGRAM, 0);
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  request.ifr_flags = IFF_UP;
  const bool is_up = ioctl(any, SIOCSIFFLAGS, &request) == 0;
  close(any);
  return is_up;
}

int alone(const char* program, const char* domain, const char* seconds) {
  if (!enterEmptyNetwork() || !raiseLoopback()) return kNoNamespace;
  const char* arguments[] = {program, "publish", domain, "60", nullptr};
  pid_t daemon = 0;
  if (posix_spawn(&daemon, program, nullptr, nullptr, const_cast<char**>(arguments), environ) != 0) return 1;
  const int result = read(std::atoi(domain), std::atof(seconds), 0);
  kill(daemon, SIGKILL);
  waitpid(daemon, nullptr, 0);
  return result;
}

int lcmAlone(int domain) {
  if (!enterEmptyNetwork() || !raiseLoopback()) return kNoNamespace;
  makeLcmSubscriber({lcmUrl(domain), 1, 0, {}});
  return 0;
}

int run(int count, char** arguments) {
  const std::string verb = count > 2 ? arguments[1] : "";
  const int domain = count > 2 ? std::atoi(arguments[2]) : 0;
  if (verb == "publish" && count == 4) return publish(domain, std::atof(arguments[3]));
  if (verb == "read" && count == 5) return read(domain, std::atof(arguments[3]), std::atoi(arguments[4]));
  if (verb == "send" && count == 4) return send(domain, std::strtoull(arguments[3], nullptr, 10));
  if (verb == "alone" && count == 4) return alone(arguments[0], arguments[2], arguments[3]);
  if (verb == "offline" && count == 3) return enterEmptyNetwork() ? read(domain, 1, 0) : kNoNamespace;
  if (verb == "lcm_alone" && count == 3) return lcmAlone(domain);
  std::fprintf(stderr, "see the head of transport_peer.cc\n");
  return 2;
}

}  // namespace
}  // namespace strandcast

int main(int count, char** arguments) {
  try {
    return strandcast::run(count, arguments);
  } catch (const strandcast::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
