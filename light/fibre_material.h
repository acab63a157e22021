#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "kernels/scalar_fibre.h"

namespace strandcast {

/// How hair scatters light: a dielectric fibre with a coloured interior, whose cuticle scales are rough and
/// tilted. Defaults are brown hair.
struct FibreMaterial {
  /// Absorption of red, green and blue per fibre radius, 0 to 1000.
  Eigen::Array3d sigma_a{0.5447, 0.9061, 1.781};
  double longitudinal_roughness = 0.3;  ///< 0.001 to 1; perceptual scale of Chiang et al. 2016
  double azimuthal_roughness = 0.3;     ///< 0.001 to 1; the same scale
  /// Angle of the scales to the fibre's surface, rad, -0.35 to 0.35. Positive for human hair: normals of the
  /// scales lean towards the root. See docs/light.md for the shifts of the lobes that follow.
  double tilt = 0.0349;
  double index = 1.55;    ///< index of refraction, 1 to 2.5
  double axis_ratio = 1;  ///< minor over major axis of the section, 0.5 to 1; `marschner` only
};

/// Throws Error, naming `where`, if a value is not finite or out of range.
void checkFibreMaterial(const FibreMaterial& material, const std::string& where);

/// What the lobes of ChiangFibre have in common. Throws Error as checkFibreMaterial().
kernels::f64::FibreShape fibreShapeOf(const FibreMaterial& material);

/// Absorption per radius by melanin: concentrations 0 to 20 (Chiang et al. 2016; d'Eon et al. 2011). Brown
/// hair has 1.3 of eumelanin, red hair mostly pheomelanin.
Eigen::Array3d absorptionOfMelanin(double eumelanin, double pheomelanin);

/// Absorption per radius with which dense hair has this linear colour, 0 to 1 per channel (Chiang et al.
/// 2016, equation 9). The fit is for hair in bulk: a single fibre is lighter. At most 1000, where a channel
/// is 0.
Eigen::Array3d absorptionOfReflectance(const Eigen::Array3d& reflectance, double azimuthal_roughness);

/// Names of the presets: black, brown, dark_blond, light_blond, red, grey, white, dyed.
const std::vector<std::string>& fibrePresetNames();
/// Throws Error on an unknown name, with the nearest known one.
FibreMaterial fibrePreset(const std::string& name);

}  // namespace strandcast
