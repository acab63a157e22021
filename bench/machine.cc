#include "bench/machine.h"

#include <fmt/format.h>

#include <cctype>
#include <cstdlib>
#include <fstream>
#include <thread>

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

}  // namespace strandcast
