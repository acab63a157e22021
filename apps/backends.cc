#include "apps/backends.h"

#include "gpu_compute/gpu_air.h"
#include "gpu_compute/gpu_backend.h"
#include "simd/simd_backend.h"

namespace strandcast {

std::vector<BackendInfo> knownBackends(const std::string& wanted) {
  std::vector<BackendInfo> of_processor = {simdBackendInfo(), referenceBackendInfo()};
  for (const BackendInfo& info : of_processor)
    if (info.name == wanted) return of_processor;
  of_processor.insert(of_processor.begin(), gpuBackendInfo());
  return of_processor;
}

AirFactory airOf(const std::string& backend, int threads) {
  return backend == "gpu" ? gpuAir() : cpuAir(backend, threads);
}

}  // namespace strandcast
