#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `step` on `app` and gives what runs it: how long a step takes on each backend, and in
/// the same run what it computed.
std::function<int()> addStepBench(CLI::App& app);

}  // namespace strandcast
