#pragma once
#include <string>
#include <utility>
#include <vector>

#include "air/air_system.h"

namespace strandcast {

/// Makers of the air system in compute shaders: wind and forces between hairs. ExternalForces work in the
/// memory of the gpu backend that they are configured with; a Wind by itself makes its own context. The
/// makers throw Error without OpenGL 4.5.
AirFactory gpuAir();

/// GPU times of the passes of an air system that gpuAir() made.
class MeasuredPasses {
 public:
  virtual ~MeasuredPasses() = default;
  /// Measures the steps that follow. `each`: every pass by itself; else only whole steps, as "all". Reserves
  /// memory for `steps` steps; these do not allocate.
  virtual void measure(bool each, int steps) = 0;
  /// Pass names and milliseconds of the steps since the last call, in order. Waits for the GPU.
  virtual std::vector<std::pair<std::string, double>> drainTimes() = 0;
  /// Report of the newest step's pressure solve; its residual is relative to the largest velocity component.
  /// Waits for the GPU.
  virtual PressureReport pressure() = 0;
};

}  // namespace strandcast
