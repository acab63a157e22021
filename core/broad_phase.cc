#include "core/broad_phase.h"

namespace strandcast {
namespace {

class AllPairs final : public BroadPhase {
 public:
  void find(std::span<const Box> bodies, std::span<const Box> neighbourhoods, NearBodyLists& out) override {
    out.offsets.assign(1, 0);
    out.bodies.clear();
    for (const Box& neighbourhood : neighbourhoods) {
      for (uint32_t i = 0; i < bodies.size(); ++i)
        if (neighbourhood.intersects(bodies[i])) out.bodies.push_back(i);
      out.offsets.push_back(static_cast<uint32_t>(out.bodies.size()));
    }
  }
};

}  // namespace

std::unique_ptr<BroadPhase> makeAllPairs() { return std::make_unique<AllPairs>(); }

}  // namespace strandcast
