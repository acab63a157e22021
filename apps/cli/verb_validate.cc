#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>

#include "apps/cli/verbs.h"
#include "core/backend.h"
#include "core/error.h"
#include "options/console.h"
#include "options/number_range.h"
#include "service/scene_simulation.h"
#include "validation/pose_suite.h"
#include "validation/suite.h"
#include "validation/wire_suite.h"

namespace strandcast {
namespace {

struct ValidateOptions {
  std::string suite, backend = "auto", solver = "rod", only;
  int threads = 0;
  bool json = false, list = false;
  CantileverNumbers cantilever;
  bool own_cantilever = false;
  std::optional<double> minutes;
};

void printList(const Suite& suite) {
  for (const Experiment& experiment : suite.experiments) {
    fmt::print("{}\n", experiment.about);
    for (const std::string& name : experiment.cases) fmt::print("  {}\n", name);
  }
}

nlohmann::json toJson(const Case& c) {
  return {{"case", c.name},   {"quantity", c.quantity}, {"unit", c.unit},   {"value", c.measured},
          {"truth", c.truth}, {"error", c.error},       {"limit", c.limit}, {"error_unit", c.error_unit},
          {"pass", c.passed}, {"note", c.note}};
}

void printTable(const std::vector<Case>& cases) {
  size_t width = 4;
  for (const Case& c : cases) width = std::max(width, c.name.size());
  fmt::print("      {:<{}}  {:>12} {:>12}  {:>10} {:>8}\n", "case", width, "measured", "truth", "error",
             "limit");
  for (const Case& c : cases) {
    fmt::print("{:<4}  {:<{}}  {:>12.6g} {:>12.6g}  {:>10.3g} {:>8g} {:<8} {}{}\n", c.passed ? "ok" : "FAIL",
               c.name, width, c.measured, c.truth, c.error, c.limit, c.error_unit, c.quantity,
               c.unit.empty() ? "" : ", " + c.unit);
    if (!c.note.empty()) fmt::print("      {:<{}}  {}\n", "", width, c.note);
  }
}

/// All suites of the simulation as one.
Suite allSuites() {
  Suite all{"all", "every suite of the simulation", {}};
  for (const Suite& suite : validationSuites())
    all.experiments.insert(all.experiments.end(), suite.experiments.begin(), suite.experiments.end());
  return all;
}

/// Suites that are not part of the simulation's.
std::vector<Suite> otherSuites() {
  Suite light = lightSuite();
#ifdef STRANDCAST_HAS_RENDER
  addFibreShaderExperiments(light.experiments);
  addHairFurnaceExperiments(light.experiments);
  return {wireSuite(), poseSuite(), light, renderSuite()};
#else
  return {wireSuite(), poseSuite(), light};
#endif
}

Suite suiteOf(const ValidateOptions& o) {
  if (o.own_cantilever) {
    if (o.suite != "cantilever")
      throw Error("this suite takes no numbers of a cantilever", o.suite,
                  "give --gamma and so on to `cantilever` only");
    return cantileverSuite(o.cantilever);
  }
  if (o.minutes) {
    if (o.suite != "poses")
      throw Error("this suite has no duration to choose", o.suite, "give --minutes to `poses` only");
    return poseSuite(60 * *o.minutes);
  }
  if (o.suite == "all") return allSuites();
  for (const Suite& suite : otherSuites())
    if (o.suite == suite.name) return suite;
  return validationSuite(o.suite);
}

int validate(const ValidateOptions& o) {
  const Suite suite = suiteOf(o);
  if (o.list) {
    printList(partOf(suite, o.only));
    return 0;
  }
  const SolverKind solver = solverKind(o.solver);
  std::string name, device;
  auto backend = [&] {
    std::unique_ptr<Backend> made = createBackend(knownBackends(o.backend), o.backend, o.threads, solver);
    name = made->name();
    device = made->device();
    return made;
  };
  std::vector<Case> cases;
  {
    ProgressBar bar;
    const auto air = [&](const std::string& of) { return airOf(of, o.threads); };
    const Laboratory laboratory(
        backend, solver, [] { return g_interrupted.load(); }, air);
    cases = runSuite(suite, laboratory, o.only,
                     [&](const std::string& what, double part) { bar.show(what, part); });
  }
  const auto passed = std::count_if(cases.begin(), cases.end(), [](const Case& c) { return c.passed; });
  const auto failed = static_cast<long>(cases.size()) - passed;
  if (o.json) {
    nlohmann::json list = nlohmann::json::array();
    for (const Case& c : cases) list.push_back(toJson(c));
    nlohmann::json out{{"name", suite.name},
                       {"pass", failed == 0},
                       {"results", list},
                       {"passed", passed},
                       {"failed", failed}};
    if (!name.empty()) out.update({{"backend", name}, {"device", device}, {"solver", solverName(solver)}});
    fmt::print("{}\n", jsonText(out));
  } else {
    // A suite that scores no backend creates none, so there is none to print.
    fmt::print("{}: {}{}\n", suite.name, suite.about,
               name.empty() ? "" : fmt::format(", on {} ({}), solver {}", name, device, solverName(solver)));
    printTable(cases);
    fmt::print("{} passed, {} failed\n", passed, failed);
  }
  if (g_interrupted) return kExitInterrupted;
  return failed > 0 ? kExitCheckFailed : 0;
}

}  // namespace

Verb addValidate(CLI::App& app) {
  const auto o = std::make_shared<ValidateOptions>();
  std::string suites;
  for (const Suite& suite : validationSuites())
    suites += fmt::format("\n  {:<12}{}", suite.name, suite.about);
  suites += fmt::format("\n  {:<12}{}", "all", "all suites above");
  for (const Suite& suite : otherSuites()) suites += fmt::format("\n  {:<12}{}", suite.name, suite.about);
  app.footer(
      "Suites:" + suites +
      "\n\nExit code 0: every case is within its limit; 1: a case failed; 2: the suite could not run.\n"
      "Examples:\n"
      "  strandcast validate cantilever --backend simd\n"
      "  strandcast validate cantilever --gamma 3.7 --vertices 40 --dt 0.002 --damping 1\n"
      "  strandcast validate physics --only helix --json\n"
      "  strandcast validate wire --only \"delta16 5000x32 60 Hz\"\n"
      "  strandcast validate poses --only \"lcm 60 Hz\" --minutes 20\n"
      "  strandcast validate cantilever --solver gauss_seidel   errors of the other solver");
  app.add_option("SUITE", o->suite, "suite to run")->required();
  app.add_option("--backend", o->backend, "auto, reference, simd or gpu")->capture_default_str();
  app.add_option("--solver", o->solver, "rod or gauss_seidel")->capture_default_str();
  app.add_option("--threads", o->threads, "threads of the simd backend; 0 = all")
      ->transform(wholeRange(0, 1024));
  app.add_option("--only", o->only, "run or list only the cases whose name contains this text");
  auto number = [&](const char* name, auto& value, const NumberRange& range, const char* help) {
    app.add_option_function<std::remove_reference_t<decltype(value)>>(
           name,
           [o, &value](const auto& given) {
             value = given;
             o->own_cantilever = true;
           },
           help)
        ->transform(inRange(range))
        ->group("One cantilever instead of the standard ones");
  };
  number("--gamma", o->cantilever.gamma, {0.001, 10000},
         "gravito-bending number 4 rho g L^3 / (E R^2), 0.001 to 10000 (1)");
  number("--vertices", o->cantilever.vertices, {2, 127, true}, "free vertices, 2 to 127 (32)");
  number("--dt", o->cantilever.time_step, {}, "time step, s (1/360)");
  number("--damping", o->cantilever.damping, {0.05, 100}, "air drag, 1/s, 0.05 to 100 (5)");
  app.add_option("--minutes", o->minutes, "duration of each row of `poses`, 0.07 to 600 (a third)")
      ->transform(inRange({0.07, 600}));
  app.add_flag("--list", o->list, "list the cases and their descriptions without running them");
  app.add_flag("--json", o->json, "print one JSON object");
  return [o] { return validate(*o); };
}

}  // namespace strandcast
