#include "bench/reader_process.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <memory>

#include "core/error.h"
#include "transport/dds.h"
#ifdef STRANDCAST_HAS_RENDER
#include "gl/context.h"
#include "render/hair_pass.h"
#endif

namespace strandcast {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 60s;  // longer than the reader waits for its groom

struct ReaderOptions {
  int domain = 0, hairs = 0, segments = 31;
  uint64_t last_frame = 1;
};

int64_t steadyNanoseconds() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

#ifdef STRANDCAST_HAS_RENDER
/// A head of hair, grown from each frame.
class Grower {
 public:
  Grower(const StrandSet& guides, int hairs, int segments)
      : nodes_(segments), pass_(GrowthPath::kCompute, HairGeometry::kLines) {
    nodes_.setGroom(guides);
    HairGrowth growth;
    growth.hairs = static_cast<size_t>(hairs);
    pass_.setHairs(growHairs(guides, growth), growth);
  }
  const std::string& renderer() const { return context_.renderer(); }
  /// Returns after the device has finished.
  void grow(const GuideFrame& frame) {
    nodes_.update(frame.positions, frame.head);
    pass_.grow(nodes_, pass_.all());
    const GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    constexpr GLuint64 kSecond = 1'000'000'000;
    while (glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, kSecond) == GL_TIMEOUT_EXPIRED) {
    }
    glDeleteSync(fence);
  }

 private:
  gl::HeadlessContext context_;
  GuideNodes nodes_;
  HairPass pass_;
};
#else
class Grower {
 public:
  Grower(const StrandSet&, int, int) {
    throw Error("this build cannot grow hair", "--hairs", "build with OpenGL, or leave growth out");
  }
  std::string renderer() const { return ""; }
  void grow(const GuideFrame&) {}
};
#endif

int read(const ReaderOptions& o) {
  const std::unique_ptr<Subscriber> subscriber = makeDdsSubscriber({o.domain, 1, 0, {}});
  if (!subscriber->waitForGroom(30s))
    throw Error("the groom did not arrive", fmt::format("domain {}", o.domain),
                "is a daemon running on this domain?");
  std::unique_ptr<Grower> grower;
  if (o.hairs > 0) {
    grower = std::make_unique<Grower>(subscriber->groom()->guides, o.hairs, o.segments);
    GuideFrame rest;
    rest.positions = subscriber->groom()->guides.positions;
    grower->grow(rest);  // compiles the shaders
  }
  fmt::print("ready\n");
  std::fflush(stdout);

  std::vector<std::array<int64_t, 4>> frames;
  frames.reserve(o.last_frame);
  uint64_t newest = 0;
  while (newest < o.last_frame) {
    if (!subscriber->waitForFrame(newest, newest == 0 ? 30s : 3s)) break;
    const std::shared_ptr<const GuideFrame> frame = subscriber->frame();  // newest only
    const int64_t taken = steadyNanoseconds();
    if (grower) grower->grow(*frame);
    newest = frame->frame;
    frames.push_back({static_cast<int64_t>(newest), static_cast<int64_t>(frame->arrival_time), taken,
                      steadyNanoseconds()});
  }
  const ReceiveStatistics statistics = subscriber->statistics();
  nlohmann::json out{{"received", statistics.frames_received},
                     {"lost", statistics.frames_lost},
                     {"latency_ms_p50", statistics.latency_ms_p50},
                     {"latency_ms_p99", statistics.latency_ms_p99},
                     {"renderer", grower ? nlohmann::json(grower->renderer()) : nlohmann::json()},
                     {"frames", frames}};
  fmt::print("{}\n", out.dump());
  return 0;
}

}  // namespace

std::function<int()> addReader(CLI::App& app) {
  const auto o = std::make_shared<ReaderOptions>();
  app.add_option("--domain", o->domain, "DDS domain")->check(CLI::Range(0, 232))->required();
  app.add_option("--last-frame", o->last_frame, "frame number after which the reader process ends")
      ->required();
  app.add_option("--hairs", o->hairs, "hairs grown per frame; 0 = none")->check(CLI::Range(0, 4000000));
  app.add_option("--segments", o->segments, "segments per hair")->check(CLI::Range(1, 256));
  return [o] { return read(*o); };
}

ReaderProcess::ReaderProcess(int domain, uint64_t last_frame, int hairs, int segments)
    : process_({"reader", "--domain", std::to_string(domain), "--last-frame", std::to_string(last_frame),
                "--hairs", std::to_string(hairs), "--segments", std::to_string(segments)}) {}

void ReaderProcess::waitReady() {
  if (process_.line(kPatience) != "ready")
    throw Error("the reader process " + process_.end(), "strandbench reader", "see its message above");
}

nlohmann::json ReaderProcess::report() {
  nlohmann::json out = nlohmann::json::parse(process_.line(kPatience).value_or(""), nullptr, false);
  if (!out.is_object())
    throw Error("the reader process " + process_.end(), "strandbench reader", "see its message above");
  return out;
}

int benchDomain() { return 102 + static_cast<int>(getpid() % 98); }

}  // namespace strandcast
