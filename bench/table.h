#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace strandcast {

struct Column {
  std::string key;                ///< in CSV and JSON
  std::string heading = {};       ///< for people; empty = not shown to them
  std::string format = "{:.4g}";  ///< of numbers, for people
};

/// Measured rows, for people, as CSV and as JSON. A row is an object of strings and numbers by the columns'
/// keys; what does not apply to it is left out.
class Table {
 public:
  Table() = default;
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// A key that no column has is the program's own fault.
  void add(nlohmann::json row);
  const std::vector<Column>& columns() const { return columns_; }
  const std::vector<nlohmann::json>& rows() const { return rows_; }

  std::string text() const;
  std::string csv() const;
  nlohmann::json json() const;  ///< an array of objects; what does not apply is null

 private:
  std::vector<Column> columns_;
  std::vector<nlohmann::json> rows_;
};

/// `value` for people: numbers by `format`, whole ones as they are, "-" for what does not apply.
std::string shown(const nlohmann::json& value, const std::string& format);

/// How a verb prints what it measured.
struct PrintOptions {
  bool json = false, csv = false;
};

/// What one call of strandbench measured.
struct Bench {
  std::string name;
  nlohmann::json params = nlohmann::json::object();
  Table table;
  nlohmann::json more = nlohmann::json::object();  ///< further keys of the JSON object
  std::string heading = {};                        ///< lines above the table, for people
  std::string closing = {};                        ///< and below it
  std::vector<std::string> comments = {};          ///< further lines of comment of the CSV
};

/// Prints it on standard output: to people; as one JSON object with name, commit, machine, params, results
/// and `more`; or as CSV behind lines of comment: command(), commit and machine, and `comments`.
void print(const Bench& bench, const PrintOptions& options);

/// What every output states of itself: commit, machine, hardware_threads, instruction_set,
/// load_average and command; and
/// the same as lines of comment for a CSV.
nlohmann::json origin();
std::string originComment();

/// The command line of this program, as print() names it; set once by main().
void setCommand(int argc, const char* const* argv);
const std::string& command();

/// A CSV that print() or an earlier form of it wrote.
struct CsvFile {
  std::vector<std::string> comments;  ///< without their #
  std::vector<std::string> columns;
  std::vector<nlohmann::json> rows;  ///< objects of strings, of numbers where all of a cell is one
};
/// Throws Error, naming `where`, when a line has another number of cells than the first.
CsvFile parseCsv(const std::string& text, const std::string& where);

}  // namespace strandcast
