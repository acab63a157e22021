#include "light/fibre_material.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "core/name_lookup.h"

namespace strandcast {
namespace {

constexpr double kMaxAbsorption = 1000;

void checkFibreNumber(double value, double low, double high, const char* what, const std::string& where) {
  if (!(value >= low && value <= high))  // also NaN
    throw Error(fmt::format("{} is {:g}", what, value), where,
                fmt::format("give a number from {:g} to {:g}", low, high));
}

struct FibrePreset {
  const char* name;
  Eigen::Array3d sigma_a;
};

/// Concentrations of melanin follow Chiang et al. 2016 for black, brown and blond; grey is evenly absorbing,
/// as the mixture of white and dark hairs that it is; dyed is a reflectance.
const std::vector<FibrePreset>& fibrePresets() {
  const double roughness = FibreMaterial{}.azimuthal_roughness;
  static const std::vector<FibrePreset> list = {
      {"black", absorptionOfMelanin(8, 0)},
      {"brown", absorptionOfMelanin(1.3, 0)},
      {"dark_blond", absorptionOfMelanin(0.6, 0.1)},
      {"light_blond", absorptionOfMelanin(0.2, 0.05)},
      {"red", absorptionOfMelanin(0.3, 1.4)},
      {"grey", absorptionOfReflectance({0.42, 0.42, 0.43}, roughness)},
      {"white", absorptionOfMelanin(0.008, 0)},
      {"dyed", absorptionOfReflectance({0.45, 0.03, 0.12}, roughness)},
  };
  return list;
}

}  // namespace

void checkFibreMaterial(const FibreMaterial& material, const std::string& where) {
  for (const double sigma : material.sigma_a)
    checkFibreNumber(sigma, 0, kMaxAbsorption, "absorption per radius (sigma_a)", where);
  checkFibreNumber(material.longitudinal_roughness, 0.001, 1, "longitudinal roughness", where);
  checkFibreNumber(material.azimuthal_roughness, 0.001, 1, "azimuthal roughness", where);
  checkFibreNumber(material.tilt, -0.35, 0.35, "tilt of the scales in rad", where);
  checkFibreNumber(material.index, 1, 2.5, "index of refraction", where);
  checkFibreNumber(material.axis_ratio, 0.5, 1, "minor over major axis of the section", where);
}

kernels::f64::FibreShape fibreShapeOf(const FibreMaterial& material) {
  checkFibreMaterial(material, "material of a fibre");
  return kernels::f64::fibreShape(material.longitudinal_roughness, material.azimuthal_roughness,
                                  material.tilt, material.index);
}

Eigen::Array3d absorptionOfMelanin(double eumelanin, double pheomelanin) {
  checkFibreNumber(eumelanin, 0, 20, "concentration", "eumelanin");
  checkFibreNumber(pheomelanin, 0, 20, "concentration", "pheomelanin");
  return eumelanin * Eigen::Array3d(0.419, 0.697, 1.37) + pheomelanin * Eigen::Array3d(0.187, 0.4, 1.05);
}

Eigen::Array3d absorptionOfReflectance(const Eigen::Array3d& reflectance, double azimuthal_roughness) {
  for (const double c : reflectance) checkFibreNumber(c, 0, 1, "linear colour", "reflectance of hair");
  checkFibreNumber(azimuthal_roughness, 0.001, 1, "azimuthal roughness", "reflectance of hair");
  const double b = azimuthal_roughness;
  const double scale = 5.969 + b * (-0.215 + b * (2.532 + b * (-10.73 + b * (5.574 + b * 0.245))));
  return (reflectance.log() / scale).square().min(kMaxAbsorption);
}

const std::vector<std::string>& fibrePresetNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const FibrePreset& preset : fibrePresets()) list.emplace_back(preset.name);
    return list;
  }();
  return names;
}

FibreMaterial fibrePreset(const std::string& name) {
  const FibrePreset& preset = namedEntry(fibrePresets(), "hair material", name, "presets of fibres");
  FibreMaterial material;
  material.sigma_a = preset.sigma_a;
  return material;
}

}  // namespace strandcast
