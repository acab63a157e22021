#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/table.h"

namespace strandcast {

/// The CSVs of one machine by the name of their files: "scaling" of scaling.csv.
using Results = std::map<std::string, CsvFile>;
/// All *.csv of a folder. Throws Error.
Results readResults(const std::filesystem::path& folder);

/// A number that matters, what it should be, and how to measure it again.
struct Headline {
  std::string what, measured;
  std::string goal;           ///< may be empty
  std::optional<bool> holds;  ///< nothing where there is no goal
  std::string command;
};
/// Of what `results` have.
std::vector<Headline> headlinesOf(const Results& results);

/// The command of a file's first comment.
std::string commandOf(const CsvFile& file);

}  // namespace strandcast
