#include "options/scene_loading.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "collision/field_cache.h"
#include "core/error.h"
#include "core/sag_free.h"
#include "groom/groom_operations.h"
#include "groom/procedural_groom.h"
#include "io/file_bytes.h"
#include "options/console.h"

namespace strandcast {
namespace {

constexpr size_t kSample = 192;              // strands timed to estimate the whole
constexpr size_t kMinSampledStrands = 4000;  // strands; fewer take less than a second

template <class Work>
double secondsOf(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Indices of kSample strands, evenly spaced.
std::vector<uint32_t> sampleOf(size_t strands) {
  std::vector<uint32_t> sample;
  for (size_t i = 0; i < kSample; ++i) sample.push_back(static_cast<uint32_t>(i * strands / kSample));
  return sample;
}

double mebibytes(size_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

}  // namespace

bool HairEstimate::isNotable() const { return seconds >= kNotableBakeSeconds || bytes >= kNotableMemory; }

std::string HairEstimate::text() const {
  std::string text;
  if (seconds >= kNotableBakeSeconds) text = fmt::format("about {:.0f} s", seconds);
  if (bytes > 0) text += fmt::format("{}{:.0f} MiB", text.empty() ? "about " : ", ", mebibytes(bytes));
  return text;
}

HairEstimate estimateOfGroom(const SceneOptions& options) {
  HairEstimate out;
  if (!options.groom.empty()) {
    // bytes/s of one core of 2020: binary files are read in one pass, texts are parsed word by word.
    constexpr double kBinaryPerSecond = 300e6, kTextPerSecond = 30e6;
    for (const std::filesystem::path& file : options.groom) {
      std::error_code absent;
      const uintmax_t bytes = std::filesystem::file_size(file, absent);
      if (absent) continue;
      const std::string extension = lowerExtension(file);
      const bool is_text = extension == ".obj" || extension == ".usda";
      out.file_bytes += bytes;
      out.seconds += static_cast<double>(bytes) / (is_text ? kTextPerSecond : kBinaryPerSecond);
      out.bytes += bytes;  // the whole file is in memory while it is read
    }
    return out;
  }
  ProceduralGroomOptions groom = proceduralGroomOf(options);
  out.strands = static_cast<size_t>(groom.strands);
  out.vertices = out.strands * static_cast<size_t>(groom.vertices);
  out.bytes = out.vertices * kBytesPerVertex;
  if (out.strands < kMinSampledStrands) return out;
  groom.strands = static_cast<int>(kSample);
  out.seconds = secondsOf([&] { makeProceduralGroom(groom); }) * static_cast<double>(out.strands) / kSample;
  return out;
}

HairEstimate estimateOfModel(const Scene& scene, const Settings& settings) {
  const StrandSet& strands = scene.groom.strands;
  HairEstimate out;
  out.strands = strands.strands();
  out.vertices = strands.vertices();
  out.bytes = out.vertices * kBytesPerVertex;
  if (out.strands < kMinSampledStrands) return out;
  const StrandSet some = subset(strands, sampleOf(out.strands));
  const double times = static_cast<double>(out.strands) / kSample;
  StrandModel model;
  out.seconds = times * secondsOf([&] { model = makeStrandModel(some, scene.materials); });
  if (settings.solver == SolverKind::kRod && settings.sag_free) {
    const double threads = std::max(std::thread::hardware_concurrency(), 1u);  // see makeSagFree()
    out.seconds += times / threads * secondsOf([&] { makeSagFree(model, scene.parameters.gravity); });
  }
  return out;
}

BakeAnnouncement announceBakes(ProgressBar& bar) {
  return [&](const std::string& estimate, double seconds) {
    bar.clear();
    if (seconds >= kNotableBakeSeconds) spdlog::info("{}", estimate);
  };
}

std::filesystem::path fieldCacheWithProgress() {
  try {
    return defaultFieldCache();
  } catch (const Error& error) {
    spdlog::warn("{}; every run bakes the body's field again", error.what());
    return {};
  }
}

namespace {

void logEstimate(const SceneOptions& options) {
  const HairEstimate estimate = estimateOfGroom(options);
  if (!estimate.isNotable()) return;
  if (estimate.file_bytes > 0)
    spdlog::info("reading {:.0f} MiB of groom files takes {}",
                 static_cast<double>(estimate.file_bytes) / (1 << 20), estimate.text());
  else
    spdlog::info("{} strands, {} vertices: growing and simulating them takes {}", estimate.strands,
                 estimate.vertices, estimate.text());
}

}  // namespace

Scene makeSceneWithProgress(SceneOptions options, const std::function<void()>& meanwhile) {
  if (options.field_cache.empty()) options.field_cache = fieldCacheWithProgress();
  logEstimate(options);
  Scene scene;
  std::exception_ptr stops;  // exception of `meanwhile`, which runs in the bake's worker threads
  {
    ProgressBar bar;
    options.bake_begins = announceBakes(bar);
    const std::string name = options.groom.empty() ? options.name : options.groom.front().stem().string();
    options.warns_early = [&](const std::string& warning) {
      bar.clear();
      spdlog::warn("{}: {}", name, warning);
    };
    const auto goesOn = [&] {
      if (g_interrupted || stops) return false;
      try {
        if (meanwhile) meanwhile();
      } catch (...) {
        stops = std::current_exception();
      }
      return !stops;
    };
    try {
      scene = makeScene(options, [&](const std::string& what, double part) {
        bar.show(what, part);
        return goesOn();
      });
    } catch (const BakeStopped&) {
      if (stops) std::rethrow_exception(stops);
      throw;
    }
  }
  for (const std::string& warning : scene.warnings) spdlog::warn("{}: {}", scene.name, warning);
  for (const std::string& note : scene.notes) spdlog::info("{}: {}", scene.name, note);
  return scene;
}

}  // namespace strandcast
