#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `all` on `app` and gives what runs it: every other verb in a process of its own, in its
/// quick form, and what came out in one table.
std::function<int()> addAllBench(CLI::App& app);

}  // namespace strandcast
