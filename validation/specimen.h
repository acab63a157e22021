#pragma once
#include <random>
#include <vector>

#include "core/geometry.h"
#include "core/simulation.h"

namespace strandcast {

/// Strands of the experiments: lengths in metres, Y up, the root at the origin.
using StrandPoints = std::vector<Vec3>;

StrandPoints straightStrand(double length, int edges, const Vec3& direction);
/// A right-handed helix about the downward axis.
StrandPoints helixStrand(double radius, double pitch, double length, int edges);
/// A circular arc in the XY plane that starts downwards and bends towards X; curvature in 1/m.
StrandPoints arcStrand(double curvature, double length, int edges);

float anyNumber(std::mt19937& random);  ///< uniform in [-1, 1]
/// A strand whose first edge follows `direction`. Each edge adds a random offset within +-`kink` per axis to
/// the direction of the one before it.
StrandPoints kinkedStrand(const Vec3& root, Vec3 direction, float length, int edges, float kink,
                          std::mt19937& random);

/// Length L, m, at which a strand of this material has the gravito-bending number gamma = 4 rho g L^3 / (E
/// R^2).
double lengthOfGamma(double gamma, const Material& material);
/// Bending stiffness over mass per length, m^4/s^2.
double bendingOverMass(const Material& material);

/// A model of these strands, with one material per strand.
StrandModel modelOf(const std::vector<StrandPoints>& strands, const std::vector<Material>& materials);
StrandModel modelOf(const std::vector<StrandPoints>& strands, const Material& material = {});

constexpr float kHeadRadius = 0.1f;  ///< m
/// Hair on the upper half of a spherical head and a little below, with evenly distributed roots (Fibonacci
/// spiral). `bend`: how much strands curve downwards. The head's centre is the origin.
StrandModel headOfHair(int strands, double length, int edges, double bend);
/// The body of that head, a sphere of kHeadRadius.
RigidBody headBody();

constexpr double kGravity = 9.81;  ///< m/s^2, of every experiment with gravity

/// Excitation of a root: translation along X and rotation about Z, in phase.
struct Shake {
  double reach = 0.1;  ///< m, amplitude along X
  double shakes = 1;   ///< Hz, of the translation
  double turns = 1;    ///< Hz, of the rotation by 45 degrees
  double ramp = 0;     ///< s, smooth onset from rest; 0 = starts with a jump of the velocity
};

/// Pose of the root relative to rest, `time` s after the start.
Pose shakenRoot(double time, const Shake& shake = {});

}  // namespace strandcast
