// Rules for the parts of a groom: materials, and pins to bones.
#pragma once
#include <string>
#include <vector>

#include "core/material.h"
#include "core/strand_model.h"

namespace strandcast {

/// One [[material]] table or --material option.
struct MaterialRule {
  struct Setting {
    std::string name;            ///< one of materialSettingList()
    std::vector<double> values;  ///< see setMaterial()
    std::string where;           ///< for errors: file and line, or option
  };
  std::vector<std::string> parts;  ///< names or numbers of parts; empty: all
  std::vector<Setting> settings;
  std::string where;       ///< for errors on `parts`
  bool is_option = false;  ///< an option, which overrides those of files
};

/// Index of a part given by name, or by number if no part has that name. Throws Error, which names `where`
/// and the parts that exist, if there is no such part or if several have that name.
size_t partOf(const std::string& part, const std::vector<std::string>& names, const std::string& where);

/// Throws Error on a setting that is invalid for any material, whatever the groom is, and on a setting that
/// occurs twice.
void checkRule(const MaterialRule& rule);

/// Materials of all parts: human hair, modified by the rules in their order. A shear modulus is combined with
/// the Young's modulus of its rule, else with the one set before. Throws Error on an unknown part (naming
/// those that exist), on both poisson_ratio and shear_modulus in one rule, and as setMaterial.
std::vector<Material> partMaterials(const std::vector<MaterialRule>& rules,
                                    const std::vector<std::string>& part_names);

/// Largest radius along the hair of all these materials, m.
float thickestRadius(const std::vector<Material>& materials);

/// One [[pin]] table: the stretch of the strands of some parts that moves with a bone.
struct PinRule {
  std::vector<std::string> parts;  ///< names or numbers of parts; empty: all
  std::string bone = "head";
  float from = 0, to = 1;  ///< fraction of the arc length, root 0 to tip 1
  std::string where;       ///< for errors: file and line
};

/// Pins strands by the rules in their order (pinToBone). `strand_parts`: as StrandSet::parts. Throws Error on
/// an unknown part and as pinToBone.
void pinParts(StrandModel& model, const std::vector<PinRule>& rules,
              const std::vector<std::string>& part_names, const std::vector<uint16_t>& strand_parts);

}  // namespace strandcast
