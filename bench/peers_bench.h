#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `peers` on `app` and gives what runs it: what the rod, gauss_seidel and Bullet's ropes
/// cost and how far off they are, in one run.
std::function<int()> addPeersBench(CLI::App& app);

}  // namespace strandcast
