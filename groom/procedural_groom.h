#pragma once
#include <cstdint>
#include <functional>

#include "core/triangle_mesh.h"
#include "groom/groom.h"

namespace strandcast {

enum class HairStyle { kStraight, kWavy, kCurly, kPonytail };

struct ProceduralGroomOptions {
  HairStyle style = HairStyle::kStraight;
  int strands = 2000;    ///< 1 to 1,000,000
  int vertices = 24;     ///< per strand, 2 to 128
  float length = 0.30f;  ///< m, 0.01 to 2, of the longest strands as if uncoiled; ponytail: from the tie on
  uint64_t seed = 1;
};

/// Grows a groom on the procedural body's scalp. Every strand has vertices at equal distances, starts on the
/// skin and stays outside it. A ponytail's vertices at the tie are pinned. The same options give the same
/// bits. Throws Error on an option out of range. `growing` is told now and then what part has grown, 0 to 1;
/// what it throws ends it.
Groom makeProceduralGroom(const ProceduralGroomOptions& options,
                          const std::function<void(double part)>& growing = {});

}  // namespace strandcast
