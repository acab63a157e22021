#include "scenes/part_materials.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace strandcast {
namespace {

void apply(const MaterialRule& rule, Material& material) {
  for (const MaterialRule::Setting& setting : rule.settings)
    if (setting.name != kShearModulus) setMaterial(material, setting.name, setting.values, setting.where);
  for (const MaterialRule::Setting& setting : rule.settings)  // it needs the Young's modulus
    if (setting.name == kShearModulus) setMaterial(material, setting.name, setting.values, setting.where);
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
  }
  if (shear != nullptr && ratio)
    throw Error("poisson_ratio and shear_modulus say the same twice", shear->where, "give one of them");
}

std::vector<Material> partMaterials(const std::vector<MaterialRule>& rules,
                                    const std::vector<std::string>& part_names) {
  std::vector<Material> materials(part_names.size());
  for (const MaterialRule& rule : rules) {
    checkRule(rule);
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

}  // namespace strandcast
