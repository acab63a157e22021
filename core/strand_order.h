#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/strand_model.h"

namespace strandcast {

/// Strands sorted by vertex count and by where their roots are, and cut into neighbourhoods: up to
/// kNeighbours strands of equal count, side by side on the head. Whatever looks at several strands at once
/// takes them in this order, so that each neighbourhood is one or more of the blocks of any CPU backend.
struct StrandOrder {
  std::vector<uint32_t> strands;           ///< in this order
  std::vector<uint32_t> offsets{0};        ///< neighbourhoods + 1, into `strands`
  std::vector<uint32_t> neighbourhood_of;  ///< per strand, natural order

  size_t neighbourhoods() const { return offsets.size() - 1; }
  std::span<const uint32_t> strandsOf(size_t neighbourhood) const {
    return {strands.data() + offsets[neighbourhood], offsets[neighbourhood + 1] - offsets[neighbourhood]};
  }
};

/// A multiple of every number of lanes.
constexpr size_t kNeighbours = 64;

StrandOrder strandOrder(const StrandModel& model);

}  // namespace strandcast
