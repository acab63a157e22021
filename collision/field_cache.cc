#include "collision/field_cache.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <span>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "io/distance_field_file.h"
#include "io/file_bytes.h"

namespace strandcast {

std::filesystem::path defaultFieldCache() {
  const char *cache = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
  // The XDG specification says to ignore relative paths.
  if (cache != nullptr && std::filesystem::path(cache).is_absolute())
    return std::filesystem::path(cache) / "strandcast";
  if (home == nullptr || *home == 0)
    throw Error("the cache folder is unknown", "HOME and XDG_CACHE_HOME are not set",
                "set XDG_CACHE_HOME to a folder, or HOME");
  return std::filesystem::path(home) / ".cache" / "strandcast";
}

std::filesystem::path FieldCache::file(uint64_t key, const char* extension) const {
  return folder_ / fmt::format("{:016x}.{}", key, extension);
}

std::optional<DistanceField> FieldCache::find(uint64_t key, std::string* trouble) const {
  std::error_code failure;
  if (folder_.empty() || !std::filesystem::is_regular_file(file(key, "sdf"), failure)) return {};
  try {
    StoredField stored = loadDistanceField(file(key, "sdf"));
    if (stored.key == key) return std::move(stored.field);
    throw Error("the cached field belongs to another body", file(key, "sdf").string(), "");
  } catch (const Error& error) {
    if (trouble != nullptr) *trouble = error.what();
  }
  return {};
}

void FieldCache::keep(uint64_t key, const DistanceField& field,
                      const std::vector<std::string>& warnings) const {
  if (folder_.empty()) return;
  std::error_code failure;
  std::filesystem::create_directories(folder_, failure);
  // Written before the field, so that no field is found without its warnings.
  if (!warnings.empty()) {
    const std::string text = fmt::format("{}\n", fmt::join(warnings, "\n"));
    writeFileBytes(file(key, "txt"), std::as_bytes(std::span(text)));
  }
  writeDistanceField(file(key, "sdf"), field, key);
}

std::vector<std::string> FieldCache::warnings(uint64_t key) const {
  constexpr size_t kMaxLines = 16, kLongestLine = 1000;
  std::vector<std::string> out;
  if (folder_.empty()) return out;
  std::ifstream stream(file(key, "txt"));
  for (std::string line; out.size() < kMaxLines && std::getline(stream, line);)
    if (!line.empty()) out.push_back(line.substr(0, kLongestLine));
  return out;
}

BakeAnnouncement bakesOf(const BakeAnnouncement& begins, const std::string& name) {
  if (!begins) return {};
  return [begins, name](const std::string& estimate, double seconds) {
    begins(name + ": " + estimate, seconds);
  };
}

namespace {

std::string noteOn(const DistanceField& field, const std::string& how) {
  return fmt::format("the body's distance field: {} bricks, cells of {:.3g} mm, {:.1f} MiB, {}",
                     field.storedBricks(), 1e3 * field.grid.cell,
                     static_cast<double>(field.bytes()) / (1 << 20), how);
}

/// A field found in the cache, or prepared for baking.
struct Planned {
  std::optional<DistanceField> found;
  std::unique_ptr<FieldBaker> baker;
  uint64_t key = 0;
  std::string trouble;  ///< fault of the file in the cache
};

Planned planned(const TriangleMesh& mesh, const FieldOptions& options, const FieldCache& cache,
                const BakeProgress& progress, const BakeLimits& limits) {
  Planned out;
  const FieldOptions resolved = resolveFieldOptions(mesh, options);
  out.key = fieldKey(mesh, resolved);
  out.found = cache.find(out.key, &out.trouble);
  if (!out.found) out.baker = std::make_unique<FieldBaker>(mesh, resolved, limits, progress);
  return out;
}

/// Bakes and stores the field unless it was found.
SceneField finished(Planned plan, const FieldCache& cache, const BakeProgress& progress) {
  if (plan.found) {
    std::string note = noteOn(*plan.found, "found in the cache");
    std::vector<std::string> warnings = cache.warnings(plan.key);
    if (!plan.found->hasInside()) warnings.emplace_back(kNoInside);
    return {std::move(*plan.found), std::move(note), true, {}, std::move(warnings)};
  }
  DistanceField field = plan.baker->bake(progress);
  std::string note = noteOn(field, plan.trouble.empty() ? "baked" : "baked again");
  std::vector<std::string> warnings = plan.baker->warnings();
  try {
    cache.keep(plan.key, field, warnings);
  } catch (const Error& error) {
    plan.trouble = error.what();
  }
  if (!plan.trouble.empty()) note += fmt::format(" ({})", plan.trouble);
  if (!field.hasInside()) warnings.emplace_back(kNoInside);
  return {std::move(field), std::move(note), false, std::move(plan.trouble), std::move(warnings)};
}

/// Total demand of bakes that are prepared together and run one after another.
struct Needs {
  double seconds = 0;
  size_t kept = 0, largest = 0;  ///< bytes

  void add(const BakeEstimate& estimate) {
    seconds += estimate.seconds;
    kept += estimate.working_bytes;  // hierarchies and field
    largest = std::max(largest, estimate.field_bytes);
  }
  std::string text() const {
    return fmt::format("about {:.0f} s, {:.0f} MiB", seconds,
                       static_cast<double>(kept + largest) / (1 << 20));
  }
};

}  // namespace

SceneField fieldOf(const TriangleMesh& mesh, const FieldOptions& options, const FieldCache& cache,
                   const BakeProgress& progress, const BakeAnnouncement& begins, const BakeLimits& limits) {
  Planned plan = planned(mesh, options, cache, progress, limits);
  Needs needs;
  if (plan.baker) needs.add(plan.baker->estimate());
  if (plan.baker && begins) begins("baking a distance field takes " + needs.text(), needs.seconds);
  return finished(std::move(plan), cache, [&](const std::string& what, double part) {
    return !progress || progress(fmt::format("{} ({})", what, needs.text()), part);
  });
}

std::vector<SceneField> fieldsOf(std::span<const NamedMesh> bodies, const FieldOptions& options,
                                 const FieldCache& cache, const BakeProgress& progress,
                                 const BakeAnnouncement& begins, const BakeLimits& limits) {
  constexpr double kPlanning = 0.1;  // share of the progress
  std::vector<Planned> plans;
  Needs needs;
  size_t baked = 0;
  for (const NamedMesh& body : bodies) {
    const double part = kPlanning * static_cast<double>(plans.size()) / static_cast<double>(bodies.size());
    plans.push_back(planned(
        *body.mesh, options, cache,
        [&](const std::string& what, double) {
          return !progress ||
                 progress(fmt::format("{} of {}, {}: {}", plans.size() + 1, bodies.size(), body.name, what),
                          part);
        },
        limits));
    if (!plans.back().baker) continue;
    needs.add(plans.back().baker->estimate());
    ++baked;
  }
  if (baked > 0 && begins)
    begins(fmt::format("baking {} of {} distance fields takes {}", baked, bodies.size(), needs.text()),
           needs.seconds);
  std::vector<SceneField> fields;
  double seconds_gone = 0;
  for (size_t i = 0; i < plans.size(); ++i) {
    const double seconds = plans[i].baker ? plans[i].baker->estimate().seconds : 0;
    fields.push_back(finished(std::move(plans[i]), cache, [&](const std::string& what, double part) {
      const double gone = (seconds_gone + part * seconds) / std::max(needs.seconds, 1e-9);
      return !progress || progress(fmt::format("{} of {}, {}: {} (all: {})", i + 1, bodies.size(),
                                               bodies[i].name, what, needs.text()),
                                   kPlanning + gone * (1 - kPlanning));
    }));
    seconds_gone += seconds;
  }
  return fields;
}

}  // namespace strandcast
