#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `end-to-end` on `app` and gives what runs it: how long it takes from a motion of the
/// head to hair that is grown in another process, and where that time goes.
std::function<int()> addEndToEndBench(CLI::App& app);

}  // namespace strandcast
