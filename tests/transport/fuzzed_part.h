#pragma once
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <span>
#include <string>
#include <string_view>

#include "fuzz_seeds.h"

namespace strandcast {

/// What one run of a fuzzer is about. `--only=NAME` leaves it the seeds of that name, whose first bytes,
/// which say what an input is, are then put in front of every input. `--seeds=FOLDER` writes the seeds there,
/// for libFuzzer to begin with.
class FuzzedPart {
 public:
  /// `prefix_length` of the first bytes. Ends the program on a name that there is not.
  FuzzedPart(int count, char** arguments, const std::vector<FuzzSeeds>& all, size_t prefix_length) {
    const std::string only = option(count, arguments, "--only=");
    const std::string folder = option(count, arguments, "--seeds=");
    std::vector<FuzzSeeds> chosen;
    for (const FuzzSeeds& seeds : all) {
      if (only.empty() || seeds.of == only) chosen.push_back(seeds);
    }
    if (chosen.empty()) {
      std::cerr << "nothing is called " << only << "; there are:";
      for (const FuzzSeeds& seeds : all) std::cerr << ' ' << seeds.of;
      std::cerr << '\n';
      std::exit(2);
    }
    if (!only.empty()) {
      // The last one's: of a codec that builds on frames that is one which does.
      const std::vector<uint8_t>& last = chosen.front().inputs.back();
      prefix_.assign(last.begin(), last.begin() + static_cast<ptrdiff_t>(prefix_length));
    }
    if (!folder.empty()) write(folder, chosen);
  }
  /// What libFuzzer made, with the prefix. Valid until the next call.
  std::span<const uint8_t> input(const uint8_t* data, size_t size) {
    if (prefix_.empty()) return {data, size};
    whole_ = prefix_;
    whole_.insert(whole_.end(), data, data + size);
    return whole_;
  }

 private:
  static std::string option(int count, char** arguments, std::string_view name) {
    for (int i = 1; i < count; ++i) {
      const std::string_view argument = arguments[i];
      if (argument.starts_with(name)) return std::string(argument.substr(name.size()));
    }
    return {};
  }
  void write(const std::filesystem::path& folder, const std::vector<FuzzSeeds>& chosen) const {
    std::filesystem::create_directories(folder);
    for (const FuzzSeeds& seeds : chosen) {
      for (size_t i = 0; i < seeds.inputs.size(); ++i) {
        const std::vector<uint8_t>& input = seeds.inputs[i];
        const auto begin = static_cast<ptrdiff_t>(prefix_.size());
        std::ofstream file(folder / (seeds.of + "-" + std::to_string(i)), std::ios::binary);
        file.write(reinterpret_cast<const char*>(input.data()) + begin,
                   static_cast<std::streamsize>(input.size()) - begin);
      }
    }
  }

  std::vector<uint8_t> prefix_, whole_;
};

}  // namespace strandcast
