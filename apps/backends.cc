#include "apps/backends.h"

#include "gpu_compute/gpu_backend.h"
#include "simd/simd_backend.h"

namespace strandcast {

std::vector<BackendInfo> knownBackends() {
  return {gpuBackendInfo(), simdBackendInfo(), referenceBackendInfo()};
}

}  // namespace strandcast
