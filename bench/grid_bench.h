#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// `strandbench grid`: time of every pass of the wind grid and of the forces between hairs at 32^3, 64^3 and
/// 128^3 cells, beside a step of the strands themselves. Gives what to run after parsing.
std::function<int()> addGridBench(CLI::App& app);

}  // namespace strandcast
