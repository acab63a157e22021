#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `scaling` on `app` and gives what runs it: how cost and memory grow with strands,
/// vertices, substeps, threads, lanes, grooms and readers.
std::function<int()> addScalingBench(CLI::App& app);

}  // namespace strandcast
