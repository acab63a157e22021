#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/table.h"

namespace strandcast {

/// The CSV files of one machine by base name: "scaling" for scaling.csv.
using Results = std::map<std::string, CsvFile>;
/// Reads all *.csv of a folder. Throws Error.
Results readResults(const std::filesystem::path& folder);

/// A key figure, its goal, and the command that measures it again.
struct Headline {
  std::string what, measured;
  std::string goal;           ///< may be empty
  std::optional<bool> holds;  ///< empty without a goal
  std::string command;
};
/// The key figures that `results` provide.
std::vector<Headline> headlinesOf(const Results& results);

/// The command in the first comment of a file.
std::string commandOf(const CsvFile& file);

}  // namespace strandcast
