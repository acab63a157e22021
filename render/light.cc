#include "render/light.h"

#include <algorithm>
#include <cmath>

namespace strandcast {

std::string lightDefines(const LightCounts& counts) {
  return "#define LIGHTS " + std::to_string(counts.lights) + "\n#define CASTERS " +
         std::to_string(counts.casters) + "\n";
}

ConeCosines coneCosines(const Light& light) {
  if (light.kind != LightKind::kSpot) return {-2, -3};
  const float outer = std::cos(light.cone), inner = std::cos(light.cone * (1 - light.cone_edge));
  return {std::max(inner, outer + 1e-6f), outer};  // a cone without a soft edge is sharp
}

}  // namespace strandcast
