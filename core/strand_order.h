#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/strand_model.h"

namespace strandcast {

/// Strands sorted by vertex count and root position, and cut into neighbourhoods: up to kNeighbours strands
/// of equal vertex count that are side by side on the head. All code that handles several strands together
/// uses this order, so that each neighbourhood is one or more blocks of any CPU backend.
struct StrandOrder {
  std::vector<uint32_t> strands;           ///< strand indices in this order
  std::vector<uint32_t> offsets{0};        ///< neighbourhoods + 1 entries, into `strands`
  std::vector<uint32_t> neighbourhood_of;  ///< per strand, natural order

  size_t neighbourhoods() const { return offsets.size() - 1; }
  std::span<const uint32_t> strandsOf(size_t neighbourhood) const {
    return {strands.data() + offsets[neighbourhood], offsets[neighbourhood + 1] - offsets[neighbourhood]};
  }
};

/// Greatest size of a neighbourhood: a multiple of every number of lanes.
constexpr size_t kNeighbours = 64;

/// Computes the order of a model's strands.
StrandOrder strandOrder(const StrandModel& model);

}  // namespace strandcast
