#include "apps/wire_suite.h"

#include <fmt/format.h>
#include <time.h>
#include <unistd.h>

#include <chrono>
#include <limits>
#include <map>
#include <thread>

#include "apps/daemon.h"
#include "apps/interrupt.h"
#include "apps/scene_simulation.h"
#include "core/error.h"
#include "transport/dds.h"
#include "transport/frame_queue.h"
#include "transport/lcm.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kVertices = 32;
constexpr size_t kFilmFrames = 32;
constexpr double kFilmRate = 120;  // frames per second of simulation time
constexpr double kWarmUp = 0.5;    // s of simulation before the film
constexpr double kSeconds = 2;     // of casting
constexpr double kUnloadedSeconds = 1.5;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr double kMaxErrorMm = 0.01;

struct Setting {
  std::string transport;
  Codec codec = Codec::kDelta16;
  int strands = 0;
  double rate = 0;

  std::string name() const {
    return fmt::format("{} {} {}x{} {:g} Hz", transport, nameOf(codec), strands, kVertices, rate);
  }
};

/// Hair in motion, simulated before it is cast: what is measured is the wire alone.
struct Film {
  GroomDescription groom;
  BodyDescription body;
  std::vector<GuideFrame> frames;

  /// To and fro, so that it never jumps; every so many frames of the film.
  const GuideFrame& at(uint64_t number, size_t stride) const {
    const size_t turn = 2 * (frames.size() - 1), place = number * stride % turn;
    return frames[place < frames.size() ? place : turn - place];
  }
};

std::shared_ptr<const Film> makeFilm(int strands) {
  Settings settings;
  settings.scene.name = "wavy";
  settings.scene.strands = strands;
  settings.scene.vertices = kVertices;
  settings.parameters.emplace_back("time_step", std::vector<double>{1 / kFilmRate});  // no picture twice
  Scene scene = makeScene(settings.scene, {});
  Simulation simulation = makeSimulation(scene, settings);
  auto film = std::make_shared<Film>();
  film->groom.name = scene.name;
  film->groom.revision = 1;
  film->groom.guides = scene.groom.strands;
  film->body.mesh = scene.body;
  film->body.head_weights = scene.head_weights;
  film->frames.resize(kFilmFrames);
  const double step = simulation.parameters().time_step;
  double due = kWarmUp;
  for (GuideFrame& frame : film->frames) {
    for (; simulation.time() < due - step / 2; simulation.step())
      simulation.setHeadPose(scene.motion(simulation.time() + step));
    due += 1 / kFilmRate;
    const std::span<const Vec3> guides = simulation.guides();
    frame.positions.assign(guides.begin(), guides.end());
    frame.head = simulation.headPose();
    frame.revision = 1;
  }
  return film;
}

std::shared_ptr<const Film> filmOf(int strands) {
  static std::shared_ptr<const Film> newest;  // large: only one is kept
  if (!newest || newest->groom.guides.strands() != static_cast<size_t>(strands)) {
    newest.reset();
    newest = makeFilm(strands);
  }
  return newest;
}

double cpuSeconds(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::pair<std::unique_ptr<Publisher>, std::unique_ptr<Subscriber>> makeEnds(const Setting& setting) {
  const int domain = 3 + static_cast<int>(getpid() % 98);  // with ports that nothing is given by chance
  const CodecOptions codec{setting.codec, static_cast<float>(1e-3 * kMaxErrorMm)};
  if (setting.transport == "lcm") {
    return {makeLcmPublisher({lcmUrl(domain), 1, newSession(), codec}),
            makeLcmSubscriber({lcmUrl(domain), 1, 0, {}})};
  }
  return {makeDdsPublisher({domain, 1, newSession(), codec}), makeDdsSubscriber({domain, 1, 0, {}})};
}

std::vector<std::string> caseNames(const Setting& setting) {
  const std::string name = setting.name();
  return {name + " bytes per vertex", name + " error", name + " lost", name + " latency p99"};
}

double bytesLimit(Codec codec) {
  switch (codec) {
    case Codec::kFloat32:
      return 12;
    case Codec::kTangent:
      return 2.5;
    case Codec::kTemporal:
      return 1.6;
    case Codec::kDelta16:
    case Codec::kOctahedral12:
      return 4;
    case Codec::kOctahedral16:
      break;
  }
  return kUnlimited;
}

double worstErrorMm(const GuideFrame& received, const GuideFrame& sent) {
  double worst = 0;
  for (size_t v = 0; v < sent.positions.size(); ++v)
    worst = worse(worst, static_cast<double>((received.positions[v] - sent.positions[v]).norm()));
  return 1e3 * worst;
}

/// Until the reader has the groom and both ends know each other: an end that does not know its reader yet
/// would seem to lose frames.
void join(Publisher& publisher, Subscriber& subscriber, const Film& film, const Setting& setting) {
  publisher.announce(film.groom, film.body);
  if (!subscriber.waitForGroom(std::chrono::seconds(20)))
    throw Error("the groom does not arrive", setting.name(), "is the network interface lo up?");
  for (int i = 0; i < 1000 && publisher.matchedReaders() == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

void sleepUntilFrame(Clock::time_point start, uint64_t number, double rate) {
  std::this_thread::sleep_until(start +
                                std::chrono::duration_cast<Clock::duration>(
                                    std::chrono::duration<double>(static_cast<double>(number) / rate)));
}

void stamp(GuideFrame& frame, uint64_t number, double rate) {
  frame.frame = number;
  frame.simulation_time = static_cast<double>(number) / rate;
  frame.publish_time = systemTime();
}

/// The 99th percentile of the latency, ms, of frames with next to nothing in them: what this machine and its
/// network take whatever is cast. Measured once per transport and rate.
double unloadedLatency(Setting setting) {
  static std::map<std::pair<std::string, double>, double> measured;
  const auto [place, is_new] = measured.try_emplace({setting.transport, setting.rate}, 0);
  if (!is_new) return place->second;
  static const std::shared_ptr<const Film> film = makeFilm(1);
  setting.codec = Codec::kFloat32;
  const auto [publisher, subscriber] = makeEnds(setting);
  join(*publisher, *subscriber, *film, setting);
  const Clock::time_point start = Clock::now();
  GuideFrame frame = film->frames.front();
  for (uint64_t number = 1; number <= static_cast<uint64_t>(kUnloadedSeconds * setting.rate); ++number) {
    if (g_interrupted) throw Laboratory::Stopped();
    sleepUntilFrame(start, number, setting.rate);
    stamp(frame, number, setting.rate);
    publisher->publish(frame);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  return place->second = subscriber->statistics().latency_ms_p99;
}

std::vector<Case> cast(const Setting& setting) {
  const double unloaded_ms = unloadedLatency(setting);
  const std::shared_ptr<const Film> film = filmOf(setting.strands);
  const auto [publisher, subscriber] = makeEnds(setting);
  join(*publisher, *subscriber, *film, setting);

  const auto stride = static_cast<size_t>(kFilmRate / setting.rate);
  const auto frames = static_cast<uint64_t>(kSeconds * setting.rate);
  const double vertices = static_cast<double>(film->groom.guides.vertices());
  GuideFrame frame;
  uint64_t bytes = 0;
  double error_mm = 0, daemon_cpu = 0, checking_cpu = 0;
  const double cpu_before = cpuSeconds(CLOCK_PROCESS_CPUTIME_ID);
  const double own_before = cpuSeconds(CLOCK_THREAD_CPUTIME_ID);
  const Clock::time_point start = Clock::now();
  std::shared_ptr<const GuideFrame> last;
  for (uint64_t number = 1; number <= frames; ++number) {
    if (g_interrupted) throw Laboratory::Stopped();
    sleepUntilFrame(start, number, setting.rate);
    frame = film->at(number, stride);
    stamp(frame, number, setting.rate);
    const double before = cpuSeconds(CLOCK_THREAD_CPUTIME_ID);
    publisher->publish(frame);
    daemon_cpu += cpuSeconds(CLOCK_THREAD_CPUTIME_ID) - before;
    bytes += publisher->encoding().frame_bytes;
    // Not each one: that would take the machine from the threads that are measured.
    if (number % 10 == 0 && (last = subscriber->frame()) && last->strands_concealed == 0)
      error_mm = worse(error_mm, worstErrorMm(*last, film->at(last->frame, stride)));
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  // The last frames may still be repaired.
  for (int i = 0; i < 200 && (!subscriber->frame() || subscriber->frame()->frame < frames); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  checking_cpu = cpuSeconds(CLOCK_THREAD_CPUTIME_ID) - own_before - daemon_cpu;
  const double client_cpu = cpuSeconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_before - daemon_cpu - checking_cpu;

  const ReceiveStatistics received = subscriber->statistics();
  const auto whole = static_cast<double>(received.frames_received - received.frames_concealed);
  const bool is_promised = setting.transport == "dds" && setting.strands <= 5000 && setting.rate <= 60;
  const auto names = caseNames(setting);
  std::vector<Case> cases;
  const auto add = [&](const char* quantity, const char* unit, double measured, double limit) {
    cases.push_back(absoluteCase({names[cases.size()], quantity, unit}, measured, 0, limit));
  };
  add("payload bytes per vertex, mean", "",
      static_cast<double>(bytes) / (static_cast<double>(frames) * vertices),
      bytesLimit(setting.codec) * (1 + 1e-12));
  add("worst distance of a received vertex", "mm", error_mm,
      setting.codec == Codec::kFloat32 ? 0 : kMaxErrorMm * 1.000001);
  add("frames that did not come whole", "frames", static_cast<double>(frames) - whole,
      is_promised ? 0 : kUnlimited);
  cases.back().note = fmt::format("{} frames; {} concealed; {} strands sent finer in the last", frames,
                                  received.frames_concealed, publisher->encoding().strands_sent_finer);
  add("publish to decoded, 99th percentile", "ms", received.latency_ms_p99, is_promised ? 5 : kUnlimited);
  cases.back().note = fmt::format(
      "median {:.3f} ms, 99th percentile unloaded {:.3f} ms; of one core, encoding and sending {:.1f} %, "
      "receiving {:.1f} %",
      received.latency_ms_p50, unloaded_ms, 100 * daemon_cpu / seconds, 100 * client_cpu / seconds);
  return cases;
}

Suite makeWireSuite() {
  Suite suite{
      "wire", "bytes, error, losses and latency of simulated hair cast on this machine (2 minutes)", {}};
  std::vector<std::string> transports;
  if (ddsAvailable()) transports.emplace_back("dds");
  if (lcmAvailable()) transports.emplace_back("lcm");
  for (const int strands : {1000, 5000, 20000}) {
    for (const double rate : {60.0, 120.0}) {
      for (const std::string& transport : transports) {
        for (const CodecInfo& info : codecList()) {
          if (transport == "lcm" && info.codec == Codec::kTemporal) continue;
          const Setting setting{transport, info.codec, strands, rate};
          suite.experiments.push_back(
              {setting.name(), caseNames(setting), [setting](const Laboratory&) { return cast(setting); }});
        }
      }
    }
  }
  return suite;
}

}  // namespace

const Suite& wireSuite() {
  static const Suite suite = makeWireSuite();
  return suite;
}

}  // namespace strandcast
