#include "scenes/part_pins.h"

#include "core/error.h"
#include "scenes/part_materials.h"

namespace strandcast {

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
