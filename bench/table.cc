#include "bench/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <fstream>
#include <iterator>
#include <sstream>

#include "bench/machine.h"
#include "core/error.h"

namespace strandcast {

std::string textOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void writeText(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw Error("the file cannot be written", file.string(), "check the folder and the disk");
}

namespace {

std::string& commandLine() {
  static std::string line = "strandbench";
  return line;
}

std::string csvCell(const nlohmann::json& value) {
  if (value.is_null()) return "";
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  if (!value.is_string()) return value.dump();
  const std::string text = value.get<std::string>();
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  quoted += '"';
  return quoted;
}

nlohmann::json numberOrText(const std::string& cell) {
  if (cell.empty()) return nullptr;
  const char* end = cell.data() + cell.size();
  int64_t whole = 0;
  if (const auto [at, error] = std::from_chars(cell.data(), end, whole); error == std::errc() && at == end)
    return whole;
  double number = 0;
  if (const auto [at, error] = std::from_chars(cell.data(), end, number); error == std::errc() && at == end)
    return number;
  return cell;
}

std::vector<std::string> csvCells(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      cells.back() += line[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

}  // namespace

void Table::add(nlohmann::json row) {
  assert(std::all_of(row.items().begin(), row.items().end(), [&](const auto& item) {
    return std::any_of(columns_.begin(), columns_.end(),
                       [&](const Column& c) { return c.key == item.key(); });
  }));
  rows_.push_back(std::move(row));
}

std::string shown(const nlohmann::json& value, const std::string& format) {
  if (value.is_null()) return "-";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format(fmt::runtime(format), value.get<double>());
  return value.dump();
}

std::string Table::text() const {
  std::string out;
  std::vector<std::vector<std::string>> cells(rows_.size() + 1);
  std::vector<bool> left;
  for (const Column& column : columns_) {
    if (column.heading.empty()) continue;
    cells[0].push_back(column.heading);
    left.push_back(std::any_of(rows_.begin(), rows_.end(), [&](const nlohmann::json& row) {
      return row.contains(column.key) && row[column.key].is_string();
    }));
    for (size_t r = 0; r < rows_.size(); ++r)
      cells[r + 1].push_back(shown(rows_[r].value(column.key, nlohmann::json()), column.format));
  }
  std::vector<size_t> widths(left.size());
  for (const auto& row : cells)
    for (size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  for (const auto& row : cells) {
    std::string line = " ";
    for (size_t c = 0; c < row.size(); ++c)
      line += left[c] ? fmt::format(" {:<{}}", row[c], widths[c]) : fmt::format(" {:>{}}", row[c], widths[c]);
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

std::string Table::csv() const {
  std::vector<std::string> cells;
  for (const Column& column : columns_) cells.push_back(column.key);
  std::string out = fmt::format("{}\n", fmt::join(cells, ","));
  for (const nlohmann::json& row : rows_) {
    cells.clear();
    for (const Column& column : columns_) cells.push_back(csvCell(row.value(column.key, nlohmann::json())));
    out += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return out;
}

nlohmann::json Table::json() const {
  nlohmann::json list = nlohmann::json::array();
  for (const nlohmann::json& row : rows_) {
    nlohmann::json object;
    for (const Column& column : columns_) object[column.key] = row.value(column.key, nlohmann::json());
    list.push_back(std::move(object));
  }
  return list;
}

nlohmann::json origin() {
  const Machine machine = thisMachine();
  return {{"commit", buildCommit()},           {"machine", machine.cpu},
          {"hardware_threads", machine.cores}, {"instruction_set", machine.instruction_set},
          {"load_average", loadAverage()},     {"command", command()}};
}

std::string originComment() {
  return fmt::format("# {}\n# commit {}; {}; load average {:.1f}\n", command(), buildCommit(),
                     describe(thisMachine()), loadAverage());
}

void print(const Bench& bench, const PrintOptions& options) {
  if (options.json) {
    nlohmann::json out = origin();
    out.update({{"name", bench.name}, {"params", bench.params}, {"results", bench.table.json()}});
    out.update(bench.more);
    fmt::print("{}\n", out.dump());
  } else if (options.csv) {
    fmt::print("{}", originComment());
    for (const std::string& comment : bench.comments) fmt::print("# {}\n", comment);
    fmt::print("{}", bench.table.csv());
  } else {
    fmt::print("{}{}{}", bench.heading, bench.table.text(), bench.closing);
  }
  std::fflush(stdout);
}

void setCommand(int argc, const char* const* argv) {
  commandLine() = "strandbench";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    commandLine() +=
        word.find(' ') == std::string::npos ? fmt::format(" {}", word) : fmt::format(" '{}'", word);
  }
}

const std::string& command() { return commandLine(); }

CsvFile parseCsv(const std::string& text, const std::string& where) {
  CsvFile out;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.empty()) continue;
    if (line[0] == '#') {
      out.comments.push_back(line.substr(std::min(line.size(), size_t{2})));
      continue;
    }
    const std::vector<std::string> cells = csvCells(line);
    if (out.columns.empty()) {
      out.columns = cells;
      continue;
    }
    if (cells.size() != out.columns.size())
      throw Error(fmt::format("a row has {} cells, but the header names {} columns", cells.size(),
                              out.columns.size()),
                  fmt::format("{}:{}", where, number), "write the file again with strandbench --csv");
    nlohmann::json row;
    for (size_t c = 0; c < cells.size(); ++c)
      row[out.columns[c]] =
          out.columns[c].ends_with("hash") ? nlohmann::json(cells[c]) : numberOrText(cells[c]);
    out.rows.push_back(std::move(row));
  }
  return out;
}

}  // namespace strandcast
