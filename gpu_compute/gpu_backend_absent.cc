// Replaces gpu_backend.cc and gpu_air.cc in builds without OpenGL.
#include "core/error.h"
#include "gpu_compute/gpu_air.h"
#include "gpu_compute/gpu_backend.h"

namespace strandcast {
namespace {

constexpr const char* kReason =
    "built without OpenGL: libepoxy-dev and libegl-dev were missing when the build was configured";

}  // namespace

std::unique_ptr<Backend> makeGpuBackend(std::optional<size_t>) {
  throw Error("no gpu backend", kReason, "install them and build again");
}

BackendInfo gpuBackendInfo() {
  return {"gpu", false, kReason, 0, [](int) { return makeGpuBackend(); }};
}

std::vector<GpuListing> gpuList() { return {}; }

AirFactory gpuAir() { throw Error("no gpu backend", kReason, "install them and build again"); }

}  // namespace strandcast
