#pragma once
#include <memory>
#include <string>
#include <vector>

#include "air/wind_source.h"
#include "core/surroundings.h"

namespace strandcast {

/// Wind on a grid and forces between hairs (docs/air.md) for a backend: "reference" (float, scalar, one
/// thread), "oracle" (the same in double), "simd" (lanes, `threads`, 0 = all) or "gpu" (as simd: its grids
/// are on the CPU). Error on another name.
std::unique_ptr<Surroundings> makeSurroundings(const std::string& backend, int threads = 0,
                                               std::vector<WindSource> sources = {});

}  // namespace strandcast
