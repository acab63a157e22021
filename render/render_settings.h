#pragma once
#include <cstdint>
#include <vector>

#include "core/geometry.h"
#include "render/deep_opacity.h"
#include "render/hair_growth.h"
#include "render/light.h"
#include "render/mark_settings.h"
#include "render/supersampling.h"

namespace strandcast {

/// Where hair is grown: once per picture by a compute shader, or in every pass by the tessellator.
enum class GrowthPath { kCompute, kTessellator };
/// Lines, whose width is as the device has it, or strips of triangles that face the eye (kCompute only).
enum class HairGeometry { kLines, kStrips };

/// Where hair is lit: at its vertices, with colours in between, or in every fragment.
enum class HairShading { kVertex, kFragment };

/// What becomes of a hair that covers a part of a pixel: it reaches that part of the samples, others for each
/// hair (stochastic transparency), or the samples that the device chooses for that alpha (alpha to coverage).
enum class HairCoverage { kStochastic, kAlphaToCoverage };

/// Fewer, wider hairs of fewer segments where they are small in the picture (render/hair_detail.h).
struct LevelOfDetail {
  float part = 0;         ///< of the hairs that are drawn, above 0 to 1; 0 = by their size in the picture
  float finest_hair = 0;  ///< pixels: as many hairs are left out as make the rest this wide; 0 = a sample
  float hysteresis =
      0.1f;  ///< 0 to 1: part by which hair may grow smaller in the picture before more is left out
  float longest_segment = 1;  ///< pixels: so many segments are left out as leave them shorter
};

/// What is done for a picture. Where a pass is left out, what follows sees what it left the time before.
enum class RenderPass {
  kGuides,       ///< the guides' curves, for kGrowth
  kGrowth,       ///< hair from guides, for every pass that draws hair
  kSolidShadow,  ///< depth of solids from each light that casts shadows
  kHairShadow,   ///< front and opacity layers of the hair from each of them
  kBackground,
  kBody,
  kGround,
  kHair,
  kMarks,   ///< RenderSettings::marks
  kResolve  ///< of samples, to the picture that is shown
};
inline constexpr RenderPass kLastPass = RenderPass::kResolve;
/// e.g. "hair-shadow".
const char* nameOf(RenderPass pass);
/// All, in the order above.
std::vector<RenderPass> allPasses();

/// Colours are linear, 0 to 1. Values out of range are clipped to it.
struct RenderSettings {
  int width = 1280, height = 720;               ///< 16 to 16384 pixels
  int samples = 4;                              ///< multisampling, 1 to 8, as far as the device goes
  int supersampling = 1;                        ///< 1 to 4 times as many pixels a side, for stills
  PixelFilter filter = PixelFilter::kGaussian;  ///< that makes one of them
  HairCoverage coverage = HairCoverage::kStochastic;
  HairGrowth growth;  ///< 0 to 4,000,000 hairs
  GrowthPath growth_path = GrowthPath::kCompute;
  HairGeometry geometry = HairGeometry::kStrips;
  HairShading shading = HairShading::kVertex;
  LevelOfDetail detail;
  bool cull = true;       ///< groups of hair that cannot be in the picture are not grown
  int segments = 32;      ///< per hair, 1 to 256
  bool keep_out = false;  ///< hair of the obstacles that the renderer is given
  MarkSettings marks;
  float clearance = 1e-4f;     ///< m, that grown hair keeps from obstacles
  float hair_width = 120e-6f;  ///< m, drawn width, more than a hair's as 40,000 stand for 100,000; narrower
                               ///< than a pixel it covers that part of the pixel
  Vec3 hair_color{0.30f, 0.17f, 0.08f};  ///< of light scattered once around in the hair
  Vec3 body_color{0.62f, 0.42f, 0.33f};
  Vec3 background{0.30f, 0.33f, 0.38f};
  /// kMostLights at most. Without any there is only the light from all around.
  std::vector<Light> lights = std::vector<Light>(1);
  bool shadows = true;    ///< of all lights that cast any
  OpacityLayers opacity;  ///< shadow of the hair
  /// In this order; one named twice is done once. Those that draw may come in any order, as depth decides.
  std::vector<RenderPass> passes = allPasses();
};

LightCounts countsOf(const RenderSettings& settings);

/// `settings` with every value in its range and not-finite ones replaced by the defaults.
RenderSettings clipped(const RenderSettings& settings);

}  // namespace strandcast
