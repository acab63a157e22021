#pragma once
#include <string>
#include <utility>
#include <vector>

namespace strandcast {

/// A factor along a strand from the root (0) to the tip (1): linear between knots, constant beyond them. Two
/// knots at one position between root and tip make a step.
struct RootTipCurve {
  std::vector<std::pair<float, float>> knots{
      {0.0f, 1.0f}};  ///< (position, factor), positions ascending, at least one

  float at(float place) const;
};

/// Material of the hair of one part: a round elastic rod. Defaults are human hair.
struct Material {
  float youngs_modulus = 4e9f;   ///< Pa, 1e3 to 1e13; human hair 3e9 to 4e9
  float poisson_ratio = 0.45f;   ///< -0.9 to 0.5
  float radius = 40e-6f;         ///< m, 1e-6 to 5e-3; human hair 30e-6 to 50e-6
  float density = 1300;          ///< kg/m^3, 1 to 20000
  RootTipCurve radius_scale;     ///< taper; bending stiffness scales with its 4th power, mass with its square
  RootTipCurve stiffness_scale;  ///< of youngs_modulus
  RootTipCurve density_scale;    ///< of density
  // Factors on values of Parameters, which may change while a simulation runs.
  RootTipCurve air_drag_scale;  ///< on air_drag, 0 to 1e3
  RootTipCurve goal_scale;      ///< on goal_rate, 0 to 1
  float damping_scale = 1;      ///< on damping_time, 0 to 1e3
  float friction_scale = 1;     ///< on every body's friction, 0 to 1e3
  RootTipCurve damping_curve;   ///< on damping_scale, per joint; their product is 0 to 1e3, too
  RootTipCurve friction_curve;  ///< on friction_scale, per vertex; likewise
  /// Greatest distance of a vertex from its root over its arc length from the root at rest: 1 to 10, or 0 =
  /// off. For gauss_seidel, whose strands stretch; the rod keeps its lengths anyway.
  float tether = 0;
};

/// Throws Error, naming `where`, if a value is out of range.
void checkMaterial(const Material& material, const std::string& where);

/// Description of one material setting by name, for configuration files, options and --help.
struct MaterialSettingInfo {
  std::string name;   ///< e.g. "youngs_modulus"
  std::string unit;   ///< e.g. "Pa"
  std::string range;  ///< e.g. "1e3 to 1e13"
  std::string help;
  bool curve;  ///< knots of a RootTipCurve, two numbers each, or one number for the whole strand
};
/// All settings of a material, with kShearModulus.
const std::vector<MaterialSettingInfo>& materialSettingList();

/// Name of the setting that sets the Poisson ratio by the shear modulus, see setMaterial().
constexpr const char* kShearModulus = "shear_modulus";

/// Sets one value of a material. kShearModulus (Pa) sets the Poisson ratio that follows from it and the
/// present Young's modulus. Throws Error, naming `where`, on an unknown name (with the nearest known one), a
/// wrong number of values, or a value that is not finite or out of range.
void setMaterial(Material& material, const std::string& name, const std::vector<double>& values,
                 const std::string& where);

}  // namespace strandcast
