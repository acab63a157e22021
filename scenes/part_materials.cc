#include "scenes/part_materials.h"

#include <fmt/format.h>

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
  std::string list;
  for (size_t i = 0; i < names.size(); ++i) {
    if (part == names[i] || part == std::to_string(i)) return i;
    list += fmt::format("{}{} ({})", i > 0 ? ", " : "", names[i], i);
  }
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

}  // namespace strandcast
