// Vertices that have to look at bodies, of whatever rows and lanes of a block, put together into whole vectors: few lanes of a
// row have to, and a look takes as long for one as for all. What comes out for a vertex does not depend on those beside it.
// Included before core/near_bodies.inl.
class WaitingLooks {
 public:
  struct Look {
    real3 x, x_start;  // m, where the vertex would go and where it was at the start of the substep
    real way, gone;    // m, between them seen from whatever body, and before, see NearBodies
    real others;       // m, the least limit of bodies that it need not look at
    real clear;        // m, how far from bodies it is to be
  };

  int count() const { return count_; }
  /// Of row i those of `lanes`; fewer than kLanes may be waiting already.
  void add(int i, const Look& look, const mask& lanes) {
    const real columns[kColumns] = {look.x.x, look.x.y, look.x.z, look.x_start.x, look.x_start.y, look.x_start.z,
                                    look.way, look.gone, look.others, look.clear,
                                    lit(static_cast<double>(i) * kLanes) + laneNumbers()};
    const Packing together = packing(lanes);
    for (int c = 0; c < kColumns; ++c) pack(columns[c], together, columns_[c] + count_);
    count_ += std::popcount(laneBits(lanes));
  }
  /// Takes up to kLanes of them and gives how many; `numbers`: of each, row x kLanes + lane.
  int take(Look& look, uint32_t* numbers) {
    real columns[kColumns];
    for (int c = 0; c < kColumns; ++c) {
      columns[c] = load(columns_[c]);
      store(load(columns_[c] + kLanes), columns_[c]);
    }
    look = {{columns[0], columns[1], columns[2]}, {columns[3], columns[4], columns[5]},
            columns[6], columns[7], columns[8], columns[9]};
    storeWhole(columns[kColumns - 1], numbers);
    const int taken = std::min(count_, kLanes);
    count_ -= taken;
    return taken;
  }

 private:
  static constexpr int kColumns = 11;
  alignas(64) Scalar columns_[kColumns][2 * kLanes] = {};
  int count_ = 0;
};
