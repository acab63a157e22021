#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "collision/field_bake.h"
#include "core/distance_field.h"

namespace strandcast {

/// Default folder of the user's cache: $XDG_CACHE_HOME/strandcast, or ~/.cache/strandcast.
std::filesystem::path defaultFieldCache();

/// Cache of baked fields in a folder. A field is stored as KEY.sdf, named by its key (fieldKey), and its bake
/// warnings beside it as text, KEY.txt. With an empty path nothing is found or stored.
class FieldCache {
 public:
  explicit FieldCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// The stored field; empty if there is none. A damaged file counts as none, and `trouble` receives the
  /// reason.
  std::optional<DistanceField> find(uint64_t key, std::string* trouble = nullptr) const;
  /// Stores a field. Atomic for concurrent readers and writers. `warnings`: those of the bake
  /// (FieldBaker::warnings), one line each. Throws Error when the file cannot be written.
  void keep(uint64_t key, const DistanceField& field, const std::vector<std::string>& warnings = {}) const;
  /// The warnings stored with the field of this key.
  std::vector<std::string> warnings(uint64_t key) const;

 private:
  std::filesystem::path file(uint64_t key, const char* extension) const;

  std::filesystem::path folder_;
};

/// A field for a scene, with its origin.
struct SceneField {
  DistanceField field;
  std::string note;  ///< one line for the user
  bool from_cache = false;
  std::string trouble;  ///< fault of the cache, in reading or in storing the field; else empty
  /// FieldBaker::warnings, for cached fields, too, and kNoInside if the field has no inside.
  std::vector<std::string> warnings{};
};
constexpr double kNotableBakeSeconds = 1;  ///< s: shorter bakes are not announced
/// Called before a bake begins. `estimate`: one line for the user on time and memory, without the body's
/// name. `seconds`: the estimated time.
using BakeAnnouncement = std::function<void(const std::string& estimate, double seconds)>;
/// Returns `begins` with the name of a body prefixed to its lines; empty if `begins` is empty.
BakeAnnouncement bakesOf(const BakeAnnouncement& begins, const std::string& name);
/// Returns the field from the cache, or bakes and stores it. The note mentions cache faults as well. Throws
/// Error as FieldBaker does; BakeStopped.
SceneField fieldOf(const TriangleMesh& mesh, const FieldOptions& options, const FieldCache& cache,
                   const BakeProgress& progress, const BakeAnnouncement& begins = {},
                   const BakeLimits& limits = {});

/// A body with the name that messages use for it.
struct NamedMesh {
  std::string name;
  const TriangleMesh* mesh;
};
/// As fieldOf(), for several bodies, in their order. Before the first bake there is one announcement: how
/// many fields are not in the cache, and the total time and memory. Progress names the current body, "3 of
/// 21, LeftArm: baking bricks", and gives the share of all work done.
std::vector<SceneField> fieldsOf(std::span<const NamedMesh> bodies, const FieldOptions& options,
                                 const FieldCache& cache, const BakeProgress& progress,
                                 const BakeAnnouncement& begins = {}, const BakeLimits& limits = {});

}  // namespace strandcast
