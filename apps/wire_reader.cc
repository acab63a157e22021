#include "apps/wire_reader.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/interrupt.h"
#include "apps/number_range.h"
#include "apps/processor_time.h"
#include "apps/wire_film.h"
#include "core/error.h"
#include "transport/dds.h"
#include "transport/lcm.h"
#include "validation/case.h"

namespace strandcast {

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

Verb addWireReader(CLI::App& app) {
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

}  // namespace strandcast
