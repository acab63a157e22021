#pragma once
#include <functional>
#include <string>
#include <vector>

#include "validation/case.h"
#include "validation/laboratory.h"

namespace strandcast {

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

}  // namespace strandcast
