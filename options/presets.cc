#include "options/presets.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <span>

#include "core/error.h"
#include "io/file_bytes.h"
#include "options/settings.h"
#include "options/toml.h"

namespace strandcast {
namespace {

/// The shortest text that reads back as the same float; whole numbers exactly.
std::string numberText(double value) {
  const bool whole = value == std::floor(value) && std::fabs(value) <= 1e15;
  return whole ? fmt::format("{:.0f}", value) : fmt::format("{:.9g}", value);
}

std::string numbersText(const std::vector<double>& values) {
  if (values.size() == 1) return numberText(values[0]);
  std::vector<std::string> texts;
  for (const double v : values) texts.push_back(numberText(v));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

/// A quoted TOML string with escapes.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out + '"';
}

std::string valueText(const PictureSetting& setting, const PictureOptions& picture) {
  if (setting.file != nullptr) return quoted((picture.*setting.file).string());
  const std::vector<double> values = setting.get(picture);
  return setting.choices.empty() ? numbersText(values)
                                 : quoted(setting.choices[static_cast<size_t>(values[0])]);
}

std::vector<double> numbersOf(const toml::node& node, const std::string& where) {
  std::vector<double> values;
  const auto add = [&](const toml::node& one) {
    const std::optional<double> value = one.value<double>();
    if (!value) throw Error("not a number", where, "give a number, or three in brackets");
    values.push_back(*value);
  };
  if (const toml::array* array = node.as_array())
    for (const toml::node& one : *array) add(one);
  else
    add(node);
  return values;
}

std::string textOf(const toml::node& node, const std::string& where) {
  const std::optional<std::string> text = node.value_exact<std::string>();
  if (!text) throw Error("not a text", where, "give a text in quotes");
  return *text;
}

std::vector<RenderPass> passesOf(const toml::node& node, const std::string& where) {
  const toml::array* array = node.as_array();
  if (array == nullptr) throw Error("not a list", where, "give names of passes in brackets");
  std::vector<RenderPass> passes;
  for (const toml::node& one : *array) {
    const std::string name = textOf(one, where);
    const std::vector<RenderPass> all = allPasses();
    const auto known =
        std::find_if(all.begin(), all.end(), [&](RenderPass pass) { return nameOf(pass) == name; });
    if (known == all.end()) throw Error("unknown pass '" + name + "'", where, "");
    passes.push_back(*known);
  }
  return passes;
}

/// The setting's key in the table of a light.
std::string lightKey(const PictureSetting& setting) {
  return setting.info.name == "light" ? "kind" : setting.info.name.substr(std::string("light-").size());
}

void readSetting(const PictureSetting& setting, const toml::node& node, const std::string& where,
                 PictureOptions& picture) {
  if (setting.file != nullptr)
    picture.*setting.file = textOf(node, where);
  else if (setting.choices.empty())
    setPicture(picture, setting, numbersOf(node, where), where);
  else
    setPicture(picture, setting, choiceNamed(setting, textOf(node, where), where), where);
}

std::string placeOf(const toml::node& node, const std::string& file) {
  return fmt::format("{} line {}", file, node.source().begin.line);
}

void readPicture(const toml::table& table, const std::string& file, bool has_lights,
                 PictureOptions& picture) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const std::string where = fmt::format("{}, picture.{}", placeOf(node, file), name);
    if (name == "passes") {
      picture.settings.passes = passesOf(node, where);
      continue;
    }
    const PictureSetting& setting = pictureSetting(name, where);
    if (setting.of_light) {
      if (has_lights) throw Error("lights are given twice", where, "give them in [[light]] tables only");
      picture.settings.lights.resize(1);
      picture.light = 0;
    }
    readSetting(setting, node, where, picture);
  }
}

void readLights(const toml::node& node, const std::string& file, PictureOptions& picture) {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->empty() || !array->is_homogeneous(toml::node_type::table))
    throw Error("'light' is not a list of lights", placeOf(node, file), "give a table [[light]] for each");
  picture.settings.lights.clear();
  for (const toml::node& one : *array) {
    addLight(picture, placeOf(one, file));
    for (const auto& [key, value] : *one.as_table()) {
      const std::string name(key.str());
      const std::string where = fmt::format("{}, light.{}", placeOf(value, file), name);
      readSetting(pictureSetting(name == "kind" ? "light" : "light-" + name, where), value, where, picture);
    }
  }
  picture.light = 0;
}

}  // namespace

std::string presetText(const NamedValues& parameters, const PictureOptions& picture) {
  std::string text;
  if (!parameters.empty()) {
    text += "[parameters]\n";
    for (const auto& [name, values] : parameters) text += fmt::format("{} = {}\n", name, numbersText(values));
    text += '\n';
  }
  text += "[picture]\n";
  for (const PictureSetting& setting : pictureSettings())
    if (!setting.of_light) text += fmt::format("{} = {}\n", setting.info.name, valueText(setting, picture));
  std::vector<std::string> passes;
  for (const RenderPass pass : picture.settings.passes) passes.push_back(quoted(nameOf(pass)));
  text += fmt::format("passes = [{}]\n", fmt::join(passes, ", "));
  PictureOptions each = picture;
  for (each.light = 0; each.light < picture.settings.lights.size(); ++each.light) {
    text += "\n[[light]]\n";
    for (const PictureSetting& setting : pictureSettings())
      if (setting.of_light) text += fmt::format("{} = {}\n", lightKey(setting), valueText(setting, each));
  }
  return text;
}

NamedValues readPresetText(const std::string& text, const std::string& name, PictureOptions& picture) {
  const toml::table root = parsedToml(text, name);
  PictureOptions read = picture;
  NamedValues parameters;
  Parameters checked;
  for (const auto& [key, node] : root) {
    const std::string section(key.str());
    if (section == "light") {
      readLights(node, name, read);
      continue;
    }
    const toml::table* table = node.as_table();
    if (table == nullptr || (section != "parameters" && section != "picture"))
      throw Error("'" + section + "' is not known", placeOf(node, name),
                  "a preset has the tables [parameters], [picture] and [[light]]");
    if (section == "picture") {
      readPicture(*table, name, root.contains("light"), read);
      continue;
    }
    for (const auto& [parameter, value] : *table) {
      const std::string where = fmt::format("{} line {}, parameters.{}", name, value.source().begin.line,
                                            std::string(parameter.str()));
      parameters.emplace_back(parameter.str(), numbersOf(value, where));
      setParameter(checked, parameters.back().first, parameters.back().second, where);
    }
  }
  picture = std::move(read);
  return parameters;
}

void writePreset(const std::filesystem::path& file, const NamedValues& parameters,
                 const PictureOptions& picture) {
  const std::string text = presetText(parameters, picture);
  writeFileBytes(file, std::as_bytes(std::span(text)));
}

NamedValues readPreset(const std::filesystem::path& file, PictureOptions& picture) {
  return readPresetText(configText(file), file.string(), picture);
}

}  // namespace strandcast
