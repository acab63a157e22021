#include "bench/verbs.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "bench/bench_simulation.h"
#include "core/error.h"
#include "options/console.h"
#include "simd/simd_backend.h"
#include "validation/wire_suite.h"

namespace strandcast {
namespace {

struct WireOptions {
  std::vector<std::string> transports{"dds", "lcm"}, codecs;
  std::vector<int> strands{1000, 5000, 20000}, rates{60, 120};
  bool quick = false;
  PrintOptions print;
};

template <class T>
bool has(const std::vector<T>& list, const T& value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

/// The setting that an experiment's name describes: "dds delta16 5000x32 60 Hz".
struct Cast {
  std::string transport, codec;
  int strands = 0, vertices = 0, rate = 0;
};
Cast castOf(const std::string& name) {
  char transport[32], codec[32];
  Cast cast;
  const int read = std::sscanf(name.c_str(), "%31s %31s %dx%d %d Hz", transport, codec, &cast.strands,
                               &cast.vertices, &cast.rate);
  if (read != 5) throw Error("this is not a case of the wire suite", name, "");
  cast.transport = transport;
  cast.codec = codec;
  return cast;
}

int wire(WireOptions o) {
  if (o.quick) {
    o.transports = {"dds"};
    o.strands = {5000};
    o.rates = {60};
  }
  Bench bench;
  bench.name = "wire";
  bench.params = {{"quick", o.quick}};
  bench.table = Table({{"case", ""},
                       {"transport", "transport"},
                       {"codec", "codec"},
                       {"strands", "strands"},
                       {"vertices"},
                       {"rate_hz", "Hz"},
                       {"bytes_per_vertex", "B/vertex", "{:.3f}"},
                       {"frame_bytes", "B/frame", "{:.0f}"},
                       {"max_error_mm", "error mm", "{:.2g}"},
                       {"frames_lost", "lost", "{:.0f}"},
                       {"latency_ms_p50", "p50 ms", "{:.2f}"},
                       {"latency_ms_p99", "p99 ms", "{:.2f}"},
                       {"publisher_percent", "sends %", "{:.0f}"},
                       {"reader_percent", "reads %", "{:.0f}"},
                       {"note", "of p99"}});
  std::vector<std::pair<Cast, const Experiment*>> chosen;
  for (const Experiment& experiment : wireSuite().experiments) {
    const Cast cast = castOf(experiment.about);
    if (has(o.transports, cast.transport) && has(o.strands, cast.strands) && has(o.rates, cast.rate) &&
        (o.codecs.empty() || has(o.codecs, cast.codec)))
      chosen.emplace_back(cast, &experiment);
  }
  if (chosen.empty())
    throw Error("the options select no case", "strandbench wire", "choose values listed by --help");
  {
    ProgressBar bar;
    const Laboratory laboratory([] { return makeSimdBackend(); }, SolverKind::kRod);
    for (size_t i = 0; i < chosen.size(); ++i) {
      const auto& [cast, experiment] = chosen[i];
      bar.show(experiment->about, static_cast<double>(i) / static_cast<double>(chosen.size()));
      const std::vector<Case> cases = experiment->run(laboratory);
      bench.table.add({{"case", experiment->about},
                       {"transport", cast.transport},
                       {"codec", cast.codec},
                       {"strands", cast.strands},
                       {"vertices", cast.vertices},
                       {"rate_hz", cast.rate},
                       {"bytes_per_vertex", cases.at(0).measured},
                       {"frame_bytes", cases.at(0).measured * cast.strands * cast.vertices},
                       {"max_error_mm", cases.at(1).measured},
                       {"frames_lost", cases.at(2).measured},
                       {"latency_ms_p50", cases.at(3).measured},
                       {"latency_ms_p99", cases.at(4).measured},
                       {"publisher_percent", cases.at(5).measured},
                       {"reader_percent", cases.at(6).measured},
                       {"note", cases.at(4).note}});
    }
  }
  print(bench, o.print);
  return 0;
}

}  // namespace

std::function<int()> addWireBench(CLI::App& app) {
  const auto o = std::make_shared<WireOptions>();
  app.footer(
      "Runs the cases of `strandcast validate wire`, which also checks their limits. Latency: from publish "
      "to decoded,\n"
      "between two processes; sends, reads: processor time of either process, in percent of one core.\n"
      "Examples:\n"
      "  strandbench wire --quick\n"
      "  strandbench wire --transports lcm --codecs tangent,delta16 --strands 5000 --rates 120");
  app.add_option("--transports", o->transports, "transports: dds, lcm")
      ->delimiter(',')
      ->check(CLI::IsMember({"dds", "lcm"}));
  app.add_option("--codecs", o->codecs, "codecs by name; empty = all")->delimiter(',');
  app.add_option("--strands", o->strands, "numbers of strands of 32 vertices: 1000, 5000, 20000")
      ->delimiter(',')
      ->check(CLI::IsMember({1000, 5000, 20000}));
  app.add_option("--rates", o->rates, "frame rates, Hz: 60, 120")
      ->delimiter(',')
      ->check(CLI::IsMember({60, 120}));
  app.add_flag("--quick", o->quick, "only 5,000 strands over DDS at 60 Hz");
  addPrintOptions(app, o->print);
  return [o] { return wire(*o); };
}

}  // namespace strandcast
