#pragma once
#include <cstdint>
#include <functional>

#include "core/geometry.h"
#include "groom/groom.h"

namespace strandcast {

/// Shape of a procedural groom. A ponytail is gathered at a tie behind the head.
enum class HairStyle { kStraight, kWavy, kCurly, kPonytail };

/// Options of makeProceduralGroom().
struct ProceduralGroomOptions {
  HairStyle style = HairStyle::kStraight;
  int strands = 2000;  ///< 1 to 1,000,000
  int vertices = 24;   ///< per strand, 2 to 128
  /// m, 0.01 to 2, of the longest strands with curls stretched; ponytail: from the tie on.
  float length = 0.30f;
  uint64_t seed = 1;
};

/// Grows a groom on the scalp of the procedural body. Each strand has equal edges, starts on the skin and
/// stays outside it. In a ponytail the vertices at the tie are pinned. The result is deterministic: the same
/// options give the same bits. Throws Error on an option out of range. `growing` is called from time to time
/// with the share that has grown, 0 to 1; an exception that it throws ends the growth.
Groom makeProceduralGroom(const ProceduralGroomOptions& options,
                          const std::function<void(double part)>& growing = {});

}  // namespace strandcast
