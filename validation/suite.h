// Cases, experiments and suites, and how they are run.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "validation/laboratory.h"

namespace strandcast {

/// One measured quantity, compared with its exact value.
struct Case {
  std::string name;
  std::string quantity;
  std::string unit;  ///< of `measured` and `truth`; empty for pure numbers
  double measured = 0;
  double truth = 0;
  double error = 0;        ///< of `measured` relative to `truth`, 0 or more
  double limit = 0;        ///< largest error that passes
  std::string error_unit;  ///< of `error` and `limit`: "%" of the truth, or an absolute unit
  bool passed = false;     ///< error <= limit; false where a number is NaN
  std::string note;        ///< further information; may be empty
};

/// What a case measures.
struct Quantity {
  std::string name;  ///< name of the case
  std::string quantity;
  std::string unit;
};

/// Names of cases, one per value: `pattern` has {:g} in place of the value.
std::vector<std::string> caseNames(std::string_view pattern, std::span<const double> values);

/// The larger of two errors; NaN where either is NaN.
double worse(double a, double b);

/// Error in percent of the truth.
Case relativeCase(const Quantity& quantity, double measured, double truth, double limit_percent);
/// Error in the unit of the quantity.
Case absoluteCase(const Quantity& quantity, double measured, double truth, double limit);
/// A measured value of at least `truth` has the error 0.
Case atLeastCase(const Quantity& quantity, double measured, double truth, double limit);

/// One or more cases that are measured together.
struct Experiment {
  std::string about;               ///< description, one line
  std::vector<std::string> cases;  ///< names of the cases, in the order of the results of `run`
  std::function<std::vector<Case>(const Laboratory&)> run;
};

struct Suite {
  std::string name;
  std::string about;
  std::vector<Experiment> experiments;
};

/// "cantilever", "physics", "air", "volume", "contact" and "tunnel".
const std::vector<Suite>& validationSuites();
/// Throws Error on an unknown name.
const Suite& validationSuite(const std::string& name);

/// Parameters of a custom cantilever.
struct CantileverNumbers {
  double gamma = 1;             ///< gravito-bending number, 1e-3 to 1e4
  int vertices = 32;            ///< vertices that are not clamped, 2 to 127
  double time_step = 1 / 360.;  ///< s, one substep
  double damping = 5;           ///< 1/s, air drag, above 0
};
/// The suite "cantilever" with this case only, compared with its own exact solution. The limit follows from
/// the standard cases: 0.2 % up to gamma 10 and 0.6 % up to 100, at 32 vertices; 1.5 % above, at 64. With
/// fewer vertices it grows with the square of the spacing. Throws Error on numbers out of range.
Suite cantileverSuite(const CantileverNumbers& numbers);

/// The suite reduced to the cases whose names contain `only`. Throws Error where there is none.
Suite partOf(Suite suite, const std::string& only);

/// Runs the cases whose names contain `only` (all where it is empty), in the suite's order. Before each
/// experiment calls starting(description, finished fraction of all experiments). Returns early, with the
/// cases so far, when the laboratory is stopped. Throws Error where no name contains `only`.
std::vector<Case> runSuite(const Suite& suite, const Laboratory& laboratory, const std::string& only = "",
                           const std::function<void(const std::string&, double)>& starting = {});

/// "light": scattering of light by a fibre against ray optics and quadrature. Ignores the laboratory's
/// backend.
Suite lightSuite();
/// Appends the experiments of "light" that need OpenGL 4.5: the shaders' values against C++.
void addFibreShaderExperiments(std::vector<Experiment>& experiments);
/// Appends those of whole heads, which the renderer grows and the path tracer lights.
void addHairFurnaceExperiments(std::vector<Experiment>& experiments);

/// "render": the renderer's shaders against slower exact references, e.g. grown hair against the CPU in
/// double precision. Ignores the laboratory's backend. Throws Error where there is no OpenGL 4.5.
const Suite& renderSuite();

}  // namespace strandcast
