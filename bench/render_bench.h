#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// `strandbench render`: time of growing hair in compute and of every pass of a picture, by the device's own
/// clock, and the memory that it takes. Gives what to run after parsing.
std::function<int()> addRenderBench(CLI::App& app);

}  // namespace strandcast
