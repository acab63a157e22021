#pragma once
#include <cstdint>
#include <span>

#include "core/contact_primitive.h"
#include "core/strand_model.h"

namespace strandcast {

/// How well the hair keeps its lengths and stays out of bodies.
struct Measurement {
  double mean_stretch = 0;  ///< mean over edges of |length / rest length - 1|
  double max_stretch = 0;   ///< greatest |length / rest length - 1|
  /// Greatest penetration of a free vertex, m: depth below any primitive's surface, or below its rest
  /// distance (StrandModel::rest_distance) if that is deeper; 0 if none penetrates.
  double max_penetration = 0;
  size_t non_finite = 0;  ///< vertices with a NaN or an infinity
  size_t edges = 0;       ///< edges with finite ends, over which the mean is taken

  /// Merges the measurement of other strands.
  void add(const Measurement& other);
};

/// Range of strand indices [begin, end).
struct StrandRange {
  size_t begin = 0, end = SIZE_MAX;  ///< clamped to the number of strands
};
/// Measures strands at `positions` (m, natural order). `words`: of the primitives' ShapeData.
Measurement measure(const StrandModel& model, std::span<const Vec3> positions,
                    std::span<const MovingPrimitive> primitives, std::span<const uint32_t> words = {},
                    StrandRange strands = {});

}  // namespace strandcast
