#pragma once
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

namespace strandcast {

/// What strandbench prints on standard output, called with these arguments, and how it ended.
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
/// The same with --json; null where it did not end well.
inline nlohmann::json benchJson(const std::string& arguments) {
  const BenchOutput out = runBench(arguments + " --json");
  return out.status == 0 ? nlohmann::json::parse(out.text, nullptr, false) : nlohmann::json();
}

}  // namespace strandcast
