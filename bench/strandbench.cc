// strandbench VERB: how fast Strandcast is, and beside each time what was computed in it. Each verb has a
// file of its own.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <utility>
#include <vector>

#include "apps/console.h"
#include "apps/wire_reader.h"
#include "bench/accuracy.h"
#include "bench/all_bench.h"
#include "bench/contact_bench.h"
#include "bench/end_to_end_bench.h"
#include "bench/grid_bench.h"
#include "bench/peers_bench.h"
#include "bench/reader_process.h"
#include "bench/report_verb.h"
#include "bench/scaling_bench.h"
#include "bench/start_bench.h"
#include "bench/step_bench.h"
#include "bench/table.h"
#include "bench/wire_bench.h"
#ifdef STRANDCAST_HAS_RENDER
#include "bench/render_bench.h"
#endif

using namespace strandcast;

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("strandbench"));
  setCommand(argc, argv);
  CLI::App app("strandbench measures Strandcast, and beside each time says what was computed in it.");
  app.require_subcommand(1);
  std::vector<std::pair<CLI::App*, std::function<int()>>> verbs;
  const auto add = [&](const char* name, const char* about, std::function<int()> (*declare)(CLI::App&)) {
    CLI::App* verb = app.add_subcommand(name, about);
    verbs.emplace_back(verb, declare(*verb));
  };
  add("step", "time of a simulation step", addStepBench);
  add("scaling", "how cost and memory grow with strands, vertices, substeps, threads, lanes, grooms, readers",
      addScalingBench);
  add("end-to-end", "latency from a motion of the head to hair that is grown in another process",
      addEndToEndBench);
  add("wire", "size, error and latency of what is cast, by codec", addWireBench);
  add("start", "from a daemon's start to the first frame in another process, beside loading its scene",
      addStartBench);
  add("peers", "cost and error beside Bullet's ropes and gauss_seidel", addPeersBench);
  add("accuracy", "cost of the solvers' settings against their error", addAccuracy);
  add("grid", "time of wind on a grid and of forces between hairs", addGridBench);
  add("contact", "cost of hair on bodies against hair without, and of baking a body's field",
      addContactBench);
#ifdef STRANDCAST_HAS_RENDER
  add("render", "time of growing hair and of every pass of a picture", addRenderBench);
#endif
  add("all", "all of these but accuracy and start, in under ten minutes, one table", addAllBench);
  add("report", "docs/performance.md from the results that are kept", addReport);
  add("reader", "the other process of scaling and end-to-end", addReader);
  verbs.back().first->group("");
  add("wire-reader", "the other process of wire", addWireReader);
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
