#include "scenes/part_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "core/error.h"

namespace strandcast {
namespace {

void apply(const MaterialRule& rule, Material& material) {
  for (const MaterialRule::Setting& setting : rule.settings)
    if (setting.name != kShearModulus) setMaterial(material, setting.name, setting.values, setting.where);
  // The shear modulus comes last: it needs the Young's modulus.
  for (const MaterialRule::Setting& setting : rule.settings)
    if (setting.name == kShearModulus) setMaterial(material, setting.name, setting.values, setting.where);
}

std::vector<size_t> partsOf(const MaterialRule& rule, const std::vector<std::string>& part_names) {
  std::vector<size_t> parts(rule.parts.empty() ? part_names.size() : 0);
  std::iota(parts.begin(), parts.end(), size_t{0});
  for (const std::string& part : rule.parts) parts.push_back(partOf(part, part_names, rule.where));
  return parts;
}

/// Name of the quantity that a setting determines: shear_modulus and poisson_ratio determine the same.
std::string subjectOf(const std::string& setting) {
  return setting == kShearModulus ? "poisson_ratio" : setting;
}

void refuseReplaced(const std::vector<MaterialRule>& rules, const std::vector<std::string>& part_names) {
  using Key = std::tuple<bool, std::string, size_t>;  // origin, subject, part
  std::map<Key, const MaterialRule::Setting*> later, later_of_all;
  for (auto rule = rules.rbegin(); rule != rules.rend(); ++rule) {
    const std::vector<size_t> parts = partsOf(*rule, part_names);
    const auto& replacing = rule->parts.empty() ? later_of_all : later;
    for (const MaterialRule::Setting& setting : rule->settings) {
      const MaterialRule::Setting* other = nullptr;
      bool is_void = !parts.empty();
      for (const size_t part : parts) {
        const auto known = replacing.find({rule->is_option, subjectOf(setting.name), part});
        const bool is_replaced = known != replacing.end() && (known->second->name != setting.name ||
                                                              known->second->values != setting.values);
        is_void = is_void && is_replaced;
        if (is_replaced) other = known->second;
      }
      if (is_void)
        throw Error(fmt::format("'{}' is set twice for the same hair, to different values", setting.name),
                    fmt::format("{} and {}", setting.where, other->where), "leave one of them out");
    }
    for (const MaterialRule::Setting& setting : rule->settings)
      for (const size_t part : parts) {
        const Key key{rule->is_option, subjectOf(setting.name), part};
        later.insert({key, &setting});
        if (rule->parts.empty()) later_of_all.insert({key, &setting});
      }
  }
}

}  // namespace

size_t partOf(const std::string& part, const std::vector<std::string>& names, const std::string& where) {
  std::string list, namesakes;
  size_t found = names.size(), count = 0;
  for (size_t i = 0; i < names.size(); ++i) {
    list += fmt::format("{}{} ({})", i > 0 ? ", " : "", names[i], i);
    if (names[i] != part) continue;
    found = i;
    namesakes += fmt::format("{}{}", count++ > 0 ? ", " : "", i);
  }
  if (count > 1)
    throw Error(fmt::format("{} parts of the groom are called '{}'", count, part), where,
                "choose by number: " + namesakes);
  for (size_t i = 0; i < names.size() && count == 0; ++i)
    if (part == std::to_string(i)) found = i;
  if (found < names.size()) return found;
  throw Error("the groom has no part '" + part + "'", where, "its parts are " + list);
}

void checkRule(const MaterialRule& rule) {
  const MaterialRule::Setting* shear = nullptr;
  bool ratio = false;
  for (const MaterialRule::Setting& setting : rule.settings) {
    Material any;
    if (setting.name == kShearModulus)
      shear = &setting;
    else
      setMaterial(any, setting.name, setting.values, setting.where);
    ratio = ratio || setting.name == "poisson_ratio";
    for (const MaterialRule::Setting& other : rule.settings)
      if (&other < &setting && other.name == setting.name && other.values != setting.values)
        throw Error(fmt::format("'{}' is set twice, to different values", setting.name), setting.where,
                    "leave one of them out");
  }
  if (shear != nullptr && ratio)
    throw Error("poisson_ratio and shear_modulus say the same twice", shear->where, "give one of them");
}

std::vector<Material> partMaterials(const std::vector<MaterialRule>& rules,
                                    const std::vector<std::string>& part_names) {
  std::vector<Material> materials(part_names.size());
  for (const MaterialRule& rule : rules) checkRule(rule);
  refuseReplaced(rules, part_names);
  for (const MaterialRule& rule : rules) {
    if (rule.parts.empty())
      for (Material& material : materials) apply(rule, material);
    for (const std::string& part : rule.parts) apply(rule, materials[partOf(part, part_names, rule.where)]);
  }
  for (size_t i = 0; i < materials.size(); ++i)
    checkMaterial(materials[i], fmt::format("material of part '{}'", part_names[i]));
  return materials;
}

float thickestRadius(const std::vector<Material>& materials) {
  float thickest = 0;
  for (const Material& material : materials)
    for (const auto& [place, factor] : material.radius_scale.knots)
      thickest = std::max(thickest, material.radius * factor);
  return thickest;
}

void pinParts(StrandModel& model, const std::vector<PinRule>& rules,
              const std::vector<std::string>& part_names, const std::vector<uint16_t>& strand_parts) {
  for (const PinRule& rule : rules) {
    std::vector<bool> chosen(part_names.size(), rule.parts.empty());
    for (const std::string& part : rule.parts) chosen[partOf(part, part_names, rule.where)] = true;
    try {
      const uint16_t bone = addBone(model, rule.bone);
      for (size_t s = 0; s < model.strands(); ++s)
        if (chosen[strand_parts.empty() ? 0 : strand_parts[s]]) pinToBone(model, s, rule.from, rule.to, bone);
    } catch (const Error& error) {
      throw Error(error.what(), rule.where, "");
    }
  }
}

}  // namespace strandcast
