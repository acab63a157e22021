#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>

#include "core/distance_field.h"

namespace strandcast {

/// The user's cache: $XDG_CACHE_HOME/strandcast, or .cache/strandcast at home.
std::filesystem::path defaultFieldCache();

/// Baked fields in a folder, each a file named by its key (fieldKey).
class FieldCache {
 public:
  explicit FieldCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Nothing where there is none; a damaged file counts as none.
  std::optional<DistanceField> find(uint64_t key) const;
  /// Appears whole or not at all, whoever else writes. Throws Error when it cannot be written.
  void keep(uint64_t key, const DistanceField& field) const;

 private:
  std::filesystem::path file(uint64_t key) const;

  std::filesystem::path folder_;
};

}  // namespace strandcast
