#include "service/show_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

#include "core/quantile.h"
#include "options/console.h"
#include "options/scene_loading.h"
#include "service/colliders.h"
#include "service/scene_simulation.h"
#include "transport/codec/guide_encoder.h"

namespace strandcast {
namespace {

using CostClock = std::chrono::steady_clock;

double costMs(CostClock::time_point start) {
  return std::chrono::duration<double, std::milli>(CostClock::now() - start).count();
}

/// Bytes of the distance fields that bodies collide through.
size_t fieldBytes(const std::vector<RigidBody>& bodies) {
  size_t bytes = 0;
  for (const RigidBody& body : bodies)
    for (const ContactPrimitive& shape : body.primitives)
      if (shape.field) bytes += shape.field->bytes();
  return bytes;
}

/// Encodes published frames of a simulation and remembers times and bytes.
class FrameCost {
 public:
  FrameCost(const StrandSet& guides, const CodecOptions& codec) : encoder_(codec) {
    encoder_.setGroom(guides);
  }

  void add(Simulation& simulation) {
    const std::span<const Vec3> guides = simulation.guides();
    ++frame_.frame;
    frame_.positions.assign(guides.begin(), guides.end());
    frame_.head = simulation.headPose();
    frame_.colliders = placedColliders(simulation);
    frame_.simulation_time = simulation.time();
    const CostClock::time_point start = CostClock::now();
    encoder_.encodeAll(frame_, [](GuideChunk&) {});
    ms_.push_back(costMs(start));
    bytes_ += encoder_.report().frame_bytes;
  }

  double medianMs() const { return quantileOf(ms_, 0.5); }
  uint64_t meanBytes() const { return ms_.empty() ? 0 : bytes_ / ms_.size(); }

 private:
  GuideEncoder encoder_;
  GuideFrame frame_;
  std::vector<double> ms_;
  uint64_t bytes_ = 0;
};

}  // namespace

ShowCost measureShowCost(const Scene& scene, const Settings& settings,
                         const std::function<void(double part)>& progress) {
  constexpr double kSeconds = 1;        // of simulated time
  constexpr size_t kStepsToWarmUp = 3;  // with them, programs are compiled and memory is mapped
  Simulation simulation = makeSimulation(scene, settings);
  const auto time_step = static_cast<double>(simulation.parameters().time_step);
  ShowCost out;
  out.backend = simulation.backend().name();
  out.device = simulation.backend().device();
  out.codec = nameOf(settings.codec.codec);
  out.strands = simulation.model().strands();
  out.vertices = simulation.model().vertices();
  out.steps_per_frame = 1 / (settings.rate * time_step);
  out.memory_bytes = out.vertices * kBytesPerVertex + fieldBytes(scene.bodies);
  FrameCost frames(scene.groom.strands, settings.codec);
  std::vector<double> ms;
  const CostClock::time_point start = CostClock::now();
  const auto steps = static_cast<size_t>(std::ceil(kSeconds / time_step)) + kStepsToWarmUp;
  for (size_t step = 0; step < steps; ++step) {
    if (g_interrupted) throw Interrupted();
    const double spent = costMs(start) / 1e3;
    if (spent > kLongestCostRun && !ms.empty()) break;
    if (progress)
      progress(std::max(static_cast<double>(step) / static_cast<double>(steps), spent / kLongestCostRun));
    const CostClock::time_point begin = CostClock::now();
    const double end = simulation.time() + time_step;
    moveTo(scene.skinned.get(), end, scene.motion(end), simulation);
    simulation.step();
    out.strands_reset += simulation.resetDiverged();  // synchronises with the backend
    if (step >= kStepsToWarmUp) ms.push_back(costMs(begin));
    const auto published = [&](double count) { return std::floor(count / out.steps_per_frame); };
    const auto done = static_cast<double>(step);
    if (published(done + 1) > published(done)) frames.add(simulation);
  }
  if (frames.meanBytes() == 0) frames.add(simulation);
  out.steps = ms.size();
  out.step_ms_median = quantileOf(ms, 0.5);
  out.step_ms_p95 = quantileOf(ms, 0.95);
  out.encode_ms_median = frames.medianMs();
  out.bytes_per_frame = frames.meanBytes();
  const Measurement last = simulation.measure();
  out.max_stretch = last.max_stretch;
  out.max_penetration = last.max_penetration;
  return out;
}

CheckReport checkCost(const ShowCost& cost, double rate) {
  constexpr double kMuchStretch = 0.01, kMuchPenetration = 5e-3;  // relative; m
  CheckReport out;
  const double interval = 1e3 / rate;
  const double needed = cost.steps_per_frame * cost.step_ms_median + cost.encode_ms_median;
  const double share = needed / interval;
  const CheckSeverity severity = share > 1            ? CheckSeverity::kFault
                                 : share > kFullFrame ? CheckSeverity::kWarning
                                                      : CheckSeverity::kOk;
  out.add({severity, "frame_time",
           fmt::format(
               "a frame takes {:.2f} ms of {:.2f} ms at {:g} frames per second: {:.3g} steps of {:.2f} ms "
               "(95 % below {:.2f}) and {:.2f} ms of encoding, on {} ({})",
               needed, interval, rate, cost.steps_per_frame, cost.step_ms_median, cost.step_ms_p95,
               cost.encode_ms_median, cost.backend, cost.device),
           needed, "ms", "",
           severity == CheckSeverity::kOk
               ? ""
               : "simulate fewer guides (--strands), a lower --rate, or another --backend"});
  out.add({CheckSeverity::kOk, "memory",
           fmt::format("about {:.1f} MiB for {} strands, {} vertices and the bodies' fields",
                       static_cast<double>(cost.memory_bytes) / (1 << 20), cost.strands, cost.vertices),
           static_cast<double>(cost.memory_bytes), "bytes"});
  const auto bytes = static_cast<double>(cost.bytes_per_frame);
  out.add({CheckSeverity::kOk, "wire",
           fmt::format("{} bytes per frame as {} ({:.2f} per vertex), {:.1f} Mbit/s", cost.bytes_per_frame,
                       cost.codec, bytes / static_cast<double>(std::max<size_t>(cost.vertices, 1)),
                       8e-6 * bytes * rate),
           bytes, "bytes"});
  const bool breaks = cost.strands_reset > 0, stretches = cost.max_stretch > kMuchStretch;
  const bool enters = cost.max_penetration > kMuchPenetration;
  out.add({breaks                ? CheckSeverity::kFault
           : stretches || enters ? CheckSeverity::kWarning
                                 : CheckSeverity::kOk,
           "run",
           fmt::format("after {} steps: {} strands broke, stretch {:.3g} %, {:.2f} mm inside bodies at most",
                       cost.steps, cost.strands_reset, 1e2 * cost.max_stretch, 1e3 * cost.max_penetration),
           static_cast<double>(cost.strands_reset), "strands", "",
           breaks || stretches || enters
               ? "look at the strands above; see `strandcast render` of the same files"
               : ""});
  return out;
}

}  // namespace strandcast
