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

/// Options of a fuzzer. `--only=NAME` restricts it to the seeds of that name; their first bytes, which select
/// the type of input, are then prepended to every input. `--seeds=FOLDER` writes the seeds there, as
/// libFuzzer's initial corpus.
class FuzzedPart {
 public:
  /// `prefix_length`: number of first bytes. Ends the program on an unknown name.
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
      // Of the last seed, because a codec that builds on other frames does so in the last one.
      const std::vector<uint8_t>& last = chosen.front().inputs.back();
      prefix_.assign(last.begin(), last.begin() + static_cast<ptrdiff_t>(prefix_length));
    }
    if (!folder.empty()) write(folder, chosen);
  }
  /// libFuzzer's input after the prefix. Valid until the next call.
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
