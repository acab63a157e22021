#pragma once
#include <cstddef>
#include <string>

#include "apps/settings.h"

namespace strandcast {

/// Estimated time and memory of this machine to prepare and simulate hair. Worth logging where the time is a
/// second or more, or the memory is at least kNotableMemory.
struct HairEstimate {
  size_t strands = 0, vertices = 0;  ///< 0 = unknown
  size_t file_bytes = 0;             ///< of groom files to read
  double seconds = 0;
  size_t bytes = 0;

  bool isNotable() const;
  /// "about 12 s, 700 MiB".
  std::string text() const;
};
constexpr size_t kNotableMemory = size_t{256} << 20;
/// Main memory per vertex, bytes: groom, model, backend state and frames. Measured with 120,000 strands of 28
/// vertices on the simd backend.
constexpr size_t kBytesPerVertex = 250;

/// Estimates making the scene's hair. Procedural hair: times a sample of kSample strands. Files: a rough
/// estimate from their size.
HairEstimate estimateOfGroom(const SceneOptions& options);
/// Estimates making the model of this scene, sag-free where the settings ask for it, from a sample of kSample
/// strands.
HairEstimate estimateOfModel(const Scene& scene, const Settings& settings);

}  // namespace strandcast
