#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `start`: how long a daemon takes from its start to the first frame that a reader has.
std::function<int()> addStartBench(CLI::App& app);

}  // namespace strandcast
