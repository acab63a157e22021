// The second process of the network tests. Prints "key value" lines. An Error goes to standard error and ends
// it with exit code 2.
//
//   transport_peer publish DOMAIN SECONDS     daemon of groom 1 at 60 Hz, kPeerGuides x 16 vertices, after
//                                             listening for rivals
//   transport_peer cast DOMAIN SECONDS        the same without listening; ends early on a shutdown command
//   transport_peer claim DOMAIN STRENGTH      the same for a minute, sharing the groom with others
//   transport_peer cast_lcm DOMAIN SECONDS    as cast, over LCM
//   transport_peer read DOMAIN SECONDS MS     reader that takes MS milliseconds per frame
//   transport_peer read_lcm DOMAIN SECONDS MS
//   transport_peer send DOMAIN ID             sends one command and ends
//   transport_peer alone DOMAIN SECONDS       publishes and reads where 127.0.0.1 is the only network
//   transport_peer offline DOMAIN             reader where no interface is up
//   transport_peer lcm_alone DOMAIN           reader over LCM where 127.0.0.1 has no multicast route
//
// STRANDCAST_PEER_LOSS=0.01 drops one in a hundred of the datagrams that it sends. STRANDCAST_PEER_PROFILE
// and STRANDCAST_PEER_KEYS set the DDS profile and the key folder of all but the LCM variants.
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
#include "tests/thorough.h"
#include "transport/dds.h"
#include "transport/lcm.h"
#include "transport/publisher.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kNoNamespace = 77;
// With sanitizers a handshake takes longer than kSecureConflictListenTime allows.
constexpr int kHandshakePatience = kSanitized ? 4 : 1;

/// Flushes each line, because the parent reads results while the peer runs.
void print(const char* key, double value) {
  std::printf("%s %.6f\n", key, value);
  std::fflush(stdout);
}

/// Publishes frames on time until `seconds` have passed or a shutdown command arrives.
int cast(Publisher& publisher, double seconds) {
  GroomDescription groom = uniformGroom(kPeerGuides, 16);
  groom.session = static_cast<uint64_t>(getpid());
  publisher.announce(groom, sampleBody(60));
  publisher.announceColliders(sampleColliders(groom.session));
  Status status;
  GuideFrame frame;
  double slowest_ms = 0, most_late_ms = 0;
  const auto frames = static_cast<uint64_t>(seconds * 60);
  const auto first = Clock::now();
  uint64_t number = 0;
  for (bool is_over = false; number < frames && !is_over;) {
    const auto due = first + std::chrono::microseconds(++number * 1000000 / 60);
    std::this_thread::sleep_until(due);
    fillSampleFrame(groom, number, frame);
    const auto before = Clock::now();
    publisher.publish(frame);
    const auto after = Clock::now();
    slowest_ms = std::max(slowest_ms, std::chrono::duration<double, std::milli>(after - before).count());
    most_late_ms = std::max(most_late_ms, std::chrono::duration<double, std::milli>(after - due).count());
    while (const auto command = publisher.takeCommand()) {
      status.last_command = command->id;
      publisher.publishStatus(status);
      print("command", static_cast<double>(command->id));
      is_over = command->kind == CommandKind::kShutdown;
    }
    if (number % 30 == 0) publisher.publishStatus(status);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // time for repairs of the last frames
  print("published", static_cast<double>(number));
  print("slowest_publish_ms", slowest_ms);
  print("most_late_ms", most_late_ms);
  return 0;
}

DdsOptions ddsOptions(int domain) {
  DdsOptions options{domain, 1, static_cast<uint64_t>(getpid()), {Codec::kFloat32}};
  if (const char* const profile = std::getenv("STRANDCAST_PEER_PROFILE"))
    options.profile = ddsProfileNamed(profile, "STRANDCAST_PEER_PROFILE");
  if (const char* const keys = std::getenv("STRANDCAST_PEER_KEYS")) options.keys = keys;
  return options;
}

int publish(int domain, double seconds) {
  const auto publisher = makeDdsPublisher(ddsOptions(domain));
  const auto start = Clock::now();
  const auto listen_time =
      ddsOptions(domain).keys.empty() ? kConflictListenTime : kHandshakePatience * kSecureConflictListenTime;
  while (Clock::now() - start < listen_time && !publisher->conflict()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (const auto conflict = publisher->conflict()) {
    print("rival", static_cast<double>(conflict->session));
    return 0;
  }
  return cast(*publisher, seconds);
}

int read(std::unique_ptr<Subscriber> subscriber, double seconds, int work_ms) {
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
    if (seen == 0) {
      print("first_frame_after_ms", std::chrono::duration<double, std::milli>(Clock::now() - start).count());
      print("first_frame", static_cast<double>(frame->frame));
    }
    if (after != 0) skipped += frame->frame - after - 1;
    after = frame->frame;
    ++seen;
    wrong += frame->strands_concealed > 0 || isSampleFrame(*frame) ? 0 : 1;
    std::this_thread::sleep_for(std::chrono::milliseconds(work_ms));
  }
  const ReceiveStatistics statistics = subscriber->statistics();
  print("seen", static_cast<double>(seen));
  print("wrong", static_cast<double>(wrong));
  print("skipped", static_cast<double>(skipped));
  print("received", static_cast<double>(statistics.frames_received));
  print("lost", static_cast<double>(statistics.frames_lost));
  print("concealed", static_cast<double>(statistics.frames_concealed));
  print("strands_concealed", static_cast<double>(statistics.strands_concealed));
  print("rejected", static_cast<double>(statistics.chunks_rejected));
  print("latency_ms_p50", statistics.latency_ms_p50);
  print("latency_ms_p99", statistics.latency_ms_p99);
  return 0;
}

int send(int domain, uint64_t id) {
  const auto subscriber = makeDdsSubscriber(ddsOptions(domain));
  Command command;
  command.id = id;
  subscriber->send(command);
  return 0;
}

/// Moves this process to an empty network namespace.
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
  const int result = read(makeDdsSubscriber(ddsOptions(std::atoi(domain))), std::atof(seconds), 0);
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
  if (verb == "cast" && count == 4)
    return cast(*makeDdsPublisher(ddsOptions(domain)), std::atof(arguments[3]));
  if (verb == "claim" && count == 4) {
    DdsOptions options = ddsOptions(domain);
    options.claim = static_cast<uint32_t>(std::atoi(arguments[3]));
    return cast(*makeDdsPublisher(options), 60);
  }
  if (verb == "cast_lcm" && count == 4) {
    const CodecOptions codec{Codec::kFloat32};
    return cast(*makeLcmPublisher({lcmUrl(domain), 1, static_cast<uint64_t>(getpid()), codec}),
                std::atof(arguments[3]));
  }
  if (verb == "read" && count == 5)
    return read(makeDdsSubscriber(ddsOptions(domain)), std::atof(arguments[3]), std::atoi(arguments[4]));
  if (verb == "read_lcm" && count == 5)
    return read(makeLcmSubscriber({lcmUrl(domain), 1, 0, {}}), std::atof(arguments[3]),
                std::atoi(arguments[4]));
  if (verb == "send" && count == 4) return send(domain, std::strtoull(arguments[3], nullptr, 10));
  if (verb == "alone" && count == 4) return alone(arguments[0], arguments[2], arguments[3]);
  if (verb == "offline" && count == 3)
    return enterEmptyNetwork() ? read(makeDdsSubscriber(ddsOptions(domain)), 1, 0) : kNoNamespace;
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
