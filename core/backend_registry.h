#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/backend.h"

namespace strandcast {

/// Picks `name` ("auto" or a backend's name) from `known` and creates it. `auto` takes the highest score and
/// falls to the next when creation fails or it lacks the solver. A named backend that cannot run it is an
/// Error: nothing is replaced silently.
std::unique_ptr<Backend> createBackend(const std::vector<BackendInfo>& known, const std::string& name,
                                       int threads, SolverKind solver = SolverKind::kRod);

}  // namespace strandcast
