#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

// Each function adds one verb of strandbench to `app` and returns the function that runs it after parsing,
// which returns the exit status.

/// `accuracy`: cost of each solver's settings against their error relative to validation/newton_rod.h.
std::function<int()> addAccuracy(CLI::App& app);
/// `all`: every other verb in its quick form and in its own process, with the results in one table.
std::function<int()> addAllBench(CLI::App& app);
/// `contact`: a step of hair on one mesh body and five primitives, compared with the same step without
/// bodies. Measures the broad phase separately, and the bake of the mesh's field.
std::function<int()> addContactBench(CLI::App& app);
/// `encode`: time from the start of a step until the CPU can read its guides as bytes of the wire, compared
/// with the GPU's time; the bytes of GPU and CPU are compared.
std::function<int()> addEncodeBench(CLI::App& app);
/// `end-to-end`: the latency from a head motion to hair grown in another process, by stage.
std::function<int()> addEndToEndBench(CLI::App& app);
/// `grid`: time of every pass of the wind grid and of the forces between hairs at 32^3, 64^3 and 128^3 cells,
/// compared with a step of the strands.
std::function<int()> addGridBench(CLI::App& app);
/// `peers`: cost and error of the rod, gauss_seidel and Bullet's ropes in one run.
std::function<int()> addPeersBench(CLI::App& app);
/// `render`: time of growing hair in compute and of every pass of a picture, by the device's clock, and their
/// memory.
std::function<int()> addRenderBench(CLI::App& app);
/// `report`: writes docs/performance.md and its plots from the saved results.
std::function<int()> addReport(CLI::App& app);
/// `scaling`: growth of cost and memory with strands, vertices, substeps, threads, lanes, grooms and readers.
std::function<int()> addScalingBench(CLI::App& app);
/// `start`: time from a daemon's start to the first frame that a reader receives.
std::function<int()> addStartBench(CLI::App& app);
/// `step`: time of a step on each backend, with the results of the same run.
std::function<int()> addStepBench(CLI::App& app);
/// `wire`: the cases of `strandcast validate wire` as a table of sizes, errors and latencies.
std::function<int()> addWireBench(CLI::App& app);

}  // namespace strandcast
