#pragma once
#include <functional>
#include <nlohmann/json.hpp>

#include "service/process.h"

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `reader`, the child process of `scaling` and `end-to-end`. It receives frames as a
/// renderer does, until frame `last_frame`. It prints "ready" once it has the groom, and finally a JSON
/// object. Keys: "renderer" (the OpenGL renderer that grew hair, or null), "received", "lost",
/// "latency_ms_p50", "latency_ms_p99", and per frame taken "frames": [number, arrival, taken, grown], ns by
/// the steady clock.
std::function<int()> addReader(CLI::App& app);

/// Runs the verb `reader` in a child process.
class ReaderProcess {
 public:
  /// `hairs`: number grown per frame, 0 = none; `segments` of each. Throws Error.
  ReaderProcess(int domain, uint64_t last_frame, int hairs, int segments);
  /// Waits for "ready". Throws Error where the process ends first or has no groom within a minute.
  void waitReady();
  /// Waits for the final JSON. Throws Error where it does not come within a minute.
  nlohmann::json report();

 private:
  ChildProcess process_;
};

/// A DDS domain that no other benchmark on this machine is likely to use.
int benchDomain();

}  // namespace strandcast
