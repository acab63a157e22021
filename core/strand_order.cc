#include "core/strand_order.h"

#include <algorithm>
#include <numeric>

namespace strandcast {
namespace {

/// Positions of the roots on a Z-order curve (Morton 1966) through their box: neighbours on the curve are
/// neighbours on the head.
std::vector<uint32_t> mortonCodes(const std::vector<Pose>& roots) {
  Box box;
  for (const Pose& root : roots) box.extend(root.position);
  const float cell = std::max(box.sizes().maxCoeff(), 1e-6f) / 1023;
  std::vector<uint32_t> codes(roots.size());
  for (size_t s = 0; s < roots.size(); ++s)
    for (int axis = 0; axis < 3; ++axis) {
      const auto place = static_cast<uint32_t>((roots[s].position[axis] - box.min()[axis]) / cell);
      for (int bit = 0; bit < 10; ++bit) codes[s] |= (place >> bit & 1u) << (3 * bit + axis);
    }
  return codes;
}

}  // namespace

StrandOrder strandOrder(const StrandModel& model) {
  StrandOrder order;
  order.strands.resize(model.strands());
  std::iota(order.strands.begin(), order.strands.end(), 0u);
  const std::vector<uint32_t> place = mortonCodes(model.rest_roots);
  std::stable_sort(order.strands.begin(), order.strands.end(), [&](uint32_t a, uint32_t b) {
    return std::pair(model.verticesOf(a), place[a]) < std::pair(model.verticesOf(b), place[b]);
  });
  order.neighbourhood_of.resize(model.strands());
  for (uint32_t i = 0; i < order.strands.size(); ++i) {
    const bool more = i > 0 && i - order.offsets.back() < kNeighbours &&
                      model.verticesOf(order.strands[i]) == model.verticesOf(order.strands[i - 1]);
    if (i > 0 && !more) order.offsets.push_back(i);
    order.neighbourhood_of[order.strands[i]] = static_cast<uint32_t>(order.offsets.size()) - 1;
  }
  if (!order.strands.empty()) order.offsets.push_back(static_cast<uint32_t>(order.strands.size()));
  return order;
}

}  // namespace strandcast
