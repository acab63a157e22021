#pragma once
#include <vector>

#include "air/wind_source.h"
#include "core/surroundings.h"

namespace strandcast {

/// Surroundings whose sources of wind may be changed between steps.
class SteeredAir {
 public:
  virtual ~SteeredAir() = default;
  /// Those that blow from the next step on, in the world, in place of those before; the air itself stays as
  /// it is. They are to be as checkWindSource() asks. May allocate. Where the first comes or the last goes,
  /// Simulation::setParameters() has to follow, which asks Surroundings::isNeeded() anew.
  virtual void setSources(std::vector<WindSource> sources) = 0;
};

/// Of surroundings that cpuAir() or gpuAir() made; null for others.
SteeredAir* steeredAir(Surroundings* surroundings);

}  // namespace strandcast
