#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// `strandbench contact`: a step of hair on one mesh body and five primitives beside the same step without
/// bodies, the broad phase apart, and the bake of the mesh's field. Gives what to run after parsing.
std::function<int()> addContactBench(CLI::App& app);

}  // namespace strandcast
