#include "bench/machine.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <thread>
#include <vector>

#include "simd/simd_backend.h"

namespace strandcast {
namespace {

std::string cpuName() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (!line.starts_with("model name")) continue;
    const size_t value = line.find_first_not_of(" \t", line.find(':') + 1);
    if (value != std::string::npos) return line.substr(value);
  }
  return "unknown CPU";
}

}  // namespace

Machine thisMachine() {
  const std::vector<std::string> sets = simdTargets();
  return {cpuName(), static_cast<int>(std::thread::hardware_concurrency()),
          sets.empty() ? "scalar" : sets.front()};
}

std::string describe(const Machine& machine) {
  return fmt::format("{}, {} thread{}, {}", machine.cpu, machine.cores, machine.cores == 1 ? "" : "s",
                     machine.instruction_set);
}

double loadAverage() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : 0;
}

std::string folderNameOf(const std::string& name) {
  std::string out;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!out.empty() && out.back() != '-')
      out += '-';
  }
  while (out.ends_with('-')) out.pop_back();
  return out.empty() ? "unknown" : out;
}

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
