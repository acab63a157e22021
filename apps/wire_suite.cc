#include "apps/wire_suite.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <thread>

#include "apps/daemon.h"
#include "apps/interrupt.h"
#include "apps/processor_time.h"
#include "apps/wire_film.h"
#include "apps/wire_reader.h"
#include "core/quantile.h"
#include "transport/dds.h"
#include "transport/frame_queue.h"
#include "transport/lcm.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSeconds = 2;  // duration of a case
// s, where the 99th percentile of the latency has a limit: with 600 frames a hundredth is more than one
// outlier.
constexpr double kPromisedSeconds = 10;
constexpr double kUnloadedSeconds = 1.5;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kMaxErrorMm = 0.01;

struct Setting {
  std::string transport;
  Codec codec = Codec::kDelta16;
  int strands = 0;
  double rate = 0;

  std::string name() const {
    return fmt::format("{} {} {}x{} {:g} Hz", transport, nameOf(codec), strands, kFilmVertices, rate);
  }
};

/// A film and its copy for the reader. Large: only the newest is kept.
struct Showing {
  explicit Showing(int strands) : film(makeFilm(strands)), shared(*film) {}
  std::unique_ptr<Film> film;
  SharedFilm shared;
};

Showing& showingOf(int strands) {
  static std::unique_ptr<Showing> newest;
  if (!newest || newest->film->groom.guides.strands() != static_cast<size_t>(strands)) {
    newest.reset();
    newest = std::make_unique<Showing>(strands);
  }
  return *newest;
}

std::unique_ptr<Publisher> makePublisher(const Setting& setting, int domain) {
  const CodecOptions codec{setting.codec, static_cast<float>(1e-3 * kMaxErrorMm)};
  if (setting.transport == "lcm") return makeLcmPublisher({lcmUrl(domain), 1, newSession(), codec});
  return makeDdsPublisher({domain, 1, newSession(), codec});
}

std::vector<std::string> caseNames(const Setting& setting) {
  const std::string name = setting.name();
  return {name + " bytes per vertex", name + " error",     name + " lost",  name + " latency p50",
          name + " latency p99",      name + " publisher", name + " reader"};
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

void sleepUntilFrame(Clock::time_point start, uint64_t number, double rate) {
  std::this_thread::sleep_until(start +
                                std::chrono::duration_cast<Clock::duration>(
                                    std::chrono::duration<double>(static_cast<double>(number) / rate)));
}

/// Measurements of a film that was sent.
struct Cast {
  uint64_t frames = 0, bytes = 0;
  EncodingReport encoding;       // of the last frame
  double seconds = 0;            // s, from the first to the last frame
  double processor_seconds = 0;  // s, of the publisher's process
  WireReading read;
  std::vector<double> latencies_ms;  // by the steady clock, which both processes share
  std::string failure;               // of the reader; if not empty, all other members are invalid
};

/// Sends from this process to a reader process of its own.
Cast castTo(const Setting& setting, Showing& showing, double seconds) {
  if (g_interrupted) throw Laboratory::Stopped();
  const int domain = 3 + static_cast<int>(getpid() % 98);  // a domain whose ports are not in the ephemeral
                                                           // range
  Cast cast;
  cast.frames = static_cast<uint64_t>(seconds * setting.rate);
  const std::unique_ptr<Publisher> publisher = makePublisher(setting, domain);
  publisher->announce(showing.film->groom, showing.film->body);
  WireReader reader({setting.transport, domain, cast.frames, setting.rate, showing.shared.path()});
  const auto failed = [&] {
    if (g_interrupted) throw Laboratory::Stopped();
    cast.failure = reader.failure();
    return cast;
  };
  if (!reader.waitReady()) return failed();
  // A publisher whose reader is not matched yet would seem to lose frames.
  for (int i = 0; i < 1000 && publisher->matchedReaders() == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));

  std::vector<uint64_t> sent(cast.frames + 1);
  const double before = processorSeconds(RUSAGE_SELF);
  const Clock::time_point start = Clock::now();
  for (uint64_t number = 1; number <= cast.frames; ++number) {
    if (g_interrupted) throw Laboratory::Stopped();
    sleepUntilFrame(start, number, setting.rate);
    GuideFrame& frame = showing.film->frames[filmPlace(number, setting.rate)];
    frame.frame = number;
    frame.simulation_time = static_cast<double>(number) / setting.rate;
    frame.publish_time = systemTime();
    sent[number] = steadyTime();
    publisher->publish(frame);
    cast.bytes += publisher->encoding().frame_bytes;
  }
  cast.processor_seconds = processorSeconds(RUSAGE_SELF) - before;
  cast.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  cast.encoding = publisher->encoding();
  const std::optional<WireReading> read = reader.reading();
  if (!read) return failed();
  cast.read = *read;
  for (const auto& [number, arrival] : cast.read.arrivals)
    cast.latencies_ms.push_back(1e-6 * static_cast<double>(arrival - static_cast<int64_t>(sent.at(number))));
  return cast;
}

/// Quantile `part` of the latency, ms; NaN where no frame arrived.
double latencyOf(const Cast& cast, double part) {
  return cast.latencies_ms.empty() ? kUnknown : quantileOf(cast.latencies_ms, part);
}

/// The 99th percentile of the latency, ms, for frames of a single strand: the floor set by this machine and
/// its network. Measured once per transport and rate.
double unloadedLatency(Setting setting) {
  static std::map<std::pair<std::string, double>, double> measured;
  const auto [place, is_new] = measured.try_emplace({setting.transport, setting.rate}, 0);
  if (!is_new) return place->second;
  static Showing showing(1);
  setting.codec = Codec::kFloat32;
  const Cast cast = castTo(setting, showing, kUnloadedSeconds);
  return place->second = latencyOf(cast, 0.99);
}

double loadAverage() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : 0;
}

std::vector<Case> casesOf(const Setting& setting) {
  const double load = loadAverage(), unloaded_ms = unloadedLatency(setting);
  const bool is_promised = setting.transport == "dds" && setting.strands <= 5000 && setting.rate <= 60;
  const Cast cast = castTo(setting, showingOf(setting.strands), is_promised ? kPromisedSeconds : kSeconds);
  const auto names = caseNames(setting);
  std::vector<Case> cases;
  const auto add = [&](const char* quantity, const char* unit, double measured, double limit) {
    const bool is_known = cast.failure.empty();
    cases.push_back(
        absoluteCase({names[cases.size()], quantity, unit}, is_known ? measured : kUnknown, 0, limit));
    cases.back().note = cast.failure;
  };
  const auto note = [&](const std::string& text) {
    if (cast.failure.empty()) cases.back().note = text;
  };
  const auto frames = static_cast<double>(cast.frames);
  add("payload bytes per vertex, mean", "",
      static_cast<double>(cast.bytes) / (frames * setting.strands * kFilmVertices),
      bytesLimit(setting.codec) * (1 + 1e-12));
  add("worst distance of a received vertex", "mm", cast.read.worst_error_mm,
      setting.codec == Codec::kFloat32 ? 0 : kMaxErrorMm * 1.000001);
  if (std::isnan(cast.read.worst_error_mm)) note("no frame arrived completely");
  add("frames that did not arrive completely", "frames", frames - static_cast<double>(cast.read.frames_whole),
      is_promised ? 0 : kUnlimited);
  note(fmt::format("{} frames; {} concealed; {} strands sent finer in the last", cast.frames,
                   cast.read.frames_concealed, cast.encoding.strands_sent_finer));
  add("publish to decoded, median", "ms", latencyOf(cast, 0.5), kUnlimited);
  add("publish to decoded, 99th percentile", "ms", latencyOf(cast, 0.99), is_promised ? 5 : kUnlimited);
  note(fmt::format("of {} frames; unloaded {:.3f} ms; load average {:.2f} before", cast.latencies_ms.size(),
                   unloaded_ms, load));
  add("processor time of the process that encodes and sends, of one core", "%",
      100 * cast.processor_seconds / cast.seconds, kUnlimited);
  add("processor time of the process that receives and decodes, of one core", "%",
      100 * cast.read.processor_seconds / cast.seconds, kUnlimited);
  return cases;
}

Suite makeWireSuite() {
  Suite suite{"wire",
              "bytes, error, losses, latency and processor time of simulated hair published between two "
              "processes (5 minutes)",
              {}};
  std::vector<std::string> transports;
  if (ddsAvailable()) transports.emplace_back("dds");
  if (lcmAvailable()) transports.emplace_back("lcm");
  for (const int strands : {1000, 5000, 20000}) {
    for (const double rate : {60.0, 120.0}) {
      for (const std::string& transport : transports) {
        for (const CodecInfo& info : codecList()) {
          if (transport == "lcm" && info.codec == Codec::kTemporal) continue;
          const Setting setting{transport, info.codec, strands, rate};
          suite.experiments.push_back({setting.name(), caseNames(setting),
                                       [setting](const Laboratory&) { return casesOf(setting); }});
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
