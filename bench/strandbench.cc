// strandbench VERB: measures the performance of Strandcast, and reports the results of the computation beside
// each time. Each verb has its own file.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <utility>
#include <vector>

#include "bench/reader_process.h"
#include "bench/table.h"
#include "bench/verbs.h"
#include "options/console.h"
#include "validation/wire_suite.h"

using namespace strandcast;

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("strandbench"));
  setCommand(argc, argv);
  CLI::App app("strandbench measures Strandcast and prints with each time what was computed in it.");
  app.require_subcommand(1);
  std::vector<std::pair<CLI::App*, std::function<int()>>> verbs;
  const auto add = [&](const char* name, const char* about, std::function<int()> (*declare)(CLI::App&)) {
    CLI::App* verb = app.add_subcommand(name, about);
    verbs.emplace_back(verb, declare(*verb));
  };
  add("step", "time of a simulation step", addStepBench);
  add("scaling",
      "growth of cost and memory with strands, vertices, substeps, threads, lanes, grooms, readers",
      addScalingBench);
  add("end-to-end", "latency from a motion of the head to grown hair in another process", addEndToEndBench);
  add("wire", "size, error and latency of published frames, by codec", addWireBench);
  add("encode",
      "time from a step's start to its guides in bytes of the wire, encoded by the GPU and by the CPU",
      addEncodeBench);
  add("start", "time from a daemon's start to the first frame in another process, and of loading its scene",
      addStartBench);
  add("peers", "cost and error of the rod, gauss_seidel and Bullet's ropes", addPeersBench);
  add("accuracy", "cost and error of the solvers' settings", addAccuracy);
  add("grid", "time of wind on a grid and of forces between hairs", addGridBench);
  add("contact", "cost of hair with bodies against hair without, and of baking a body's field",
      addContactBench);
#ifdef STRANDCAST_HAS_RENDER
  add("render", "time of growing hair and of each pass of a picture", addRenderBench);
#endif
  add("all", "all of these except accuracy, encode and start, in under ten minutes, as one table",
      addAllBench);
  add("report", "generate docs/performance.md from bench/results", addReport);
  add("reader", "internal: the reading process of scaling and end-to-end", addReader);
  verbs.back().first->group("");
  add("wire-reader", "internal: the reading process of wire", addWireReader);
  verbs.back().first->group("");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return withOutputWritten(app.exit(error) == 0 ? 0 : kExitBadInput);
  }
  return runProgram([&] {
    for (const auto& [verb, run] : verbs)
      if (verb->parsed()) return run();
    return kExitBadInput;
  });
}
