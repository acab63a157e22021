#pragma once
#include <vector>

#include "validation/suite.h"

namespace strandcast {

/// Defaults of most experiments.
constexpr int kEdges = 32;            ///< edges of a strand
constexpr double kHairLength = 0.25;  ///< m, length of a long strand
constexpr double kRate = 360;         ///< time steps per second

/// Each function appends its experiments.
void addCantileverExperiments(
    std::vector<Experiment>& experiments);  ///< heavy elastica over gamma, edges, time step
void addRestExperiments(std::vector<Experiment>& experiments);       ///< tip loads, catenary, hung helix
void addVibrationExperiments(std::vector<Experiment>& experiments);  ///< beam, chain, pendulum, damping
void addBendTwistExperiments(
    std::vector<Experiment>& experiments);  ///< bend-twist instability; twist from root to tip
void addInvarianceExperiments(std::vector<Experiment>& experiments);  ///< time step, drag, order, units
void addMotionExperiments(std::vector<Experiment>& experiments);      ///< a shaken root: stretch, tip error
void addGuardExperiments(std::vector<Experiment>& experiments);       ///< robustness under extreme input
void addAirExperiments(std::vector<Experiment>& experiments);         ///< the wind grid; a strand in the wind
void addVolumeExperiments(std::vector<Experiment>& experiments);      ///< forces between hairs
void addFrictionExperiments(std::vector<Experiment>& experiments);    ///< stick-slip, slope, capstan
void addContactExperiments(std::vector<Experiment>& experiments);     ///< penetration, rest, energy
void addTunnelExperiments(std::vector<Experiment>& experiments);      ///< fast plates

}  // namespace strandcast
