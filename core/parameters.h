#pragma once
#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

enum class SolverKind {
  kGaussSeidel,  ///< the course's scheme: iterated angular and distance constraints
  kRod           ///< an elastic rod: direct solves for twist, bending and length
};

/// s. A substep of the rod is no longer, nor shorter unless the step is: what a Simulation is told to do in
/// fewer or more substeps it does in as many as that takes. In longer ones the tensions of violent motion are
/// forgotten too slowly; in shorter ones the rounding of positions, over the square of the substep, outweighs
/// gravity.
constexpr float kLongestSubstep = 1.0f / 60.0f, kShortestSubstep = 1.0f / 4000.0f;

constexpr float kThickestHair = 0.01f;     ///< m, Parameters::hair_radius at most
constexpr float kStrongestGravity = 1e4f;  ///< m/s^2, each component of Parameters::gravity at most

/// Everything that may change while a simulation runs, but for the solver. SI units; parameterList() has the
/// range of each, beyond which checkParameters() throws.
struct Parameters {
  float time_step = 1.0f / 60.0f;  ///< s, fixed; 1e-5 to 1/30
  int substeps = 4;                ///< per step, 1 to 64; see kLongestSubstep and kShortestSubstep
  /// Of a simulation's whole life. The rod is what a Material is for; gauss_seidel knows no stiffness but the
  /// shape rates, and stretches.
  SolverKind solver = SolverKind::kRod;
  int iterations = 6;          ///< of gauss_seidel: of {angular, distance, contact} per substep, 1 to 64
  Vec3 gravity{0, -9.81f, 0};  ///< m/s^2, each component within kStrongestGravity
  Vec3 wind = Vec3::Zero();    ///< m/s, uniform air velocity, each component within 100
  float air_drag = 1.0f;       ///< 1/s, rate at which hair takes on the velocity of the air; 0 to 1000
  /// 1/s, of gauss_seidel: rate at which the local shape is restored at the root; 0 to 1e6.
  float shape_rate = 400.0f;
  float shape_rate_tip = 100.0f;  ///< 1/s, the same at the tip; linear in between
  /// s, internal (Kelvin-Voigt) damping of the rod: zeta = omega damping_time / 2; 0 to 1.
  float damping_time = 0;
  /// 1/s, pull towards the rest shape as the root carries it: goal_rate^2 (goal - x); 0 = off, to 1000.
  float goal_rate = 0;
  float hair_radius = 40e-6f;  ///< m, kept between the hair's axis and every body; 0 to kThickestHair

  // Surroundings (air/, docs/air.md).
  int grid_cells = 32;             ///< per axis, of the grids of air and of hair; 16 to 128, a multiple of 16
  int wind_grid = 0;               ///< 1: `wind` is what flows into a grid that hair and bodies block
  int mac_cormack = 0;             ///< 1: air is advected with MacCormack's correction
  float air_viscosity = 1.5e-5f;   ///< m^2/s, kinematic
  float air_drag_along = 1;        ///< drag along a strand over that across it; 0 to 1
  float hairs_per_strand = 40;     ///< that a strand stands for, where it holds the air back
  float gust = 0;                  ///< rms of the inflow's speed over its mean
  float gust_period = 4;           ///< s, of the slowest gust
  float turbulence = 0;            ///< rms of a component of the inflow's turbulence over its mean speed
  float turbulence_length = 0.3f;  ///< m, of the largest eddies
  int wind_seed = 1;               ///< of gusts and turbulence
  float volume_stiffness = 0;      ///< m^2/s^2, of hair that is denser than at rest; 0 = off
  float volume_hold = 1;           ///< 1/s, at which a push grows while hair stays denser than at rest
  float volume_target = 1;         ///< volume that hair keeps over that at rest
  float hair_friction = 0;  ///< 1/s, rate at which hair takes on the mean velocity of the hair around it
};

/// One setting by name, as configuration files, commands and --help know it.
struct ParameterInfo {
  std::string name;   ///< e.g. "air_drag"
  std::string unit;   ///< e.g. "1/s"
  std::string range;  ///< e.g. "0 or more"
  std::string help;
  int components;    ///< 1, or 3 for vectors
  double low, high;  ///< of each component
  bool whole;
  int multiple = 1;  ///< of which whole numbers are
};
const std::vector<ParameterInfo>& parameterList();

/// "gauss_seidel" or "rod"; Error otherwise.
SolverKind solverKind(const std::string& name);
std::string solverName(SolverKind solver);

/// Reads a parameter as its components. Throws Error on an unknown name.
std::vector<double> parameter(const Parameters& parameters, const std::string& name);
/// Sets a parameter from its components. Throws Error, naming `where`, on an unknown name (with the nearest
/// known one), a wrong number of components, a non-finite value or one out of range.
void setParameter(Parameters& parameters, const std::string& name, const std::vector<double>& value,
                  const std::string& where);

/// Throws Error, naming `where` and the parameter, when a value is not finite or out of range.
void checkParameters(const Parameters& parameters, const std::string& where);

}  // namespace strandcast
