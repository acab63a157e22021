#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/backend.h"

namespace strandcast {

/// Creates the backend `name` ("auto" or a backend's name) from `known`. `auto` takes the available one of
/// highest score that has the solver; if creation fails it tries the next. Throws Error if none can run. A
/// named backend that cannot run is an Error, too: there is no silent fallback.
std::unique_ptr<Backend> createBackend(const std::vector<BackendInfo>& known, const std::string& name,
                                       int threads, SolverKind solver = SolverKind::kRod);

}  // namespace strandcast
