#include "bench/gpu_limits.h"
#include "core/error.h"

namespace strandcast {

GpuLimits measuredGpuLimits() {
  throw Error("this build has no OpenGL", "--backend gpu", "install libepoxy-dev and build again");
}

}  // namespace strandcast
