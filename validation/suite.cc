#include "validation/suite.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/error.h"
#include "validation/experiments.h"

namespace strandcast {
namespace {

Case scored(const Quantity& quantity, double measured, double truth, double error, double limit,
            const std::string& error_unit) {
  return {quantity.name, quantity.quantity, quantity.unit,  measured, truth, error,
          limit,         error_unit,        error <= limit, ""};
}

}  // namespace

std::vector<std::string> caseNames(std::string_view pattern, std::span<const double> values) {
  std::vector<std::string> names;
  for (const double value : values) names.push_back(fmt::format(fmt::runtime(pattern), value));
  return names;
}

double worse(double a, double b) { return std::isnan(a) || a > b ? a : b; }

Case relativeCase(const Quantity& quantity, double measured, double truth, double limit_percent) {
  return scored(quantity, measured, truth, 100 * std::fabs(measured / truth - 1), limit_percent, "%");
}

Case absoluteCase(const Quantity& quantity, double measured, double truth, double limit) {
  return scored(quantity, measured, truth, std::fabs(measured - truth), limit, quantity.unit);
}

Case atLeastCase(const Quantity& quantity, double measured, double truth, double limit) {
  const double error = measured >= truth ? 0 : truth - measured;
  return scored(quantity, measured, truth, error, limit, quantity.unit);
}

const std::vector<Suite>& validationSuites() {
  static const std::vector<Suite> suites = [] {
    Suite cantilever{"cantilever", "a heavy clamped elastica at rest, for weights over five decades", {}};
    addCantileverExperiments(cantilever.experiments);
    Suite physics{"physics", "rest shapes, vibrations, buckling, invariances and abuse", {}};
    addRestExperiments(physics.experiments);
    addVibrationExperiments(physics.experiments);
    addBendTwistExperiments(physics.experiments);
    addInvarianceExperiments(physics.experiments);
    addMotionExperiments(physics.experiments);
    addGuardExperiments(physics.experiments);
    Suite air{"air", "wind on a grid: convergence, divergence, obstacles; a strand in the wind", {}};
    addAirExperiments(air.experiments);
    Suite volume{"volume", "forces between hairs: volume, momentum, rest", {}};
    addVolumeExperiments(volume.experiments);
    Suite contact{"contact", "friction, penetration, rest and energy of hair on bodies", {}};
    addFrictionExperiments(contact.experiments);
    addContactExperiments(contact.experiments);
    Suite tunnel{"tunnel", "strands swept by a thin plate at 10 m/s", {}};
    addTunnelExperiments(tunnel.experiments);
    return std::vector<Suite>{cantilever, physics, air, volume, contact, tunnel};
  }();
  return suites;
}

const Suite& validationSuite(const std::string& name) {
  std::string names;
  for (const Suite& suite : validationSuites()) {
    if (suite.name == name) return suite;
    names += (names.empty() ? "" : ", ") + suite.name;
  }
  throw Error("unknown suite", name, "choose one of " + names + ", or see `strandcast validate --help`");
}

Suite partOf(Suite suite, const std::string& only) {
  for (Experiment& experiment : suite.experiments)
    std::erase_if(experiment.cases,
                  [&](const std::string& name) { return name.find(only) == std::string::npos; });
  std::erase_if(suite.experiments, [](const Experiment& experiment) { return experiment.cases.empty(); });
  if (suite.experiments.empty())
    throw Error("no case of this suite has '" + only + "' in its name", suite.name,
                "see `strandcast validate " + suite.name + " --list`");
  return suite;
}

std::vector<Case> runSuite(const Suite& suite, const Laboratory& laboratory, const std::string& only,
                           const std::function<void(const std::string&, double)>& starting) {
  const std::vector<Experiment> chosen = partOf(suite, only).experiments;
  std::vector<Case> cases;
  try {
    for (size_t i = 0; i < chosen.size(); ++i) {
      if (starting) starting(chosen[i].about, static_cast<double>(i) / static_cast<double>(chosen.size()));
      for (Case& measured : chosen[i].run(laboratory))
        if (measured.name.find(only) != std::string::npos) cases.push_back(std::move(measured));
    }
  } catch (const Laboratory::Stopped&) {
  }
  return cases;
}

}  // namespace strandcast
