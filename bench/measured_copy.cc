#include "bench/measured_copy.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>
#include <thread>
#include <vector>

namespace strandcast {
namespace {

/// Bytes of the source and of the copy: twice the last-level cache each, clamped to 64 to 256 MiB to bound
/// the time.
size_t copiedBytes() {
  constexpr long kMin = 64L << 20, kMax = 256L << 20;
  return static_cast<size_t>(std::clamp(2 * sysconf(_SC_LEVEL3_CACHE_SIZE), kMin, kMax));
}

}  // namespace

double measuredCopy(int threads) {
  const size_t bytes = copiedBytes();
  const std::unique_ptr<char[]> from(new char[bytes]), to(new char[bytes]);
  // Each thread works on its own part, from the first touch on.
  const auto together = [&](const auto& work) {
    std::vector<std::thread> others;
    const auto part = [&](size_t t) {
      const size_t begin = bytes * t / static_cast<size_t>(threads),
                   end = bytes * (t + 1) / static_cast<size_t>(threads);
      work(from.get() + begin, to.get() + begin, end - begin);
    };
    for (int t = 1; t < threads; ++t) others.emplace_back(part, t);
    part(0);
    for (std::thread& other : others) other.join();
  };
  together([](char* source, char* copy, size_t count) {
    std::memset(source, 1, count);  // untouched pages all map to one zero page
    std::memset(copy, 2, count);
  });
  double best = 0;
  for (int attempt = 0; attempt < 3; ++attempt) {
    const auto start = std::chrono::steady_clock::now();
    together([](char* source, char* copy, size_t count) {
      std::memcpy(copy, source, count);
      asm volatile("" : : "r"(copy) : "memory");  // makes the compiler assume that the copy is read
    });
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    best = std::max(best, 2 * static_cast<double>(bytes) / seconds);
  }
  return best;
}

}  // namespace strandcast
