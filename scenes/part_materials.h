#pragma once
#include <string>
#include <vector>

#include "core/material.h"

namespace strandcast {

/// What one [[material]] table or --material option says.
struct MaterialRule {
  struct Setting {
    std::string name;            ///< of materialSettingList()
    std::vector<double> values;  ///< see setMaterial()
    std::string where;           ///< for errors: file and line, or option
  };
  std::vector<std::string> parts;  ///< names or numbers of parts; empty = all
  std::vector<Setting> settings;
  std::string where;       ///< of `parts`
  bool is_option = false;  ///< else of a file, to which options come on top
};

/// The number of a part given by name or, where none is called so, by number. Throws Error, naming `where`
/// and the parts there are, and where several are called so.
size_t partOf(const std::string& part, const std::vector<std::string>& names, const std::string& where);

/// Throws Error on a setting that no material could take, whatever the groom is, and on one that is there
/// twice.
void checkRule(const MaterialRule& rule);

/// The material of every part: human hair, changed by the rules in their order. A shear modulus holds with
/// the Young's modulus of its rule, or with the one before it. Throws Error on an unknown part (naming those
/// there are), on both poisson_ratio and shear_modulus in one rule, and as setMaterial.
std::vector<Material> partMaterials(const std::vector<MaterialRule>& rules,
                                    const std::vector<std::string>& part_names);

/// m, of the thickest place of all these.
float thickestRadius(const std::vector<Material>& materials);

}  // namespace strandcast
