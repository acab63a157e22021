// Public API
#pragma once
#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// The solvers: docs/solver.md.
enum class SolverKind {
  kGaussSeidel,  ///< position based dynamics (Yuksel and Tariq 2010): iterated angular and distance
                 ///< constraints
  kRod           ///< elastic rod (Bergou et al. 2008): direct solves for twist, bending and length
};

/// Bounds on a substep of the rod, s. A Simulation raises or lowers `substeps` to keep them (at least one
/// substep per step). In longer substeps, wrong tensions from fast motion decay too slowly. In shorter ones,
/// the rounding of positions over the square of the substep outweighs gravity.
constexpr float kLongestSubstep = 1.0f / 60.0f, kShortestSubstep = 1.0f / 4000.0f;

constexpr float kThickestHair = 0.01f;     ///< m, greatest Parameters::hair_radius
constexpr float kStrongestGravity = 1e4f;  ///< m/s^2, greatest component of Parameters::gravity

/// Parameters of a simulation. All but `solver` may change while it runs. SI units; parameterList() has the
/// range of each, and checkParameters() throws beyond it.
struct Parameters {
  float time_step = 1.0f / 60.0f;  ///< s, fixed; 1e-5 to 1/30
  int substeps = 4;                ///< per step, 1 to 64; see kLongestSubstep and kShortestSubstep
  /// Fixed for a simulation's lifetime. The rod uses the Material; gauss_seidel uses only the shape rates as
  /// stiffness, and its strands stretch.
  SolverKind solver = SolverKind::kRod;
  int iterations = 6;          ///< gauss_seidel: rounds of {angular, distance, contact} per substep, 1 to 64
  Vec3 gravity{0, -9.81f, 0};  ///< m/s^2, each component within kStrongestGravity
  Vec3 wind = Vec3::Zero();    ///< m/s, uniform air velocity, each component within 100
  float air_drag = 1.0f;       ///< 1/s, rate at which hair takes on the velocity of the air; 0 to 1000
  /// 1/s, gauss_seidel: rate at which the local shape is restored at the root; 0 to 1e6.
  float shape_rate = 400.0f;
  float shape_rate_tip = 100.0f;  ///< 1/s, same at the tip; linear in between
  /// s, internal (Kelvin-Voigt) damping of the rod: damping ratio zeta = omega damping_time / 2; 0 to 1.
  float damping_time = 0;
  /// 1/s, goal pull towards the rest shape as the root carries it: acceleration goal_rate^2 (goal - x); 0
  /// (off) to 1000.
  float goal_rate = 0;
  float hair_radius = 40e-6f;  ///< m, clearance between a vertex and every body; 0 to kThickestHair

  // External forces (air/, docs/air.md).
  int grid_cells = 32;  ///< cells per axis of the wind grid and the hair grid; 16 to 128, a multiple of 16
  int wind_grid = 0;    ///< 1: `wind` is the inflow of a grid in which hair and bodies block the air
  int mac_cormack = 0;  ///< 1: air is advected with MacCormack's correction
  float air_viscosity = 1.5e-5f;   ///< m^2/s, kinematic
  float air_drag_along = 1;        ///< ratio of the drag along a strand to that across it; 0 to 1
  float hairs_per_strand = 40;     ///< hairs that one strand represents when it blocks the air
  float gust = 0;                  ///< rms of the inflow's speed over its mean
  float gust_period = 4;           ///< s, of the slowest gust
  float turbulence = 0;            ///< rms of one component of the inflow's turbulence over its mean speed
  float turbulence_length = 0.3f;  ///< m, of the largest eddies
  int wind_seed = 1;               ///< random seed of gusts and turbulence
  float volume_stiffness = 0;      ///< m^2/s^2, pressure of hair that is denser than at rest; 0 = off
  float volume_hold = 1;    ///< 1/s, rate at which the pressure grows while hair stays denser than at rest
  float volume_target = 1;  ///< ratio of the volume that hair keeps to that at rest
  float hair_friction = 0;  ///< 1/s, rate at which hair takes on the mean velocity of the hair around it
};

/// Description of one parameter by name, for configuration files, commands and --help.
struct ParameterInfo {
  std::string name;   ///< e.g. "air_drag"
  std::string unit;   ///< e.g. "1/s"
  std::string range;  ///< e.g. "0 or more"
  std::string help;
  int components;    ///< 1, or 3 for vectors
  double low, high;  ///< of each component
  bool whole;        ///< integers only
  int multiple = 1;  ///< integers must be multiples of this
};
/// Descriptions of all parameters.
const std::vector<ParameterInfo>& parameterList();

/// Parses "gauss_seidel" or "rod"; throws Error otherwise.
SolverKind solverKind(const std::string& name);
/// Inverse of solverKind().
std::string solverName(SolverKind solver);

/// Returns the components of a parameter. Throws Error on an unknown name.
std::vector<double> parameter(const Parameters& parameters, const std::string& name);
/// Sets a parameter from its components. Throws Error, naming `where`, on an unknown name (with the nearest
/// known one), a wrong number of components, a value that is not finite or one out of range.
void setParameter(Parameters& parameters, const std::string& name, const std::vector<double>& value,
                  const std::string& where);

/// Throws Error, naming `where` and the parameter, if a value is not finite or out of range.
void checkParameters(const Parameters& parameters, const std::string& where);

}  // namespace strandcast
