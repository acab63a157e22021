#include "bench/verbs.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>

#include "bench/bench_simulation.h"
#include "bench/machine.h"
#include "bench/plots.h"
#include "bench/report.h"
#include "bench/table.h"
#include "core/error.h"
#include "options/console.h"
#include "options/output_folder.h"
#ifdef STRANDCAST_HAS_RENDER
#include "gl/context.h"
#endif

namespace strandcast {
namespace {

namespace fs = std::filesystem;

struct AllOptions {
  std::vector<std::string> only;
  fs::path out, results = "bench/results";
  std::string machine;
  bool save = false, thorough = false;
  PrintOptions print;
};

/// One invocation of this program whose CSV is kept.
struct Job {
  std::string name;  // of the CSV file
  std::string arguments;
};

enum class Graphics { kNone, kSoftware, kHardware };
Graphics graphics() {
#ifdef STRANDCAST_HAS_RENDER
  if (!gl::headlessAvailable(nullptr)) return Graphics::kNone;
  return gl::HeadlessContext().software() ? Graphics::kSoftware : Graphics::kHardware;
#else
  return Graphics::kNone;
#endif
}

std::vector<Job> jobsOf(const AllOptions& o) {
  const Graphics gl = graphics();
  const std::string quick = o.thorough ? "" : " --quick";
  std::vector<Job> jobs{
      {"step",
       gl == Graphics::kHardware ? "step --backend all --steps 200" : "step --backend all --steps 30"},
      {"step_10k", "step --backend simd --strands 10000 --substeps 6 --scene curly --shake 2 --steps 100"},
      {"scaling", "scaling" + quick},
      {"peers", "peers" + quick},
      {"contact", "contact --steps 30 --cell 0.004"},
      {"grid", "grid --cells 32,64 --steps 10"},
      {"wire", "wire" + quick},
      {"end_to_end", fmt::format("end-to-end --hairs 0 --seconds {}", o.thorough ? 20 : 4)}};
  if (gl != Graphics::kNone) {
    // Fewer hairs on a software OpenGL.
    jobs.push_back(
        {"end_to_end_grown", fmt::format("end-to-end --hairs {} --seconds {}",
                                         gl == Graphics::kHardware ? 50000 : 1000, o.thorough ? 20 : 4)});
    jobs.push_back({"render", fmt::format("render --growth-only --hairs {} --pictures 10",
                                          gl == Graphics::kHardware ? "10000,100000" : "2000,10000")});
  }
  if (gl == Graphics::kHardware) {
    jobs.push_back({"gpu_grid", "grid --backend gpu --strands 100000 --cells 64 --steps 100"});
    for (const auto& [size, strands] : {std::pair{"100k", 100000}, {"4k", 4000}}) {
      const std::string step = fmt::format(
          "step --backend gpu --strands {} --substeps 6 --scene curly --shake 2 --steps 300", strands);
      jobs.push_back({fmt::format("gpu_{}_alone", size), step});
      jobs.push_back({fmt::format("gpu_{}_all", size), step + " --bodies mesh --air 64"});
    }
  }
  if (o.only.empty()) return jobs;
  std::vector<std::string> names;
  for (const Job& job : jobs) names.push_back(job.name);
  for (const std::string& name : o.only)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Error("this machine has no benchmark '" + name + "'", "--only",
                  fmt::format("choose among {}", fmt::join(names, ", ")));
  std::erase_if(jobs, [&](const Job& job) {
    return std::find(o.only.begin(), o.only.end(), job.name) == o.only.end();
  });
  return jobs;
}

/// The standard output of this program with those arguments; empty where it fails.
std::optional<std::string> outputOf(const std::string& arguments) {
  FILE* pipe = popen(fmt::format("exec /proc/{}/exe {} --csv", getpid(), arguments).c_str(), "r");
  if (pipe == nullptr) return std::nullopt;
  std::string text;
  char buffer[4096];
  for (size_t got = 0; (got = fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, got);
  const int status = pclose(pipe);
  // Propagates a signal that ended the child, e.g. by Ctrl-C, to this program.
  if (WIFSIGNALED(status)) std::raise(WTERMSIG(status));
  return status == 0 ? std::optional(text) : std::nullopt;
}

void writePlots(const fs::path& folder, const Results& results) {
  const std::tuple<const char*, const char*, std::string (*)(const std::vector<nlohmann::json>&)> plots[] = {
      {"peers", "peers", peersPlot},
      {"peers", "peers_tip", peersTipPlot},
      {"scaling", "scaling", scalingPlot},
      {"end_to_end", "end_to_end", latencyPlot},
      {"end_to_end_grown", "end_to_end_grown", latencyPlot}};
  for (const auto& [file, name, plot] : plots)
    if (results.contains(file)) writeText(folder / fmt::format("{}.svg", name), plot(results.at(file).rows));
}

int all(const AllOptions& o) {
  const Machine machine = thisMachine();
  fs::path folder = o.out;
  if (o.save) folder = o.results / (o.machine.empty() ? folderNameOf(machine.cpu) : o.machine);
  if (folder.empty()) folder = "out/bench";
  const std::vector<Job> jobs = jobsOf(o);
  const OutputFolder made(folder);
  Results results;
  std::vector<std::string> failed;
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  for (size_t i = 0; i < jobs.size(); ++i) {
    const double before = seconds();
    fmt::print(stderr, "{} of {}: strandbench {}\n", i + 1, jobs.size(), jobs[i].arguments);
    const std::optional<std::string> csv = outputOf(jobs[i].arguments);
    if (!csv) {
      failed.push_back(jobs[i].arguments);
      continue;
    }
    writeText(folder / (jobs[i].name + ".csv"), *csv);
    results[jobs[i].name] = parseCsv(*csv, jobs[i].name);
    fmt::print(stderr, "  {:.1f} s\n", seconds() - before);
  }
  if (!o.save) writePlots(folder, results);

  Bench bench;
  bench.name = "all";
  bench.params = {{"folder", folder.string()}, {"thorough", o.thorough}};
  bench.more = {{"seconds", seconds()}, {"failed", failed}};
  bench.heading = fmt::format("{}\n", originComment());
  bench.table = Table({{"what", "what"},
                       {"measured", "measured"},
                       {"goal", "goal"},
                       {"holds", "holds"},
                       {"command", "command"}});
  for (const Headline& line : headlinesOf(results))
    bench.table.add({{"what", line.what},
                     {"measured", line.measured},
                     {"goal", line.goal},
                     {"holds", !line.holds   ? ""
                               : *line.holds ? "yes"
                                             : "NO"},
                     {"command", line.command}});
  bench.closing =
      fmt::format("{:.0f} s; CSV{} in {}\n", seconds(), o.save ? "" : " and plots", folder.string());
  for (const std::string& arguments : failed)
    bench.closing += fmt::format("FAILED: strandbench {}\n", arguments);
  print(bench, o.print);
  return failed.empty() ? 0 : kExitCheckFailed;
}

}  // namespace

std::function<int()> addAllBench(CLI::App& app) {
  const auto o = std::make_shared<AllOptions>();
  app.footer(
      "Runs the benchmarks one after the other and keeps their CSV, with the commit and the machine. Goals "
      "are for\n"
      "unloaded machines of two cores, of sixteen, and an H100; a missed goal is not a failure. The "
      "accuracy\n"
      "benchmark is not included: it takes minutes and is equal on every machine (strandbench accuracy).\n"
      "Examples:\n"
      "  strandbench all                             plots and CSV in out/bench\n"
      "  strandbench all --save                      CSV in bench/results/CPU, for docs/performance.md:\n"
      "  strandbench report");
  app.add_flag("--save", o->save, "keep the CSVs in bench/results, in a folder with the processor's name");
  app.add_option("--machine", o->machine, "name of that folder instead, e.g. nvidia-h100");
  app.add_option("--out", o->out, "folder for CSVs and plots without --save (out/bench)");
  app.add_option("--only", o->only,
                 "run only these benchmarks, e.g. step,wire; an unknown name prints those of this machine")
      ->delimiter(',');
  app.add_flag("--thorough", o->thorough,
               "run the long forms, half an hour or more, including scaling beyond 10,000 strands, which the "
               "quick form leaves out on few cores");
  addPrintOptions(app, o->print);
  return [o] { return all(*o); };
}

}  // namespace strandcast
