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

/// "cantilever", "physics", "contact" and "tunnel".
const std::vector<Suite>& validationSuites();
/// Error on an unknown name.
const Suite& validationSuite(const std::string& name);

/// The cases of the suite whose name has `only` in it (all where that is empty), in the suite's order.
/// `starting` is told, before each experiment, what it does and which part of all experiments is done. Ends
/// early, with the cases so far, where the laboratory is stopped. Error where no case has such a name.
std::vector<Case> runSuite(const Suite& suite, const Laboratory& laboratory, const std::string& only = "",
                           const std::function<void(const std::string&, double)>& starting = {});

}  // namespace strandcast
