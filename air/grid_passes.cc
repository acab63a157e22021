#include "air/grid_passes.h"

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include "core/error.h"

namespace strandcast {

struct Workers::Arena {
  oneapi::tbb::task_arena tasks;
};

Workers::Workers(int threads)
    : threads_(threads > 0 ? threads : oneapi::tbb::info::default_concurrency()),
      arena_(std::make_unique<Arena>()) {
  arena_->tasks.initialize(threads_);
}
Workers::~Workers() = default;

void Workers::run(int count, void (*call)(const void*, int), const void* work) const {
  if (threads_ == 1 || count == 1) {
    for (int i = 0; i < count; ++i) call(work, i);
    return;
  }
  arena_->tasks.execute([&] {
    oneapi::tbb::parallel_for(
        0, count, [&](int i) { call(work, i); }, oneapi::tbb::static_partitioner());
  });
}

const GridPasses<float>& passesOf(const std::string& backend) {
  if (backend == "reference") return scalarPasses<float>();
  if (backend == "simd") return simdPasses();
  throw Error("there is no air for this backend on the CPU", backend, "choose simd or reference");
}

}  // namespace strandcast
