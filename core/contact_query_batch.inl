// Batches contact queries of arbitrary rows and lanes of a block into full SIMD vectors: only a few lanes of a row need
// a query, and a query costs the same for one lane as for all. The result for a vertex does not depend on the other
// lanes. Included before core/near_bodies.inl.
class ContactQueryBatch {
 public:
  struct Query {
    real3 x, x_start;     // m, query point, and position at the start of the substep
    real way, travelled;  // m, relative travel between the two, and travel before, see NearBodies
    real others;          // m, least separation bound of the bodies that need no query
    real clear;           // m, clearance
  };

  int count() const { return count_; }
  /// Adds the query of row i in `lanes`. Precondition: count() < kLanes.
  void add(int i, const Query& query, const mask& lanes) {
    const real columns[kColumns] = {query.x.x,
                                    query.x.y,
                                    query.x.z,
                                    query.x_start.x,
                                    query.x_start.y,
                                    query.x_start.z,
                                    query.way,
                                    query.travelled,
                                    query.others,
                                    query.clear,
                                    lit(static_cast<double>(i) * kLanes) + laneNumbers()};
    const Packing together = packing(lanes);
    for (int c = 0; c < kColumns; ++c) compressStore(columns[c], together, columns_[c] + count_);
    count_ += std::popcount(laneBits(lanes));
  }
  /// Removes up to kLanes queries and returns their number. `numbers`: per query, row x kLanes + lane.
  int take(Query& query, uint32_t* numbers) {
    real columns[kColumns];
    for (int c = 0; c < kColumns; ++c) {
      columns[c] = load(columns_[c]);
      store(load(columns_[c] + kLanes), columns_[c]);
    }
    query = {{columns[0], columns[1], columns[2]},
             {columns[3], columns[4], columns[5]},
             columns[6],
             columns[7],
             columns[8],
             columns[9]};
    storeAsInt(columns[kColumns - 1], numbers);
    const int taken = std::min(count_, kLanes);
    count_ -= taken;
    return taken;
  }

 private:
  static constexpr int kColumns = 11;
  alignas(64) Scalar columns_[kColumns][2 * kLanes] = {};
  int count_ = 0;
};
