#include "render/deep_opacity.h"

namespace strandcast {

std::array<float, kMaxOpacityLayers + 1> layerEnds(const OpacityLayers& layers, float depth) {
  std::array<double, kMaxOpacityLayers + 1> ends{};
  double size = 1, next = 1, sum = 0;
  for (int k = 0; k < layers.layers; ++k) {
    ends[k] = sum += size;
    switch (layers.sizes) {
      case LayerSizes::kConstant:
        break;
      case LayerSizes::kLinear:
        size += 1;
        break;
      case LayerSizes::kPowerOfTwo:
        size *= 2;
        break;
      case LayerSizes::kFibonacci: {
        const double after = size + next;
        size = next;
        next = after;
        break;
      }
    }
  }
  std::array<float, kMaxOpacityLayers + 1> metres{};
  for (int k = 0; k <= kMaxOpacityLayers; ++k)
    metres[k] = k < layers.layers ? static_cast<float>(depth * ends[k] / sum) : metres[k - 1] + 1;
  return metres;
}

}  // namespace strandcast
