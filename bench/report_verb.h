#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `report` on `app` and gives what runs it: writes docs/performance.md and its plots from
/// the results that are kept.
std::function<int()> addReport(CLI::App& app);

}  // namespace strandcast
