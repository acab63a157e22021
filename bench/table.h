#pragma once
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace strandcast {

/// The content of a file; empty where there is no such file.
std::string textOf(const std::filesystem::path& file);
/// Writes a file. Throws Error.
void writeText(const std::filesystem::path& file, const std::string& text);

/// A column of a table.
struct Column {
  std::string key;                ///< in CSV and JSON
  std::string heading = {};       ///< in the printed table; empty = not printed
  std::string format = "{:.4g}";  ///< of numbers in the printed table
};

/// Measured rows, printed as a table, as CSV or as JSON. A row is an object of strings and numbers by the
/// columns' keys; cells that do not apply are omitted.
class Table {
 public:
  Table() = default;
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// An unknown key is a programming error.
  void add(nlohmann::json row);
  const std::vector<Column>& columns() const { return columns_; }
  const std::vector<nlohmann::json>& rows() const { return rows_; }

  std::string text() const;
  std::string csv() const;
  nlohmann::json json() const;  ///< an array of objects; cells that do not apply are null

 private:
  std::vector<Column> columns_;
  std::vector<nlohmann::json> rows_;
};

/// Formats `value` for the printed table: numbers by `format`, whole numbers unchanged, "-" for null.
std::string shown(const nlohmann::json& value, const std::string& format);

/// The output format of a verb.
struct PrintOptions {
  bool json = false, csv = false;
};

/// The results of one invocation of strandbench.
struct Bench {
  std::string name;
  nlohmann::json params = nlohmann::json::object();
  Table table;
  nlohmann::json more = nlohmann::json::object();  ///< additional keys of the JSON object
  std::string heading = {};                        ///< lines above the printed table
  std::string closing = {};                        ///< lines below the printed table
  std::vector<std::string> comments = {};          ///< additional comment lines of the CSV
};

/// Prints on standard output. A table; or one JSON object with name, commit, machine, params, results and
/// `more`; or CSV after comment lines with command, commit, machine and `comments`.
void print(const Bench& bench, const PrintOptions& options);

/// The provenance in every output: commit, machine, hardware_threads, instruction_set, load_average and
/// command. originComment() has the same as comment lines of a CSV.
nlohmann::json origin();
std::string originComment();

/// The command line of this program for print(); set once by main().
void setCommand(int argc, const char* const* argv);
const std::string& command();

/// A CSV written by print(), of this or an earlier version.
struct CsvFile {
  std::vector<std::string> comments;  ///< without the leading #
  std::vector<std::string> columns;
  std::vector<nlohmann::json> rows;  ///< objects of strings, or of numbers where the whole cell is one
};
/// Throws Error, naming `where`, where a line has a different number of cells than the first.
CsvFile parseCsv(const std::string& text, const std::string& where);

}  // namespace strandcast
