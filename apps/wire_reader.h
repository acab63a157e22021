#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/second_process.h"
#include "apps/verbs.h"

namespace strandcast {

/// Declares the verb `wire-reader`, the other process of the suite "wire": a reader of a film that is cast.
/// It prints "ready" when it has the groom and, after the last frame or a second after its input ended, one
/// line of JSON, a WireReading.
Verb addWireReader(CLI::App& app);

/// What the reader received.
struct WireReading {
  uint64_t frames_whole = 0, frames_concealed = 0;
  double processor_seconds = 0;  ///< of all its threads since it was ready, without comparing
  /// The farthest that a vertex is from where it was in the film, mm, over about every tenth whole frame; not
  /// a number where none was looked at.
  double worst_error_mm = 0;
  /// Number of each frame and when it was complete, ns by the steady clock.
  std::vector<std::pair<uint64_t, int64_t>> arrivals;
};

/// How the reader is told what to receive.
struct WireReaderOptions {
  std::string transport;  ///< "dds" or "lcm"
  int domain = 0;
  uint64_t last_frame = 1;
  double rate = 60;  ///< frames per second
  std::string film;  ///< SharedFilm::path()
};

/// That process, from the publisher's. Waits for it are bounded, whatever becomes of it.
class WireReader {
 public:
  explicit WireReader(const WireReaderOptions& options);
  /// False when it ended or does not get the groom within half a minute.
  bool waitReady();
  /// Once the last frame is cast. Nothing when it ended or does not answer within ten seconds.
  std::optional<WireReading> reading();
  /// Why there is no reading, for people. Ends it.
  std::string failure() { return "the reader " + process_.end(); }

 private:
  SecondProcess process_;
};

}  // namespace strandcast
