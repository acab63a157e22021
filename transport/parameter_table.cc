#include "transport/parameter_table.h"

#include <algorithm>
#include <cmath>

namespace strandcast {
namespace {

bool isName(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte > 0x20 && byte != 0x7f;
  });
}

constexpr std::string_view kSpace = "%20", kPercent = "%25";

}  // namespace

std::vector<std::string_view> splitNames(std::string_view text) {
  std::vector<std::string_view> names;
  while (!text.empty()) {
    const size_t length = text.find(' ');
    names.push_back(text.substr(0, length));
    if (length == std::string_view::npos) break;
    text.remove_prefix(length + 1);
    if (text.empty()) names.emplace_back();
  }
  return names;
}

bool areDistinctNames(std::vector<std::string_view> names) {
  if (!std::all_of(names.begin(), names.end(), isName)) return false;
  std::sort(names.begin(), names.end());
  return std::adjacent_find(names.begin(), names.end()) == names.end();
}

std::string withoutSpaces(const std::string& name) {
  std::string out;
  for (const char c : name) {
    if (c == ' ')
      out += kSpace;
    else if (c == '%')
      out += kPercent;
    else
      out += c;
  }
  return out;
}

std::string withSpaces(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const bool is_space = text.starts_with(kSpace), is_coded = is_space || text.starts_with(kPercent);
    out += is_space ? ' ' : text[0];
    text.remove_prefix(is_coded ? kSpace.size() : 1);
  }
  return out;
}

bool appendEntry(ParameterTable& table, const std::string& kind, const std::string& name,
                 const std::vector<double>& values) {
  const std::string told = " " + kind + ":" + withoutSpaces(name);
  if (table.names.size() + told.size() > kMaxTableNameBytes || table.components.size() >= kMaxTableEntries ||
      table.values.size() + values.size() > kMaxTableValues)
    return false;
  table.names += told;
  table.components.push_back(static_cast<uint8_t>(values.size()));
  for (const double value : values) table.values.push_back(static_cast<float>(value));
  return true;
}

NamedValues entriesOf(const ParameterTable& table, const std::string& kind) {
  NamedValues out;
  for (auto& [name, values] : namedValues(table)) {
    const size_t colon = name.find(':');
    if (colon == std::string::npos ? !kind.empty() : name.substr(0, colon) != kind) continue;
    out.emplace_back(colon == std::string::npos ? name : withSpaces(std::string_view(name).substr(colon + 1)),
                     values);
  }
  return out;
}

ParameterTable parameterTable(const NamedValues& values) {
  ParameterTable table;
  for (const auto& [name, components] : values) {
    table.names += (table.names.empty() ? "" : " ") + name;
    table.components.push_back(static_cast<uint8_t>(components.size()));
    for (const double component : components) table.values.push_back(static_cast<float>(component));
  }
  return table;
}

ParameterTable parameterTable(const Parameters& parameters) {
  NamedValues values;
  for (const ParameterInfo& info : parameterList())
    values.emplace_back(info.name, parameter(parameters, info.name));
  return parameterTable(values);
}

bool isSound(const ParameterTable& table) {
  if (table.names.size() > kMaxTableNameBytes || table.components.size() > kMaxTableEntries ||
      table.values.size() > kMaxTableValues)
    return false;
  const std::vector<std::string_view> names = splitNames(table.names);
  if (names.size() != table.components.size() || !areDistinctNames(names)) return false;
  size_t values = 0;
  for (const uint8_t components : table.components) {
    if (components < 1 || components > kMaxTableComponents) return false;
    values += components;
  }
  return values == table.values.size() &&
         std::all_of(table.values.begin(), table.values.end(), [](float v) { return std::isfinite(v); });
}

NamedValues namedValues(const ParameterTable& table) {
  NamedValues all;
  auto value = table.values.begin();
  auto components = table.components.begin();
  for (const std::string_view name : splitNames(table.names)) {
    const auto end = value + *components++;
    all.emplace_back(name, std::vector<double>(value, end));
    value = end;
  }
  return all;
}

}  // namespace strandcast
