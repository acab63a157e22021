#pragma once
#include <cstddef>
#include <string>

#include "apps/settings.h"

namespace strandcast {

/// What hair takes before it moves: time, and memory of this machine while it is simulated. Both are told
/// where the time is a second or more, or the memory kMemoryWorthSaying.
struct HairOutlook {
  size_t strands = 0, vertices = 0;  ///< 0 where that is not known yet
  size_t file_bytes = 0;             ///< of groom files that are to be read
  double seconds = 0;
  size_t bytes = 0;

  bool isWorthSaying() const;
  /// "about 12 s, 700 MiB".
  std::string text() const;
};
constexpr size_t kMemoryWorthSaying = size_t{256} << 20;
/// In main memory, of a vertex: groom, model, state on a backend and frames. Measured with 120,000 strands of
/// 28 vertices on the simd backend.
constexpr size_t kBytesPerVertex = 250;

/// Of making the scene's hair: a few strands are grown to see how long they take; of files it is their size
/// that tells, roughly.
HairOutlook outlookOfGroom(const SceneOptions& options);
/// Of making the model of this scene, sag-free where the settings say so: a few strands are made to see how
/// long they take.
HairOutlook outlookOfModel(const Scene& scene, const Settings& settings);

}  // namespace strandcast
