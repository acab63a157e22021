#include "validation/wire_suite.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <thread>

#include "core/error.h"
#include "core/quantile.h"
#include "options/console.h"
#include "options/number_range.h"
#include "service/network.h"
#include "service/process.h"
#include "service/scene_simulation.h"
#include "transport/dds.h"
#include "transport/frame_queue.h"
#include "transport/lcm.h"
#include "validation/suite.h"

namespace strandcast {
namespace {

constexpr double kWarmUp = 0.5;  // s of simulation before the film begins

/// Writes all positions; false on failure.
bool writeAll(int file, std::span<const Vec3> positions) {
  const char* from = reinterpret_cast<const char*>(positions.data());
  for (size_t left = positions.size_bytes(); left > 0;) {
    const ssize_t written = write(file, from, left);
    if (written <= 0) return false;
    from += written;
    left -= static_cast<size_t>(written);
  }
  return true;
}

}  // namespace

std::unique_ptr<Film> makeFilm(int strands) {
  Settings settings;
  settings.scene.name = "wavy";
  settings.scene.strands = strands;
  settings.scene.vertices = kFilmVertices;
  // One step per frame, so that no two frames are equal.
  settings.parameters.emplace_back("time_step", std::vector<double>{1 / kFilmRate});
  Scene scene = makeScene(settings.scene, {});
  Simulation simulation = makeSimulation(scene, settings);
  auto film = std::make_unique<Film>();
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

size_t filmPlace(uint64_t number, double rate) {
  constexpr size_t kTurn = 2 * (kFilmFrames - 1);
  const size_t place = number * static_cast<size_t>(kFilmRate / rate) % kTurn;
  return place < kFilmFrames ? place : kTurn - place;
}

SharedFilm::SharedFilm(const Film& film) : file_(memfd_create("strandcast film", MFD_CLOEXEC)) {
  bool is_whole = file_ >= 0;
  for (const GuideFrame& frame : film.frames) is_whole = is_whole && writeAll(file_, frame.positions);
  if (is_whole) return;
  if (file_ >= 0) close(file_);
  throw Error("no shared memory for the film to compare with",
              fmt::format("{} guides", film.groom.guides.strands()), "choose fewer with --only");
}

SharedFilm::~SharedFilm() { close(file_); }

std::string SharedFilm::path() const { return fmt::format("/proc/{}/fd/{}", getpid(), file_); }

MappedFilm::MappedFilm(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  void* start = MAP_FAILED;
  const bool is_film = file >= 0 && fstat(file, &status) == 0 && status.st_size > 0 &&
                       static_cast<size_t>(status.st_size) % (kFilmFrames * sizeof(Vec3)) == 0;
  if (is_film) {
    vertices_ = static_cast<size_t>(status.st_size) / (kFilmFrames * sizeof(Vec3));
    start = mmap(nullptr, static_cast<size_t>(status.st_size), PROT_READ, MAP_SHARED | MAP_POPULATE, file, 0);
  }
  if (file >= 0) close(file);
  if (start == MAP_FAILED)
    throw Error("this file is not a film", path, "it is made by `strandcast validate wire`");
  positions_ = static_cast<const Vec3*>(start);
}

MappedFilm::~MappedFilm() { munmap(const_cast<Vec3*>(positions_), vertices_ * kFilmFrames * sizeof(Vec3)); }

std::span<const Vec3> MappedFilm::at(size_t place) const {
  return {positions_ + place * vertices_, vertices_};
}

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WireReading, frames_whole, frames_concealed, processor_seconds,
                                   worst_error_mm, arrivals)

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kGroomPatience = 20s, kReadyPatience = 30s, kReadingPatience = 10s;
constexpr auto kRepairTime = 1s;        // allowance for repairs of the last frames after the last was sent
constexpr uint64_t kCompareEvery = 10;  // compares every tenth frame: comparing each one would load the
                                        // machine under measurement

double worstErrorMm(std::span<const Vec3> received, std::span<const Vec3> sent) {
  if (received.size() != sent.size()) return std::numeric_limits<double>::quiet_NaN();
  double worst = 0;
  for (size_t v = 0; v < sent.size(); ++v)
    worst = worse(worst, static_cast<double>((received[v] - sent[v]).norm()));
  return 1e3 * worst;
}

int read(const WireReaderOptions& o) {
  const MappedFilm film(o.film);
  const std::unique_ptr<Subscriber> subscriber = o.transport == "lcm"
                                                     ? makeLcmSubscriber({lcmUrl(o.domain), 1, 0, {}})
                                                     : makeDdsSubscriber({o.domain, 1, 0, {}});
  if (!subscriber->waitForGroom(kGroomPatience))
    throw Error("the groom did not arrive", fmt::format("{}, domain {}", o.transport, o.domain),
                "is the network interface lo up?");
  fmt::print("ready\n");
  std::fflush(stdout);

  WireReading out;
  out.arrivals.reserve(o.last_frame);
  const double before = processorSeconds(RUSAGE_SELF);
  double comparing = 0;
  uint64_t newest = 0, looks = 0, look_due = 1;
  std::optional<Clock::time_point> end;
  while (newest < o.last_frame && !g_interrupted) {
    if (!end && inputHasEnded()) end = Clock::now() + kRepairTime;
    if (end && Clock::now() > *end) break;
    const std::shared_ptr<const GuideFrame> frame = subscriber->waitForFrame(newest, 100ms);
    if (!frame) continue;
    newest = frame->frame;
    out.arrivals.emplace_back(newest, static_cast<int64_t>(frame->arrival_time));
    if (newest < look_due || frame->strands_concealed > 0) continue;
    look_due = newest + kCompareEvery;
    ++looks;
    const double own = processorSeconds(RUSAGE_THREAD);
    out.worst_error_mm =
        worse(out.worst_error_mm, worstErrorMm(frame->positions, film.at(filmPlace(newest, o.rate))));
    comparing += processorSeconds(RUSAGE_THREAD) - own;
  }
  out.processor_seconds = processorSeconds(RUSAGE_SELF) - before - comparing;
  const ReceiveStatistics statistics = subscriber->statistics();
  out.frames_concealed = statistics.frames_concealed;
  out.frames_whole = statistics.frames_received - statistics.frames_concealed;
  if (looks == 0) out.worst_error_mm = std::numeric_limits<double>::quiet_NaN();
  fmt::print("{}\n", nlohmann::json(out).dump());
  return 0;
}

}  // namespace

std::function<int()> addWireReader(CLI::App& app) {
  const auto o = std::make_shared<WireReaderOptions>();
  app.add_option("--transport", o->transport, "dds or lcm")->check(CLI::IsMember({"dds", "lcm"}))->required();
  app.add_option("--domain", o->domain, "domain of the transport")->transform(wholeRange(0, 232))->required();
  app.add_option("--last-frame", o->last_frame, "frame number after which the reader ends")->required();
  app.add_option("--rate", o->rate, "frames per second")->check(CLI::IsMember({60.0, 120.0}))->required();
  app.add_option("--film", o->film, "file of the published frames, to compare with")->required();
  return [o] { return read(*o); };
}

WireReader::WireReader(const WireReaderOptions& options)
    : process_({"wire-reader", "--transport", options.transport, "--domain", std::to_string(options.domain),
                "--last-frame", std::to_string(options.last_frame), "--rate",
                fmt::format("{:g}", options.rate), "--film", options.film}) {}

bool WireReader::waitReady() { return process_.line(kReadyPatience) == "ready"; }

std::optional<WireReading> WireReader::reading() {
  process_.endInput();
  nlohmann::json read = nlohmann::json::parse(process_.line(kReadingPatience).value_or(""), nullptr, false);
  if (!read.is_object()) return std::nullopt;
  // JSON has no NaN: it is written as null.
  if (read["worst_error_mm"].is_null()) read["worst_error_mm"] = std::nan("");
  return read.get<WireReading>();
}

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
