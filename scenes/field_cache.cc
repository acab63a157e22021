#include "scenes/field_cache.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <fstream>
#include <span>
#include <system_error>

#include "core/error.h"
#include "groom/distance_field_file.h"
#include "groom/file_bytes.h"

namespace strandcast {

std::filesystem::path defaultFieldCache() {
  const char *cache = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
  // The specification has relative paths ignored.
  if (cache != nullptr && std::filesystem::path(cache).is_absolute())
    return std::filesystem::path(cache) / "strandcast";
  if (home == nullptr || *home == 0)
    throw Error("there is no folder for the cache", "HOME and XDG_CACHE_HOME are not set",
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
    throw Error("the field in the file is of another body", file(key, "sdf").string(), "");
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
  // Before the field, so that none is found without them.
  if (!warnings.empty()) {
    const std::string text = fmt::format("{}\n", fmt::join(warnings, "\n"));
    writeFileBytes(file(key, "txt"), std::as_bytes(std::span(text)));
  }
  writeDistanceField(file(key, "sdf"), field, key);
}

std::vector<std::string> FieldCache::warnings(uint64_t key) const {
  constexpr size_t kMostLines = 16, kLongestLine = 1000;
  std::vector<std::string> out;
  if (folder_.empty()) return out;
  std::ifstream stream(file(key, "txt"));
  for (std::string line; out.size() < kMostLines && std::getline(stream, line);)
    if (!line.empty()) out.push_back(line.substr(0, kLongestLine));
  return out;
}

BakeAnnouncement bakesOf(const BakeAnnouncement& begins, const std::string& name) {
  if (!begins) return {};
  return
      [begins, name](const std::string& outlook, double seconds) { begins(name + ": " + outlook, seconds); };
}

SceneField fieldOf(const TriangleMesh& mesh, const FieldOptions& options, const FieldCache& cache,
                   const BakeProgress& progress, const BakeAnnouncement& begins, const BakeLimits& limits) {
  const FieldOptions resolved = resolveFieldOptions(mesh, options);
  const uint64_t key = fieldKey(mesh, resolved);
  const auto note = [](const DistanceField& field, const char* how) {
    return fmt::format("the body's distance field: {} bricks, cells of {:.3g} mm, {:.1f} MiB, {}",
                       field.storedBricks(), 1e3 * field.grid.cell,
                       static_cast<double>(field.bytes()) / (1 << 20), how);
  };
  std::string trouble;
  if (std::optional<DistanceField> found = cache.find(key, &trouble)) {
    std::string text = note(*found, "found in the cache");
    std::vector<std::string> warnings = cache.warnings(key);
    if (!found->hasInside()) warnings.emplace_back(kNoInside);
    return {std::move(*found), std::move(text), true, {}, std::move(warnings)};
  }
  FieldBaker baker(mesh, resolved, limits, progress);
  const BakeEstimate& needs = baker.estimate();
  const std::string outlook =
      fmt::format("about {:.0f} s, {:.0f} MiB", needs.seconds,
                  static_cast<double>(needs.field_bytes + needs.working_bytes) / (1 << 20));
  if (begins) begins("baking a distance field takes " + outlook, needs.seconds);
  DistanceField field = baker.bake([&](const std::string& what, double part) {
    return !progress || progress(fmt::format("{} ({})", what, outlook), part);
  });
  std::string text = note(field, trouble.empty() ? "baked" : "baked anew");
  std::vector<std::string> warnings = baker.warnings();
  try {
    cache.keep(key, field, warnings);
  } catch (const Error& error) {
    trouble = error.what();
  }
  if (!trouble.empty()) text += fmt::format(" ({})", trouble);
  if (!field.hasInside()) warnings.emplace_back(kNoInside);
  return {std::move(field), std::move(text), false, std::move(trouble), std::move(warnings)};
}

}  // namespace strandcast
