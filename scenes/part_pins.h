#pragma once
#include <string>
#include <vector>

#include "core/strand_model.h"

namespace strandcast {

/// What one [[pin]] table says: which stretch of the strands of some parts moves with a bone.
struct PinRule {
  std::vector<std::string> parts;  ///< names or numbers of parts; empty = all
  std::string bone = "head";
  float from = 0, to = 1;  ///< parts of the arc length, root 0 to tip 1
  std::string where;       ///< for errors: file and line
};

/// Pins strands by the rules in their order (pinToBone). `strand_parts` as StrandSet::parts. Throws Error on
/// an unknown part and as pinToBone.
void pinParts(StrandModel& model, const std::vector<PinRule>& rules,
              const std::vector<std::string>& part_names, const std::vector<uint16_t>& strand_parts);

}  // namespace strandcast
