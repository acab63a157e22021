#pragma once
#include <functional>
#include <string>
#include <vector>

#include "validation/case.h"
#include "validation/laboratory.h"

namespace strandcast {

/// One or more cases that are measured together.
struct Experiment {
  std::string about;               ///< what is done, one line
  std::vector<std::string> cases;  ///< their names, in the order in which `run` gives them
  std::function<std::vector<Case>(const Laboratory&)> run;
};

struct Suite {
  std::string name;
  std::string about;
  std::vector<Experiment> experiments;
};

/// "cantilever", "physics", "air", "volume", "contact" and "tunnel".
const std::vector<Suite>& validationSuites();
/// Error on an unknown name.
const Suite& validationSuite(const std::string& name);

/// A cantilever of one's own choice.
struct CantileverNumbers {
  double gamma = 1;             ///< gravito-bending number, 1e-3 to 1e4
  int vertices = 32;            ///< beside the clamped one, 2 to 127
  double time_step = 1 / 360.;  ///< s, one substep
  double damping = 5;           ///< 1/s, air drag; more than 0
};
/// The suite "cantilever" with this one alone, against its own exact solution. The limit follows from those
/// of the standard cases: 0.2 % up to gamma 10, 0.6 % up to 100, at 32 vertices, 1.5 % above, at 64; by the
/// square of the spacing more with fewer vertices. Error on numbers out of range.
Suite cantileverSuite(const CantileverNumbers& numbers);

/// The suite with the cases alone whose name has `only` in it. Error where no case has such a name.
Suite partOf(Suite suite, const std::string& only);

/// The cases of the suite whose name has `only` in it (all where that is empty), in the suite's order.
/// `starting` is told, before each experiment, what it does and which part of all experiments is done. Ends
/// early, with the cases so far, where the laboratory is stopped. Error where no case has such a name.
std::vector<Case> runSuite(const Suite& suite, const Laboratory& laboratory, const std::string& only = "",
                           const std::function<void(const std::string&, double)>& starting = {});

}  // namespace strandcast
