// Settings of a picture: lights, deep opacity maps, diagnostic marks, level of detail, passes.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "light/light_sources.h"
#include "render/framebuffer.h"
#include "render/hair_growth.h"

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

/// Numbers of lights for which shaders are compiled.
struct LightCounts {
  size_t lights = 0, casters = 0;  ///< lights that cast shadows come first
  bool operator==(const LightCounts&) const = default;
};
/// The preprocessor defines for shaders: "#define LIGHTS 2\n...".
std::string lightDefines(const LightCounts& counts);

/// Diagnostic marks over a picture.
struct MarkSettings {
  bool guides = false;    ///< the guides' curves, one colour each
  bool tangents = false;  ///< of guides, 1 cm long; red, green and blue are the x, y and z components
  bool collided = false;  ///< vertices of guides that touch an obstacle: yellow, red inside
  bool inside = false;    ///< vertices of grown hair inside an obstacle (kCompute only)

  bool any() const { return guides || tangents || collided || inside; }
  bool needBodies() const { return collided || inside; }
  bool operator==(const MarkSettings&) const = default;
};

/// kCompute: hair is grown once per picture by a compute shader. kTessellator: every pass grows it.
enum class GrowthPath { kCompute, kTessellator };
/// kLines: line width as the device supports. kStrips: triangle strips that face the eye (kCompute only).
enum class HairGeometry { kLines, kStrips };

/// Hair is shaded at its vertices, with interpolated colours, or in every fragment.
enum class HairShading { kVertex, kFragment };

/// Coverage of a hair that covers a fraction of a pixel. kStochastic: it covers that fraction of the samples,
/// different ones for each hair (stochastic transparency). kAlphaToCoverage: the device chooses the samples.
enum class HairCoverage { kStochastic, kAlphaToCoverage };

/// Fewer, wider hairs with fewer segments where they are small in the picture (render/hair_selection.h).
struct LevelOfDetail {
  float part = 0;         ///< fraction of the hairs to draw, above 0 to 1; 0 = by their size in the picture
  float finest_hair = 0;  ///< pixels: hairs are left out until the rest is this wide; 0 = one sample
  float hysteresis =
      0.1f;  ///< 0 to 1: relative change of size in the picture that does not change the detail
  float longest_segment = 1;  ///< pixels: segments are merged up to this length
};

/// The passes of a picture. Without a pass, later ones use its result of an earlier picture.
enum class RenderPass {
  kGuides,       ///< the guides' curves, for kGrowth
  kGrowth,       ///< hair from guides, for every pass that draws hair
  kSolidShadow,  ///< depth of solids from each light that casts shadows
  kHairShadow,   ///< front and opacity layers of the hair from each of these lights
  kBackground,
  kBody,
  kGround,
  kHair,
  kMarks,   ///< RenderSettings::marks
  kResolve  ///< resolves samples into the final picture
};
inline constexpr RenderPass kLastPass = RenderPass::kResolve;
/// e.g. "hair-shadow".
const char* nameOf(RenderPass pass);
/// All passes, in the order of the enumeration.
std::vector<RenderPass> allPasses();

/// Colours are linear, 0 to 1. Values out of range are clamped.
struct RenderSettings {
  int width = 1280, height = 720;               ///< 16 to 16384 pixels
  int samples = 4;                              ///< multisampling, 1 to 8, limited by the device
  int supersampling = 1;                        ///< factor of pixels per side, 1 to 4, for stills
  PixelFilter filter = PixelFilter::kGaussian;  ///< filter for supersampling
  HairCoverage coverage = HairCoverage::kStochastic;
  HairGrowth growth;  ///< 0 to 4,000,000 hairs
  GrowthPath growth_path = GrowthPath::kCompute;
  HairGeometry geometry = HairGeometry::kStrips;
  HairShading shading = HairShading::kVertex;
  LevelOfDetail detail;
  bool cull = true;       ///< groups of hair that cannot be in the picture are not grown
  int segments = 32;      ///< per hair, 1 to 256
  bool keep_out = false;  ///< keeps hair out of the renderer's obstacles
  MarkSettings marks;
  float clearance = 1e-4f;     ///< m, distance that grown hair keeps from obstacles
  float hair_width = 120e-6f;  ///< m, drawn width; more than a real hair's, as 40,000 stand for 100,000. A
                               ///< hair narrower than a pixel covers that fraction of it
  Vec3 hair_color{0.30f, 0.17f, 0.08f};  ///< linear; of light scattered once around in the hair
  Vec3 body_color{0.62f, 0.42f, 0.33f};
  Vec3 background{0.30f, 0.33f, 0.38f};
  float exposure = 0;           ///< stops, -20 to 20: each doubles the radiance that is shown
  Vec3 white_balance{1, 1, 1};  ///< linear, 0.01 to 1: colour of light that is shown neutral
  /// At most kMaxLights. Without lights there is only ambient light.
  std::vector<Light> lights = std::vector<Light>(1);
  bool shadows = true;    ///< of all lights that cast shadows
  OpacityLayers opacity;  ///< shadow of the hair
  /// In this order; duplicates run once. Passes that draw may be in any order, because of the depth test.
  std::vector<RenderPass> passes = allPasses();
};

/// Factors of radiance before tone mapping (kernels/picture.h), by exposure and white balance. Green has the
/// exposure alone. Precondition: valid settings.
Vec3 exposureGains(const RenderSettings& settings);

/// The numbers of lights, and of those that cast shadows with these settings.
LightCounts countsOf(const RenderSettings& settings);

/// `settings` with every value clamped to its range and values that are not finite replaced by defaults.
RenderSettings clipped(const RenderSettings& settings);

}  // namespace strandcast
