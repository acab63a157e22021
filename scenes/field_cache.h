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

/// The user's cache: $XDG_CACHE_HOME/strandcast, or .cache/strandcast at home.
std::filesystem::path defaultFieldCache();

/// Baked fields in a folder, each a file named by its key (fieldKey), KEY.sdf; what there was to warn of
/// while baking is beside it, as text, KEY.txt. With an empty path none is found or kept.
class FieldCache {
 public:
  explicit FieldCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Nothing where there is none; a damaged file counts as none, and `trouble` says why.
  std::optional<DistanceField> find(uint64_t key, std::string* trouble = nullptr) const;
  /// Appears whole or not at all, whoever else writes. Throws Error when it cannot be written. `warnings`:
  /// what there was to warn of while baking (FieldBaker::warnings), a line each.
  void keep(uint64_t key, const DistanceField& field, const std::vector<std::string>& warnings = {}) const;
  /// What the field of this key was kept with.
  std::vector<std::string> warnings(uint64_t key) const;

 private:
  std::filesystem::path file(uint64_t key, const char* extension) const;

  std::filesystem::path folder_;
};

/// A field for a scene, and where it came from.
struct SceneField {
  DistanceField field;
  std::string note;  ///< a line for people
  bool from_cache = false;
  std::string trouble;  ///< what was wrong with the cache: with the file in it, or with keeping one; or empty
  /// FieldBaker::warnings, also of a field from the cache, and kNoInside where that holds.
  std::vector<std::string> warnings{};
};
constexpr double kBakeWorthSaying = 1;  ///< s: of a shorter one programs say nothing before
/// Told before a bake begins: a line for people, without the body's name, of how long it takes and with what
/// memory, and the seconds again.
using BakeAnnouncement = std::function<void(const std::string& outlook, double seconds)>;
/// The same of one body, whose lines begin with its name; empty where `begins` is.
BakeAnnouncement bakesOf(const BakeAnnouncement& begins, const std::string& name);
/// From the cache, or baked and kept there. The note tells of trouble, too.
/// Throws Error as FieldBaker does; BakeStopped.
SceneField fieldOf(const TriangleMesh& mesh, const FieldOptions& options, const FieldCache& cache,
                   const BakeProgress& progress, const BakeAnnouncement& begins = {},
                   const BakeLimits& limits = {});

/// A body among others, as lines for people call it.
struct NamedMesh {
  std::string name;
  const TriangleMesh* mesh;
};
/// fieldOf() for several bodies, in their order, with one announcement before the first bake: how many of the
/// fields are not in the cache, and what all of them take together. Progress tells which one of how many it
/// is at, "3 of 21, LeftArm: baking bricks", and the part of all work that is done.
std::vector<SceneField> fieldsOf(std::span<const NamedMesh> bodies, const FieldOptions& options,
                                 const FieldCache& cache, const BakeProgress& progress,
                                 const BakeAnnouncement& begins = {}, const BakeLimits& limits = {});

}  // namespace strandcast
