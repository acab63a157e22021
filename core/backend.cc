#include "core/backend.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace strandcast {
namespace {

bool has(const BackendInfo& info, SolverKind solver) {
  return std::find(info.solvers.begin(), info.solvers.end(), solver) != info.solvers.end();
}

}  // namespace

std::unique_ptr<Backend> createBackend(const std::vector<BackendInfo>& known, const std::string& name,
                                       int threads, SolverKind solver) {
  if (name != "auto") {
    std::string names = "auto";
    for (const BackendInfo& info : known) {
      names += ", " + info.name;
      if (info.name != name) continue;
      if (!info.available)
        throw Error("backend " + name + " cannot run", info.reason, "choose --backend auto");
      if (!has(info, solver))
        throw Error("backend " + name + " does not have this solver", solverName(solver),
                    "choose another --solver or --backend auto");
      return info.create(threads);
    }
    throw Error("unknown backend", name, "choose one of " + names);
  }
  std::vector<const BackendInfo*> best;
  for (const BackendInfo& info : known)
    if (info.available && has(info, solver)) best.push_back(&info);
  std::stable_sort(best.begin(), best.end(), [](auto* a, auto* b) { return a->score > b->score; });
  for (const BackendInfo* info : best) {
    try {
      return info->create(threads);
    } catch (const Error&) {  // `auto`: try the next backend
    }
  }
  throw Error("no backend can run", "backend auto", "see `strandcast info --backends`");
}

}  // namespace strandcast
