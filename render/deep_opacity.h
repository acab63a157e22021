#pragma once
#include <array>

namespace strandcast {

/// How the depths of the layers of a deep opacity map follow each other: as 1 1 1 1, 1 2 3 4, 1 2 4 8 or
/// 1 1 2 3 5 8.
enum class LayerSizes { kConstant, kLinear, kPowerOfTwo, kFibonacci };
/// What becomes of hair behind the last layer (Yuksel and Keyser 2008, section 3.1): it casts no shadow, it
/// counts in the last layer and so shades itself, or the layers are made to reach past it.
enum class BeyondLayers { kIgnore, kLastLayer, kReach };

/// Deep opacity maps: layers that follow the front of the hair as the light sees it, each with the optical
/// depth of all hair from the front to its end.
struct OpacityLayers {
  int layers = 7;  ///< 3, 7, 11 or 15
  LayerSizes sizes = LayerSizes::kFibonacci;
  BeyondLayers beyond = BeyondLayers::kLastLayer;
  float depth = 0.12f;  ///< m, of all layers together, unless they are to reach
  int map_size = 512;   ///< texels a side, 16 to 8192
  int filter = 0;       ///< texels to either side that are averaged beyond bilinear filtering, 0 to 4

  bool operator==(const OpacityLayers&) const = default;
};

constexpr int kMostOpacityLayers = 15;

/// Where each layer ends, metres behind the front: `layers.layers` increasing numbers, the last one `depth`;
/// after them the last again, each a metre on.
std::array<float, kMostOpacityLayers + 1> layerEnds(const OpacityLayers& layers, float depth);

}  // namespace strandcast
