#pragma once
#include <sys/resource.h>

namespace strandcast {

/// Processor time used so far, s, user and kernel. `whose`: RUSAGE_SELF, all threads of this process, or
/// RUSAGE_THREAD, the calling thread.
inline double processorSeconds(int whose) {
  rusage used{};
  getrusage(whose, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

}  // namespace strandcast
