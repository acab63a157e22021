// Which roots are near a place, and which strands part from each other.
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/strand_set.h"

namespace strandcast {

/// Finds the roots nearest to a place: a k-d tree, stored as a balanced ordering of indices. Results are the
/// same on all machines.
class RootTree {
 public:
  static constexpr uint32_t kNone = UINT32_MAX;

  /// Of `roots` (m, finite), which must outlive the tree, those that `members` names.
  RootTree(const std::vector<Vec3>& roots, std::vector<uint32_t> members);
  /// Up to `count` (1 or more) members nearest to `center` (m), nearest first, without `except`.
  std::vector<uint32_t> nearest(const Vec3& center, size_t count, uint32_t except = kNone) const;
  size_t size() const { return order_.size(); }

 private:
  struct Search {
    Vec3 center;
    size_t count;
    uint32_t except;
    std::vector<std::pair<float, uint32_t>> heap;  ///< squared distance, m^2, and member; the farthest first
  };
  void build(size_t first, size_t last, int axis);
  void search(size_t first, size_t last, int axis, Search& search) const;

  const std::vector<Vec3>& roots_;
  std::vector<uint32_t> order_;
};

/// Where a strand goes, as the parting test compares it.
struct StrandCourse {
  Vec3 start = Vec3::Zero(), whole = Vec3::Zero();  ///< unit, from the root to a quarter of the vertices and
                                                    ///< to the tip; zero where these coincide
  float length = 0;                                 ///< m, along the strand
};
/// Precondition: `points` (m) has 1 or more entries.
StrandCourse courseOf(std::span<const Vec3> points);

/// Whether a parting may lie between two strands, so that no hair follows both: their directions near the
/// root or from root to tip differ by more than 60 degrees, or their lengths by more than a factor of 3.
bool isParting(const StrandCourse& a, const StrandCourse& b);

}  // namespace strandcast
