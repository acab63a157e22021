#pragma once
#include <cstdint>
#include <span>

#include "core/contact_primitive.h"
#include "core/strand_model.h"

namespace strandcast {

/// How well the hair keeps what it must keep.
struct Measurement {
  double mean_stretch = 0;  ///< mean over edges of |length / rest length - 1|
  double max_stretch = 0;   ///< the largest of the same
  /// m, deepest free vertex below any primitive's surface, or below where it is at rest
  /// (StrandModel::rest_distance) where that is deeper; 0 when none is.
  double max_penetration = 0;
  size_t non_finite = 0;  ///< vertices with a NaN or an infinity
  size_t edges = 0;       ///< of which the mean is: all whose ends are finite

  /// Takes in what was measured of other strands.
  void add(const Measurement& other);
};

/// Strands by number, from `begin` until before `end`.
struct StrandRange {
  size_t begin = 0, end = SIZE_MAX;  ///< beyond the last one: until that
};
/// `words`: of the primitives' ShapeData.
Measurement measure(const StrandModel& model, std::span<const Vec3> positions,
                    std::span<const MovingPrimitive> primitives, std::span<const uint32_t> words = {},
                    StrandRange strands = {});

}  // namespace strandcast
