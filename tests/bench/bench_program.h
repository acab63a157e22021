#pragma once
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

namespace strandcast {

/// Standard output and exit status of strandbench with these arguments.
struct BenchOutput {
  std::string text;
  int status = -1;
};
inline BenchOutput runBench(const std::string& arguments) {
  BenchOutput out;
  FILE* pipe = popen((STRANDCAST_BENCH " " + arguments).c_str(), "r");
  if (pipe == nullptr) return out;
  std::array<char, 4096> buffer;
  for (size_t got = 0; (got = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    out.text.append(buffer.data(), got);
  const int status = pclose(pipe);
  out.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return out;
}
/// The output with --json, parsed; null where the program failed.
inline nlohmann::json benchJson(const std::string& arguments) {
  const BenchOutput out = runBench(arguments + " --json");
  return out.status == 0 ? nlohmann::json::parse(out.text, nullptr, false) : nlohmann::json();
}

}  // namespace strandcast
