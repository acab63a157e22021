#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/child_process.h"
#include "apps/verbs.h"

namespace strandcast {

/// Declares the verb `wire-reader`, the child process of the suite "wire", which receives a film. It prints
/// "ready" once it has the groom. After the last frame, or a second after its input ended, it prints one line
/// of JSON, a WireReading.
Verb addWireReader(CLI::App& app);

/// What the reader process measured.
struct WireReading {
  uint64_t frames_whole = 0, frames_concealed = 0;
  double processor_seconds = 0;  ///< s, of all its threads since "ready", without the comparisons
  /// Largest distance of a received vertex from the film, mm, over about every tenth complete frame; NaN
  /// where none was compared.
  double worst_error_mm = 0;
  /// Number of each frame and its completion time, ns by the steady clock.
  std::vector<std::pair<uint64_t, int64_t>> arrivals;
};

/// Arguments for the reader process.
struct WireReaderOptions {
  std::string transport;  ///< "dds" or "lcm"
  int domain = 0;
  uint64_t last_frame = 1;
  double rate = 60;  ///< frames per second
  std::string film;  ///< SharedFilm::path()
};

/// The reader process, as seen from the publisher's process. All waits for it are bounded.
class WireReader {
 public:
  explicit WireReader(const WireReaderOptions& options);
  /// Waits for "ready". False where the process ended or has no groom within 30 s.
  bool waitReady();
  /// Call after the last frame was sent. Empty where the process ended or does not answer within 10 s.
  std::optional<WireReading> reading();
  /// Why there is no reading, as text. Ends the process.
  std::string failure() { return "the reader " + process_.end(); }

 private:
  ChildProcess process_;
};

}  // namespace strandcast
