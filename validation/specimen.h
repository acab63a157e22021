#pragma once
#include <random>
#include <vector>

#include "core/simulation.h"

namespace strandcast {

/// Strands as the experiments take them. Number of edges, lengths in metres, Y up; the root is at the origin.
using StrandPoints = std::vector<Vec3>;

StrandPoints straightStrand(double length, int edges, const Vec3& direction);
/// A right-handed helix about the downward axis.
StrandPoints helixStrand(double radius, double pitch, double length, int edges);
/// A part of a circle in the plane of X and Y that begins downwards and bends towards X.
StrandPoints arcStrand(double curvature, double length, int edges);

float anyNumber(std::mt19937& random);  ///< -1 to 1
/// From `direction` on each edge goes the way of the last, with up to `kink` more or less along each axis.
StrandPoints kinkedStrand(const Vec3& root, Vec3 direction, float length, int edges, float kink,
                          std::mt19937& random);

/// Length at which a strand of this material has the gravito-bending number gamma = 4 rho g L^3 / (E R^2).
double lengthOfGamma(double gamma, const Material& material);
/// Bending stiffness over mass per length, m^4/s^2.
double bendingOverMass(const Material& material);

/// One groom of strands that each have their own material.
StrandModel modelOf(const std::vector<StrandPoints>& strands, const std::vector<Material>& materials);
StrandModel modelOf(const std::vector<StrandPoints>& strands, const Material& material = {});

constexpr float kHeadRadius = 0.1f;  ///< m
/// Hair that stands out of the upper half of a head and a little below, evenly (Fibonacci's spiral); `bend`:
/// how much it turns downwards. The head's middle is the origin.
StrandModel headOfHair(int strands, double length, int edges, double bend);
/// That head.
RigidBody headBody();

constexpr double kGravity = 9.81;  ///< m/s^2, of every experiment that has any

}  // namespace strandcast
