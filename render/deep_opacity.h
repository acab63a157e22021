#pragma once
#include <array>

namespace strandcast {

/// Ratios of the thicknesses of a deep opacity map's layers: 1 1 1 1, 1 2 3 4, 1 2 4 8 or 1 1 2 3 5 8.
enum class LayerSizes { kConstant, kLinear, kPowerOfTwo, kFibonacci };
/// Treatment of hair behind the last layer (Yuksel and Keyser 2008, section 3.1). kIgnore: it casts no
/// shadow. kLastLayer: it counts in the last layer and so shades itself. kReach: the layers extend past it.
enum class BeyondLayers { kIgnore, kLastLayer, kReach };

/// Deep opacity maps: layers that follow the front of the hair as seen from the light. Each stores the
/// optical depth of all hair from the front to the layer's end.
struct OpacityLayers {
  int layers = 7;  ///< 3, 7, 11 or 15
  LayerSizes sizes = LayerSizes::kFibonacci;
  BeyondLayers beyond = BeyondLayers::kLastLayer;
  float depth = 0.12f;  ///< m, of all layers together; unused for kReach
  int map_size = 512;   ///< texels per side, 16 to 8192
  int filter = 0;       ///< radius in texels of a box filter on top of bilinear filtering, 0 to 4

  bool operator==(const OpacityLayers&) const = default;
};

constexpr int kMaxOpacityLayers = 15;

/// The end of each layer, metres behind the front: `layers.layers` increasing numbers, the last one `depth`.
/// Unused entries continue in steps of 1 m.
std::array<float, kMaxOpacityLayers + 1> layerEnds(const OpacityLayers& layers, float depth);

}  // namespace strandcast
