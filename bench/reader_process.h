#pragma once
#include <functional>
#include <nlohmann/json.hpp>

#include "apps/second_process.h"

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `reader`: what a renderer does with the frames of a daemon, until a certain one has
/// come. It is the other process of `scaling` and `end-to-end`. It prints "ready" when it has the groom, and
/// in the end a JSON object: "renderer" (what hair was grown on, or null), "received", "lost",
/// "latency_ms_p50", "latency_ms_p99" and, per frame that it took, "frames": [number, arrival, taken, grown],
/// ns by the steady clock.
std::function<int()> addReader(CLI::App& app);

/// That verb of this program in a process of its own.
class ReaderProcess {
 public:
  /// `hairs` that it grows per frame, 0 = none, and their segments. Throws Error.
  ReaderProcess(int domain, uint64_t last_frame, int hairs, int segments);
  /// Until it has the groom. Throws Error when it ends before, or not within a minute.
  void waitReady();
  /// What it prints in the end. Throws Error when that does not come within a minute.
  nlohmann::json report();

 private:
  SecondProcess process_;
};

/// A DDS domain that no other benchmark of this machine is likely to be on.
int benchDomain();

}  // namespace strandcast
