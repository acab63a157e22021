#include "apps/backends.h"

#include "gpu_compute/gpu_air.h"
#include "gpu_compute/gpu_backend.h"
#include "simd/simd_backend.h"

namespace strandcast {

std::vector<BackendInfo> knownBackends() {
  return {gpuBackendInfo(), simdBackendInfo(), referenceBackendInfo()};
}

AirMaker airOf(const std::string& backend, int threads) {
  return backend == "gpu" ? gpuAir() : cpuAir(backend, threads);
}

}  // namespace strandcast
