#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `accuracy` on `app` and gives what runs it: cost of each solver's settings against their
/// error, by the truth of validation/newton_rod.h.
std::function<int()> addAccuracy(CLI::App& app);

}  // namespace strandcast
