#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `wire` on `app` and gives what runs it: the cases of `strandcast validate wire` as a
/// table of sizes, errors and latencies.
std::function<int()> addWireBench(CLI::App& app);

}  // namespace strandcast
