#pragma once
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>

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
  ~ReaderProcess();
  ReaderProcess(const ReaderProcess&) = delete;
  ReaderProcess& operator=(const ReaderProcess&) = delete;
  /// Until it has the groom. Throws Error when it ends before.
  void waitReady();
  /// What it prints in the end. Throws Error.
  nlohmann::json report();

 private:
  std::FILE* output_;
};

/// A DDS domain that no other benchmark of this machine is likely to be on.
int benchDomain();

}  // namespace strandcast
