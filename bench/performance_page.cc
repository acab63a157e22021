#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <vector>

#include "bench/plots.h"
#include "bench/report.h"
#include "bench/table.h"
#include "bench/verbs.h"
#include "core/error.h"
#include "options/console.h"

namespace strandcast {
namespace {

namespace fs = std::filesystem;
using Rows = std::vector<nlohmann::json>;

constexpr const char* kIntroduction = R"(# Performance

Generated from the CSV files of `bench/results` by `strandbench report`; do not edit it, because a test compares it with the program's
output. Each table names the command that measured it, its commit and its machine.

```
./dev bench                  # everything in under ten minutes: one table, plots and CSV in out/bench
./dev bench --save           # the same, with CSV in bench/results/<processor>, and this page generated again
./dev bench --save --machine nvidia-h100      # names the folder, here by the machine's GPU
```

How to read it:

- **ms** is the wall time of a whole step and of reading its guides: least, median and 95th percentile. **cpu ms** is the processor time
  of the same, of all threads; it is unaffected by load that inflates wall time. **gpu ms** is the time of the dispatches alone, by the
  GPU's clock. **submit** and **wait** are the wall time of a GPU's step: submitting commands and uploads, and waiting for the guides.
- **of peak**: floating-point operations of the step, counted by running the step's source with a counting number type, over the rate
  that the same threads reach with fused multiply-adds alone, measured in the same run. **cpu** is the same for the least processor time.
  On a GPU it is gpu ms, over the rate of a shader with multiply-adds alone. `strandbench step --operations` prints the operations of
  each part of the step ([solver.md](solver.md), "What the parts of a substep take").
- **of copy**: the least bytes that the step moves, all positions and velocities read and written once, over the rate at which the same
  threads, or the GPU, copy memory beyond the caches. The CSV file of the table has both rates.
- **B/vtx**: all memory of a simulation, on the heap (counted by the program's operator new) and in buffers of the GPU, per vertex.
  On llvmpipe it includes the driver's compiled programs.
- **allocs**: calls of operator new during all timed steps.
- **stretch**, **depth** and **state** are results of the timed run itself, so a fast but wrong solve would show.
- AVX3 is Highway's name for AVX-512.
- **load average** is given with each command. Above the number of hardware threads, other programs loaded the machine, which inflates
  wall times, and latencies most. Processor times suffer less, but not nothing: caches and the execution units of a core are shared.
)";

std::string cell(const nlohmann::json& row, const Column& column) {
  const std::string text = shown(row.value(column.key, nlohmann::json()), column.format);
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out == "-" ? "" : out;
}

std::string markdown(const std::vector<Column>& columns, const Rows& rows) {
  std::string out = "|", line = "|";
  for (const Column& column : columns) {
    out += fmt::format(" {} |", column.heading);
    line += "---|";
  }
  out += fmt::format("\n{}\n", line);
  for (const nlohmann::json& row : rows) {
    out += "|";
    for (const Column& column : columns) out += fmt::format(" {} |", cell(row, column));
    out += "\n";
  }
  return out;
}

const std::vector<Column> kStepColumns{{"case", "backend"},
                                       {"device", "device"},
                                       {"strands", "strands"},
                                       {"vertices", "vertices"},
                                       {"substeps", "substeps"},
                                       {"ms_min", "ms min", "{:.3f}"},
                                       {"ms_median", "median", "{:.3f}"},
                                       {"ms_p95", "p95", "{:.3f}"},
                                       {"cpu_ms", "cpu ms", "{:.3f}"},
                                       {"submit_ms", "submit ms", "{:.3f}"},
                                       {"wait_ms", "wait ms", "{:.3f}"},
                                       {"gpu_ms", "gpu ms", "{:.4f}"},
                                       {"air_gpu_ms", "air, gpu ms", "{:.4f}"},
                                       {"ns_per_vertex_substep", "ns/vtx/substep", "{:.2f}"},
                                       {"fraction_of_peak", "of peak", "{:.2f}"},
                                       {"fraction_of_peak_cpu", "cpu", "{:.2f}"},
                                       {"fraction_of_copy", "of copy", "{:.3f}"},
                                       {"bytes_per_vertex", "B/vtx", "{:.0f}"},
                                       {"allocations", "allocs"},
                                       {"max_stretch", "max stretch", "{:.1e}"},
                                       {"max_penetration_m", "depth m", "{:.1e}"},
                                       {"state_hash", "state"}};

const std::vector<Column> kRodColumns{{"scene", "scene"},
                                      {"rest", "rest"},
                                      {"hair", "hair"},
                                      {"damping_s", "damping s"},
                                      {"bodies", "bodies"},
                                      {"strands", "strands"},
                                      {"vertices", "vertices"},
                                      {"gpu_ms", "gpu ms", "{:.4f}"},
                                      {"ms_median", "ms median", "{:.3f}"},
                                      {"submit_ms", "submit ms", "{:.3f}"},
                                      {"bytes_per_vertex", "B/vtx", "{:.0f}"},
                                      {"max_stretch", "max stretch", "{:.1e}"},
                                      {"max_penetration_m", "depth m", "{:.1e}"},
                                      {"state_hash", "state"}};

/// The section of a file of results.
struct Section {
  const char* file;
  const char* title;
  const char* text;  // above the table
  std::vector<Column> columns;
  std::string (*plot)(const Rows&) = nullptr;
  std::string (*conclusions)(const Rows&) = nullptr;
};

std::string scalingConclusions(const Rows& rows) {
  std::string out;
  for (const AxisFit& fit : fitAxes(rows))
    out += fmt::format("- time ~ {}^{:.3f} (standard error {:.3f}, {} points)\n", fit.axis, fit.law.exponent,
                       fit.law.standard_error, fit.points);
  return out;
}

std::string peersConclusions(const Rows& rows) {
  std::string out =
      "| stretch at most | rod, ns per vertex and frame | gauss_seidel | Bullet | Bullet over rod |\n"
      "|---|---|---|---|---|\n";
  for (const double target : {0.1, 0.01, 0.001, 0.0001}) {
    out += fmt::format("| {:g} % |", 100 * target);
    double rod = 0, bullet = 0;
    for (const char* solver : {"rod", "gauss_seidel", "bullet"}) {
      const auto row = cheapestWithin(rows, solver, target);
      if (!row) {
        out += " not reached |";
        continue;
      }
      const double ns = (*row)["ns_per_vertex_frame"];
      if (std::string(solver) == "rod") rod = ns;
      if (std::string(solver) == "bullet") bullet = ns;
      const nlohmann::json iterations = row->value("iterations", nlohmann::json());
      out += fmt::format(" {:.1f} ({}{}) |", ns, (*row)["substeps"].dump(),
                         iterations.is_null() ? "" : " x " + iterations.dump());
    }
    out += rod > 0 && bullet > 0 ? fmt::format(" {:.0f} |\n", bullet / rod) : " |\n";
  }
  out += "\nIn brackets: substeps per frame x iterations per substep. ";
  if (const auto ratio = bulletOverRod(rows, 4))
    out += fmt::format(
        "The rod at its default of 4 substeps stretches {:.2g} % at most; Bullet's ropes {} {:.0f} times its "
        "cost{}.\n",
        100 * ratio->stretch, ratio->reached ? "reach that at" : "do not reach that: at", ratio->ratio,
        ratio->reached
            ? ""
            : fmt::format(" they stretch {:.2g} %", 100 * ratio->bullet["max_stretch"].get<double>()));
  else
    out += "This run had no Bullet.\n";
  out += "\nAt equal steps:\n\n";
  Rows equal;
  for (const nlohmann::json& row : rows) {
    const nlohmann::json iterations = row.value("iterations", nlohmann::json());
    if (row["substeps"] == 4 && (iterations.is_null() || iterations <= 16)) equal.push_back(row);
  }
  return out + markdown({{"solver", "solver"},
                         {"substeps", "substeps"},
                         {"iterations", "iterations"},
                         {"ns_per_vertex_frame", "ns/vtx/frame", "{:.1f}"},
                         {"mean_stretch", "mean stretch", "{:.1e}"},
                         {"max_stretch", "max", "{:.1e}"},
                         {"tip_error_mm", "tip error mm", "{:.1f}"},
                         {"bytes_per_vertex", "B/vtx", "{:.0f}"},
                         {"allocations", "allocs"}},
                        equal);
}

const std::vector<Column> kLatencyColumns{{"rate_hz", "Hz"},
                                          {"fps_cast", "cast/s", "{:.1f}"},
                                          {"fps_grown", "grown/s", "{:.1f}"},
                                          {"frames_late", "late"},
                                          {"frames_lost", "lost"},
                                          {"wake_ms", "wake", "{:.2f}"},
                                          {"step_ms", "step", "{:.2f}"},
                                          {"publish_ms", "publish", "{:.2f}"},
                                          {"encode_ms_apart", "(encode)", "{:.2f}"},
                                          {"wire_ms", "wire", "{:.2f}"},
                                          {"decode_ms_apart", "(decode)", "{:.2f}"},
                                          {"take_ms", "take", "{:.2f}"},
                                          {"grow_ms", "grow", "{:.2f}"},
                                          {"ms_median", "all p50", "{:.2f}"},
                                          {"ms_p95", "p95", "{:.2f}"},
                                          {"ms_p99", "p99", "{:.2f}"},
                                          {"ms_max", "max", "{:.2f}"},
                                          {"max_stretch", "max stretch", "{:.1e}"},
                                          {"hairs", "hairs"},
                                          {"grown_on", "grown on"}};

const std::vector<Column> kGridColumns{{"device", "device"},   {"strands", "strands"},
                                       {"cells", "cells"},     {"pass", "pass"},
                                       {"ms", "ms", "{:.3f}"}, {"of_strand_step", "of a step", "{:.2f}"}};

const std::vector<Section>& sections() {
  static const std::vector<Section> list{
      {"step", "A step on every backend", "", kStepColumns},
      {"step_10k", "10,000 x 32", "Curly hair under a head that is shaken twice a second.", kStepColumns},
      {"gpu_100k_alone", "100,000 x 32 on the GPU", "", kStepColumns},
      {"gpu_100k_all", "100,000 x 32 on the GPU with everything",
       "A distance field, five primitives, wind and forces between hairs on grids of 64^3.", kStepColumns},
      {"gpu_4k_alone", "4,000 x 32 on the GPU", "", kStepColumns},
      {"gpu_4k_all", "4,000 x 32 on the GPU with everything", "", kStepColumns},
      {"scaling",
       "Scaling",
       "`value` is the value of the axis. Sizes, lanes and grooms run on one thread and are compared in "
       "processor time. Threads are compared in wall time, with interleaved steps. Lanes are compared with "
       "the float reference backend, and grooms (one head of hair split into this many grooms in one "
       "process) with one groom. Readers are processes that read one stream over DDS.",
       {{"axis", "axis"},
        {"value", "value"},
        {"device", "device"},
        {"ms_min", "ms min", "{:.3f}"},
        {"ms_median", "median", "{:.3f}"},
        {"cpu_ms_min", "cpu ms min", "{:.3f}"},
        {"bytes_per_vertex", "B/vtx", "{:.0f}"},
        {"allocations", "allocs"},
        {"max_stretch", "max stretch", "{:.1e}"},
        {"speedup", "speedup", "{:.2f}"},
        {"efficiency", "efficiency", "{:.2f}"},
        {"same_hash", "same state"},
        {"publish_ms", "publish ms", "{:.2f}"},
        {"latency_ms_p50", "latency p50", "{:.2f}"},
        {"latency_ms_p99", "p99", "{:.2f}"},
        {"frames_lost", "lost"}},
       scalingPlot,
       scalingConclusions},
      {"peers",
       "Peers",
       "Straight hair of 25 cm and 32 edges under gravity, with the root shaken 5 cm to either side twice a "
       "second; frames of 1/60 s. `gauss_seidel` is the scheme of TressFX: Verlet integration and distance "
       "constraints in two colours; it runs as a rope, without a rest shape. Bullet is the soft-body rope of "
       "Debian's package (its own release flags): one `btSoftBodyHelpers::CreateRope` per strand, rigid "
       "links (`m_kLST = 1`) in order from the root, which is the best order for a rope, and the position "
       "iterations of each setting. In Bullet's favour its bodies step without a world, a broad phase or "
       "collisions, and reading the positions is not counted. Masses, gravity, drag, steps and the motion of "
       "the root are equal, and both use one thread. Times are the least processor time of a frame. Tips are "
       "compared with an exact rod; ropes have no bending stiffness, so they cannot match it.",
       {},
       peersPlot,
       peersConclusions},
      {"end_to_end", "End to end, to decoded guides",
       "Latency from the motion of the head through simulation, codec and DDS between two processes to "
       "decoded guides in a renderer. Medians per phase, ms; `publish` is encoding and passing the chunks to "
       "DDS, `wire` the remaining time until everything is received and decoded. In brackets: encoding and "
       "decoding alone, on further frames.",
       kLatencyColumns, latencyPlot},
      {"end_to_end_grown", "End to end, to grown hair",
       "The same until the device's fence signals that the hair is grown. A renderer that is slower than the "
       "frame rate skips frames.",
       kLatencyColumns, latencyPlot},
      {"wire",
       "Codecs",
       "Between two processes; `strandcast validate wire` scores the same cases. Processor time of each "
       "process, in percent of one core.",
       {{"transport", "transport"},
        {"codec", "codec"},
        {"strands", "guides"},
        {"rate_hz", "Hz"},
        {"bytes_per_vertex", "B/vertex", "{:.3f}"},
        {"frame_bytes", "B/frame", "{:.0f}"},
        {"max_error_mm", "error mm", "{:.2g}"},
        {"frames_lost", "lost", "{:.0f}"},
        {"latency_ms_p50", "latency p50, ms", "{:.2f}"},
        {"latency_ms_p99", "p99", "{:.2f}"},
        {"publisher_percent", "publisher %", "{:.0f}"},
        {"reader_percent", "reader %", "{:.0f}"}}},
      {"contact",
       "Contact",
       "",
       {{"case", "case"},
        {"device", "device"},
        {"strands", "strands"},
        {"ms_median", "ms", "{:.3f}"},
        {"cpu_ms", "cpu ms", "{:.3f}"},
        {"ns_per_vertex_substep", "ns/vtx/substep", "{:.2f}"},
        {"vertices_pressed", "vertices pressed"},
        {"ratio", "ratio", "{:.2f}"},
        {"bytes_per_vertex", "B/vtx", "{:.0f}"},
        {"allocations", "allocs"},
        {"max_stretch", "max stretch", "{:.1e}"},
        {"max_penetration_m", "depth m", "{:.1e}"}}},
      {"grid", "Air and hair on grids", "", kGridColumns},
      {"gpu_grid", "Air and hair on the GPU's grids",
       "Each pass alone; `all` is all passes as they run in a step.", kGridColumns},
      {"render",
       "Growth of hair",
       "",
       {{"device", "device"},
        {"guides", "guides"},
        {"hairs", "hairs"},
        {"vertices", "vertices"},
        {"guide_nodes_ms", "guide nodes ms", "{:.3f}"},
        {"growth_ms", "growth ms", "{:.3f}"},
        {"hairs_per_second", "hairs/s", "{:.3g}"},
        {"growth_error", "error/length", "{:.1e}"}}},
      {"render_passes",
       "Passes of a picture",
       "1920 x 1080 with four samples per pixel, one light with deep opacity maps. Guides and growth are "
       "compute passes, the following ones draw.",
       {{"device", "device"},
        {"hairs", "hairs"},
        {"vertices", "vertices"},
        {"guides_ms", "guides ms", "{:.2f}"},
        {"grow_ms", "grow ms", "{:.2f}"},
        {"shadow_ms", "shadow ms", "{:.2f}"},
        {"body_ms", "body ms", "{:.2f}"},
        {"hair_ms", "hair ms", "{:.2f}"},
        {"resolve_ms", "resolve ms", "{:.2f}"},
        {"hairs_drawn", "hairs drawn"},
        {"growth_bytes", "bytes of growth", "{:.3g}"},
        {"device_bytes", "bytes in all", "{:.3g}"}}},
      {"step_rod", "The rod on the GPU, over kinds of hair and sizes", "", kRodColumns},
      {"step_hair", "Cost of uneven hair on the GPU", "docs/solver.md explains the differences.",
       kRodColumns},
      {"accuracy", "Cost and error of the solvers' settings", "docs/solver.md explains the columns.", {}}};
  return list;
}

/// The columns of a file, the first 14 at most.
std::vector<Column> wholeFile(const CsvFile& file) {
  constexpr size_t kMax = 14;
  std::vector<Column> columns;
  for (const std::string& key : file.columns)
    if (columns.size() < kMax) columns.push_back({key, key});
  return columns;
}

/// Columns for which at least one row has a value.
std::vector<Column> usedColumns(const std::vector<Column>& columns, const Rows& rows) {
  std::vector<Column> used;
  for (const Column& column : columns)
    for (const nlohmann::json& row : rows)
      if (!row.value(column.key, nlohmann::json()).is_null()) {
        used.push_back(column);
        break;
      }
  return used;
}

class Page {
 public:
  explicit Page(const fs::path& results) {
    std::set<fs::path> machines;
    if (fs::is_directory(results))
      for (const auto& entry : fs::directory_iterator(results))
        if (entry.is_directory()) machines.insert(entry.path());
    if (machines.empty())
      throw Error("the folder has no results", results.string(), "create them: strandbench all --save");
    out.text = kIntroduction;
    for (const fs::path& machine : machines) addMachine(machine.filename().string(), readResults(machine));
  }
  PerformancePage out;

 private:
  void addMachine(const std::string& machine, const Results& results) {
    out.text += fmt::format("\n# {}\n", machine);
    addHeadlines(headlinesOf(results));
    for (const Section& section : sections())
      if (const auto found = results.find(section.file); found != results.end())
        addSection(machine, section, found->second);
    for (const auto& [name, file] : results) {
      const bool known = std::any_of(sections().begin(), sections().end(),
                                     [&](const Section& section) { return section.file == name; });
      if (!known) addSection(machine, {name.c_str(), name.c_str(), "", {}}, file);
    }
  }

  void addHeadlines(const std::vector<Headline>& lines) {
    if (lines.empty()) return;
    Rows rows;
    for (const Headline& line : lines)
      rows.push_back({{"what", line.what},
                      {"measured", line.measured},
                      {"goal", line.goal},
                      {"holds", !line.holds   ? ""
                                : *line.holds ? "yes"
                                              : "**no**"},
                      {"command", fmt::format("`{}`", line.command)}});
    out.text += "\n" + markdown({{"what", "what"},
                                 {"measured", "measured"},
                                 {"goal", "goal"},
                                 {"holds", "holds"},
                                 {"command", "command"}},
                                rows);
  }

  void addSection(const std::string& machine, const Section& section, const CsvFile& file) {
    out.text += fmt::format("\n## {}\n\n", section.title);
    for (size_t i = 0; i < file.comments.size(); ++i)
      out.text += i == 0 ? fmt::format("`{}`", file.comments[0]) : fmt::format("; {}", file.comments[i]);
    out.text += fmt::format(" ([all numbers](../bench/results/{}/{}.csv))\n", machine, section.file);
    if (*section.text != 0) out.text += fmt::format("\n{}\n", section.text);
    if (section.plot != nullptr) {
      const std::string name = fmt::format("performance_{}_{}.svg", machine, section.file);
      out.images[name] = section.plot(file.rows);
      out.text += fmt::format("\n![{}](images/{})\n", section.title, name);
    }
    if (section.conclusions != nullptr) out.text += fmt::format("\n{}", section.conclusions(file.rows));
    if (std::string(section.file) == "peers") return;  // its conclusions are its tables
    const std::vector<Column> columns = section.columns.empty() ? wholeFile(file) : section.columns;
    out.text += fmt::format("\n{}", markdown(usedColumns(columns, file.rows), file.rows));
  }
};

}  // namespace

PerformancePage performancePage(const fs::path& results) { return Page(results).out; }

namespace {

namespace fs = std::filesystem;

struct ReportOptions {
  fs::path results = "bench/results", page = "docs/performance.md", images = "docs/images";
  bool check = false;
};

int report(const ReportOptions& o) {
  const PerformancePage page = performancePage(o.results);
  bool same = true;
  const auto put = [&](const fs::path& file, const std::string& text) {
    if (textOf(file) == text) return;
    same = false;
    fmt::print("{} {}\n", o.check ? "differs:" : "written:", file.string());
    if (!o.check) writeText(file, text);
  };
  put(o.page, page.text);
  for (const auto& [name, svg] : page.images) put(o.images / name, svg);
  return o.check && !same ? kExitCheckFailed : 0;
}

}  // namespace

std::function<int()> addReport(CLI::App& app) {
  const auto o = std::make_shared<ReportOptions>();
  app.footer("Run it in the project's root folder: the default paths are relative to it.");
  app.add_option("--results", o->results, "folder with a folder of CSV files per machine")
      ->capture_default_str();
  app.add_option("--page", o->page)->capture_default_str();
  app.add_option("--images", o->images, "folder of the page's plots")->capture_default_str();
  app.add_flag("--check", o->check,
               "write nothing; exit code 1 if a file differs from what would be written");
  return [o] { return report(*o); };
}

}  // namespace strandcast
