#pragma once
#include <string>
#include <utility>
#include <vector>

#include "air/air_maker.h"

namespace strandcast {

/// Air and forces between hairs in compute shaders. Surroundings work in the memory of the gpu backend that
/// they are configured with; a wind alone has a context of its own. The makers throw Error where there is no
/// OpenGL 4.5.
AirMaker gpuAir();

/// How long the GPU works on each pass of surroundings that gpuAir() made.
class MeasuredPasses {
 public:
  virtual ~MeasuredPasses() = default;
  /// `each`: every pass of the steps that follow, one after the other; else only "all" of a step. There is
  /// room for so many steps, so that they allocate nothing.
  virtual void measure(bool each, int steps) = 0;
  /// Milliseconds by pass, of the steps since the last call. Waits for them.
  virtual std::vector<std::pair<std::string, double>> takeTimes() = 0;
  /// How the newest step's pressure went; its residual over the fastest component of velocity. Waits.
  virtual PressureReport pressure() = 0;
};

}  // namespace strandcast
