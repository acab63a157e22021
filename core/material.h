#pragma once
#include <string>
#include <utility>
#include <vector>

namespace strandcast {

/// A factor along a strand, from the root (0) to the tip (1): linear between knots, constant beyond them. Two
/// knots at one place between root and tip make a step.
struct RootTipCurve {
  std::vector<std::pair<float, float>> knots{
      {0.0f, 1.0f}};  ///< (place, factor), places ascending, at least one

  float at(float place) const;
};

/// What the hair of one part is made of: a round elastic rod. Human hair unless said otherwise.
struct Material {
  float youngs_modulus = 4e9f;   ///< Pa, 1e3 to 1e13; human hair 3e9 to 4e9
  float poisson_ratio = 0.45f;   ///< -0.9 to 0.5
  float radius = 40e-6f;         ///< m, 1e-6 to 5e-3; human hair 30e-6 to 50e-6
  float density = 1300;          ///< kg/m^3, 1 to 20000
  RootTipCurve radius_scale;     ///< taper; bending goes with its 4th power, mass with its square
  RootTipCurve stiffness_scale;  ///< of youngs_modulus
  RootTipCurve density_scale;    ///< of density
  // Factors of what Parameters has for all hair, which may change while a simulation runs.
  RootTipCurve air_drag_scale;  ///< of air_drag, 0 to 1e3
  RootTipCurve goal_scale;      ///< of goal_rate, 0 to 1
  float damping_scale = 1;      ///< of damping_time, 0 to 1e3
  float friction_scale = 1;     ///< of every body's friction, 0 to 1e3
  RootTipCurve damping_curve;   ///< of damping_scale, at joints; their product is 0 to 1e3 too
  RootTipCurve friction_curve;  ///< of friction_scale, at vertices; likewise
  /// Longest distance of a vertex from its root, over its arc length from the root at rest: 1 to 10, or 0 =
  /// off. For gauss_seidel, which stretches; the rod keeps its lengths anyway.
  float tether = 0;
};

/// Throws Error, naming `where`, when a value is out of range.
void checkMaterial(const Material& material, const std::string& where);

/// One setting of a material by name, as configuration files, options and --help know it.
struct MaterialSettingInfo {
  std::string name;   ///< e.g. "youngs_modulus"
  std::string unit;   ///< e.g. "Pa"
  std::string range;  ///< e.g. "1e3 to 1e13"
  std::string help;
  bool curve;  ///< knots of a RootTipCurve, two numbers each, or one number for the whole strand
};
const std::vector<MaterialSettingInfo>& materialSettingList();

constexpr const char* kShearModulus = "shear_modulus";

/// Sets one value of a material. kShearModulus (Pa) sets the Poisson ratio that belongs to it and to the
/// Young's modulus as it is then. Throws Error, naming `where`, on an unknown name (with the nearest known
/// one), a wrong number of values, or one that is not finite or out of range.
void setMaterial(Material& material, const std::string& name, const std::vector<double>& values,
                 const std::string& where);

}  // namespace strandcast
