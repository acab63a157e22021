#pragma once
#include <vector>

#include "air/wind_source.h"
#include "core/external_forces.h"

namespace strandcast {

/// External forces whose wind sources can be replaced between steps.
class SteeredAir {
 public:
  virtual ~SteeredAir() = default;
  /// Replaces all sources, in the world frame, from the next step on. The velocity of the air is kept.
  /// Precondition: each source passes checkWindSource(). May allocate. When the first source is added or the
  /// last one removed, the caller must call Simulation::setParameters(), which queries
  /// ExternalForces::isNeeded() again.
  virtual void setSources(std::vector<WindSource> sources) = 0;
};

/// The interface of an air system that cpuAir() or gpuAir() made; null for other external forces.
SteeredAir* steeredAir(ExternalForces* air_system);

}  // namespace strandcast
