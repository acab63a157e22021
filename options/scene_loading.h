// Making a scene as programs do it: estimates of time and memory, a progress bar, the cache of fields.
#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "options/settings.h"
#include "scenes/scene.h"

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

class ProgressBar;

/// Logs the expected duration of a bake where it is a second or more, for output without a progress bar.
/// `bar` must outlive the result.
BakeAnnouncement announceBakes(ProgressBar& bar);
/// The user's cache folder of distance fields; empty, with a warning, where there is none.
std::filesystem::path fieldCacheWithProgress();
/// makeScene() with a progress bar, the user's field cache and logged notes. Ctrl-C stops it: throws
/// BakeStopped. `meanwhile` (may be empty) is called periodically; an exception from it stops the work and
/// propagates.
Scene makeSceneWithProgress(SceneOptions options, const std::function<void()>& meanwhile = {});

}  // namespace strandcast
