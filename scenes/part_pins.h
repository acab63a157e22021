#pragma once
#include <string>
#include <vector>

#include "core/strand_model.h"

namespace strandcast {

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
