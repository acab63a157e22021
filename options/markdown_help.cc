// The tables of docs/reference.md: the options of a program as CLI11 knows them, and what their help lists.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <set>

#include "core/material.h"
#include "options/console.h"
#include "options/settings.h"
#include "scenes/scene.h"

namespace strandcast {
namespace {

constexpr const char* kDaemonProgram = "strandcastd";

std::string code(const std::string& text) { return text.empty() ? "" : "`" + text + "`"; }

/// Rows of one table of a page.
class MarkdownTable {
 public:
  explicit MarkdownTable(std::vector<std::string> heads) : heads_(std::move(heads)) {}
  /// `cells`: one per column.
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// The table without columns that are empty in all rows; empty without rows.
  std::string text() const;

 private:
  std::vector<std::string> heads_;
  std::vector<std::vector<std::string>> rows_;
};

std::string MarkdownTable::text() const {
  if (rows_.empty()) return {};
  std::string head = "|", rule = "|";
  std::vector<std::string> lines(rows_.size(), "|");
  for (size_t column = 0; column < heads_.size(); ++column) {
    const auto is_empty = [&](const std::vector<std::string>& row) { return row[column].empty(); };
    if (std::all_of(rows_.begin(), rows_.end(), is_empty)) continue;
    head += ' ' + heads_[column] + " |";
    rule += "---|";
    for (size_t row = 0; row < rows_.size(); ++row)
      lines[row] += ' ' + CLI::detail::find_and_replace(rows_[row][column], "|", "\\|") + " |";
  }
  return fmt::format("{}\n{}\n{}\n\n", head, rule, fmt::join(lines, "\n"));
}

/// An option as a row of a table.
struct OptionRow {
  std::string group, option, key, value, standard, meaning;
  bool positional = false;

  /// Equal for options that differ in nothing but their program.
  std::string identity() const { return fmt::format("{}\n{}\n{}\n{}", option, value, standard, meaning); }
};

/// The first line of `help`, with a link to the table that the page has for the list below it.
std::string withTable(const std::string& help, const std::string& title, const std::string& anchor) {
  return help.substr(0, help.find('\n')) + fmt::format(" [{}](#{})", title, anchor);
}

/// `help` in a table's cell. Indented lines of it are a list, "  NAME: MEANING" or "  NAME    MEANING".
std::string cellOf(const std::string& help) {
  std::string cell;
  for (const std::string& line : CLI::detail::split(help, '\n')) {
    if (!cell.empty()) cell += "<br>";
    const size_t end = std::min(line.find("  ", 2), line.find(": "));
    const bool is_item = line.starts_with("  ") && end != std::string::npos;
    cell += is_item ? code(line.substr(2, end - 2)) + (line[end] == ':' ? "" : ": ") +
                          line.substr(line[end] == ':' ? end : line.find_first_not_of(' ', end))
                    : line;
  }
  return cell;
}

/// What CLI11 writes behind an option in --help, e.g. "FLOAT:1 to 1000", in words.
std::string valueOf(const CLI::Option& option) {
  static const std::map<std::string, std::string> kWords{
      {"TEXT", "text"},     {"INT", "whole number"}, {"NAME", "name"}, {"UINT", "whole number"},
      {"NUMBER", "number"}, {"FLOAT", "number"},     {"FILE", "file"}};
  if (option.get_type_size() == 0) return {};
  const std::string full = option.get_type_name(), own = option.get_option_text();
  const size_t colon = full.find(':');
  const std::string type = full.substr(0, colon), range = colon < full.size() ? full.substr(colon + 1) : "";
  const auto word = kWords.find(type);
  const int least = option.get_expected_min(), most = option.get_expected_max();
  const bool is_choice = range.starts_with('{'), is_list = most >= CLI::detail::expected_max_vector_size;
  std::string text = word == kWords.end() ? type : word->second;
  if (!is_list && most > 1)
    text = (least == most ? "" : fmt::format("{} to ", least)) + fmt::format("{} {}s", most, text);
  else if (is_list && !is_choice)
    text += ", one or more";
  if (is_choice)
    text = fmt::format("{}`{}`", is_list ? "some of " : "",
                       CLI::detail::find_and_replace(range.substr(1, range.size() - 2), ",", "`, `"));
  else if (!range.empty())
    text += ", " + range;
  if (!own.empty()) text = own.substr(0, own.find(" REQUIRED"));
  return text + (option.get_required() ? "; required" : "");
}

/// "; needs `--a`" for options that `option` needs or excludes.
std::string conditionsOf(const char* what, const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* other : options) names.push_back(code(other->get_name()));
  std::sort(names.begin(), names.end());  // the set is in the order of addresses
  return names.empty() ? "" : fmt::format("; {} {}", what, fmt::join(names, ", "));
}

OptionRow rowOf(const CLI::App& app, const CLI::Option& option, const std::string& group) {
  OptionRow row;
  row.group = group;
  row.positional = option.get_positional();
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back(code("-" + name));
  for (const std::string& name : option.get_lnames()) names.push_back(code("--" + name));
  row.option =
      row.positional ? code(option.get_name(true, false)) : fmt::format("{}", fmt::join(names, ", "));
  const bool has_keys = app.get_option_no_throw("--config") != nullptr;
  if (has_keys) row.key = code(configKeyOf(option.get_name()));
  row.value = valueOf(option);
  row.standard = code(option.get_default_str());
  std::string help = option.get_description();
  if (const size_t end = help.find("] "); help.starts_with('[') && end != std::string::npos) {
    row.value += ' ' + help.substr(1, end - 1);  // the unit of a picture's setting
    help.erase(0, end + 2);
  }
  if (has_keys && option.get_name() == "--set") {
    row.key = "`[parameters]`";
    help = withTable(help, "Parameters", "parameters");
  } else if (has_keys && option.get_name() == "--material") {
    row.key = "`[[material]]`";
    help = withTable(help, "Materials", "materials");
  }
  row.meaning = cellOf(help) + conditionsOf("needs", option.get_needs()) +
                conditionsOf("not with", option.get_excludes());
  return row;
}

/// The options of `app` and its option groups in the order of --help, without those that print help.
std::vector<OptionRow> rowsOf(const CLI::App& app) {
  std::vector<OptionRow> rows;
  const auto add = [&](const CLI::App& of, const std::string& group, const std::string& title) {
    for (const CLI::Option* option : of.get_options())
      if (option->get_group() == group && option != of.get_help_ptr() && option != of.get_help_all_ptr() &&
          !group.empty())
        rows.push_back(rowOf(app, *option, title));
  };
  for (const std::string& group : app.get_groups())
    add(app, group, group == "Options" ? "" : "**" + group + "**");
  for (const CLI::App* group :
       app.get_subcommands([](const CLI::App* sub) { return sub->get_name().empty(); }))
    for (const std::string& own : group->get_groups())
      add(*group, own, fmt::format("**{}**: {}", group->get_group(), group->get_description()));
  return rows;
}

std::vector<const CLI::App*> verbsOf(const CLI::App& app) {
  return app.get_subcommands(
      [](const CLI::App* sub) { return !sub->get_name().empty() && !sub->get_group().empty(); });
}

std::string numbersText(const std::vector<double>& values) {
  return fmt::format("{:g}", fmt::join(values, " "));
}

/// The value of a parameter with groom files, and those of procedural scenes that differ.
std::string standardOf(const std::string& name) {
  SceneOptions files;
  files.groom = {"groom.tfx"};
  const std::string of_files = numbersText(parameter(sceneParameters(files), name));
  std::string text = code(of_files);
  for (const SceneInfo& scene : sceneList()) {
    SceneOptions procedural;
    procedural.name = scene.name;
    const std::string own = numbersText(parameter(sceneParameters(procedural), name));
    if (own != of_files) text += fmt::format("; {} `{}`", scene.name, own);
  }
  return text;
}

std::string parametersText() {
  MarkdownTable table({"parameter", "range", "unit", "default", "meaning"});
  for (const ParameterInfo& info : parameterList()) {
    const std::string condition = conditionOf(info.name);
    table.add({code(info.name), (info.components > 1 ? "3 numbers, " : "") + info.range, info.unit,
               standardOf(info.name), info.help + (condition.empty() ? "" : "; " + condition)});
  }
  return "### Parameters\n\n"
         "Of `--set NAME=VALUE`, and of the table `[parameters]` of a configuration file. `strandcast ctl "
         "set NAME\n"
         "VALUE` changes any of them while a daemon runs: none needs a restart. The default is that of groom "
         "files;\n"
         "procedural scenes with another are named beside it.\n\n" +
         table.text();
}

std::string materialsText() {
  MarkdownTable table({"setting", "range", "unit", "meaning"});
  for (const MaterialSettingInfo& info : materialSettingList())
    table.add({code(info.name), (info.curve ? "curve, " : "") + info.range, info.unit, info.help});
  return "### Materials\n\n"
         "Of `--material PART:NAME=VALUE`, and of tables `[[material]]` of a configuration file. A change "
         "needs a\n"
         "restart.\n\n" +
         table.text();
}

/// Writes a program and its verbs, each a section. Options that an earlier section has are only named.
class MarkdownWriter {
 public:
  /// Takes the options of `app` as written in the section `path`.
  void know(const CLI::App& app, const std::string& path) {
    for (const OptionRow& row : rowsOf(app)) known_.emplace(row.identity(), path);
  }
  void write(const CLI::App& app, const std::string& path);
  const std::string& text() const { return text_; }

 private:
  /// The section that describes this option and at least three others of the same program; else empty.
  std::string elsewhere(const OptionRow& row, const std::map<std::string, int>& counts) const {
    const auto known = known_.find(row.identity());
    constexpr int kFew = 4;
    return known == known_.end() || counts.at(known->second) < kFew ? "" : known->second;
  }
  /// Returns the names of the options that were written, not only named.
  std::vector<std::string> writeOptions(const CLI::App& app);
  void writeVerbs(const CLI::App& app, const std::string& path);

  std::map<std::string, std::string> known_;  ///< sections by OptionRow::identity()
  std::string text_;
};

std::vector<std::string> MarkdownWriter::writeOptions(const CLI::App& app) {
  const std::vector<OptionRow> rows = rowsOf(app);
  std::map<std::string, int> counts;
  for (const OptionRow& row : rows)
    if (const auto known = known_.find(row.identity()); known != known_.end()) ++counts[known->second];
  std::vector<std::string> written;
  std::map<std::string, std::string> named;
  for (const bool positional : {true, false}) {
    for (size_t first = 0, end = 0; first < rows.size(); first = end) {
      MarkdownTable table({positional ? "argument" : "option", "key", "value", "default", "meaning"});
      for (end = first; end < rows.size() && rows[end].group == rows[first].group; ++end) {
        const OptionRow& row = rows[end];
        if (row.positional != positional) continue;
        if (const std::string section = elsewhere(row, counts); !section.empty()) {
          named[section] += (named[section].empty() ? "" : ", ") + row.option;
          continue;
        }
        table.add({row.option, row.key, row.value, row.standard, row.meaning});
        written.push_back(row.option);
      }
      const std::string text = table.text();
      if (!text.empty() && !rows[first].group.empty() && !positional) text_ += rows[first].group + "\n\n";
      text_ += text;
    }
  }
  MarkdownTable shared({"described in", "further options"});
  for (const auto& [section, options] : named)
    shared.add(
        {fmt::format("[{}](#{})", section, CLI::detail::find_and_replace(section, " ", "-")), options});
  text_ += shared.text();
  return written;
}

void MarkdownWriter::writeVerbs(const CLI::App& app, const std::string& path) {
  MarkdownTable table({"verb", "meaning"});
  for (const CLI::App* verb : verbsOf(app)) table.add({code(verb->get_name()), verb->get_description()});
  text_ += table.text();
  for (const CLI::App* verb : verbsOf(app))
    if (!rowsOf(*verb).empty() || !verbsOf(*verb).empty()) write(*verb, path + ' ' + verb->get_name());
}

void MarkdownWriter::write(const CLI::App& app, const std::string& path) {
  const std::string about = app.get_description();
  text_ += fmt::format("### {}\n\n{}\n\n", path, about.substr(0, about.find("\n\n")));
  const std::vector<std::string> written = writeOptions(app);
  know(app, path);
  const auto has = [&](const char* option) {
    return std::find(written.begin(), written.end(), code(option)) != written.end();
  };
  if (has("--set")) text_ += parametersText();
  if (has("--material")) text_ += materialsText();
  writeVerbs(app, path);
}

}  // namespace

std::string markdownHelp(const CLI::App& app, const std::string& program) {
  MarkdownWriter writer;
  CLI::App daemon;
  const SettingsOptions options(daemon, SettingsUse::kServe);
  if (program != kDaemonProgram) writer.know(daemon, kDaemonProgram);
  writer.write(app, program);
  return writer.text();
}

}  // namespace strandcast
