#include "validation/hung_rod.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "validation/runge_kutta.h"

namespace strandcast {
namespace {

using Eigen::Vector3d;
// Moment M, direction of gravity G, both in the material frame, and the depth passed since the tip.
using State = Eigen::Matrix<double, 7, 1>;

constexpr int kSteps = 600;

Vector3d darboux(const HungRod& rod, const Vector3d& moment) {
  return {moment.x(), rod.curvature + moment.y(), rod.torsion + moment.z() / rod.twist_ratio};
}

// From the tip, free of moment and with gravity along `down` in its material frame, to the root. Over the
// distance u from the tip: M' = e3 x F - M x W, G' = W x G with the force F = gamma u G and the Darboux
// vector W.
State atRoot(const HungRod& rod, const Vector3d& down) {
  State y;
  y << Vector3d::Zero(), down, 0;
  for (int i = 0; i < kSteps; ++i)
    y = rungeKuttaStep(static_cast<double>(i) / kSteps, y, 1.0 / kSteps, [&](double u, const State& at) {
      const Vector3d m = at.head<3>(), g = at.segment<3>(3), w = darboux(rod, m);
      State slope;
      slope << Vector3d::UnitZ().cross(g) * (rod.gamma * u) - m.cross(w), w.cross(g), g.z();
      return slope;
    });
  return y;
}

// Gravity's direction at the tip as it is at rest without weight.
Vector3d tipAtNoWeight(const HungRod& rod) {
  const Vector3d w = darboux(rod, Vector3d::Zero());
  if (w.norm() == 0) return rod.down;
  return Eigen::AngleAxisd(-w.norm(), w.normalized()) * rod.down;
}

// How gravity's direction at the root changes with that at the tip, in the tangent planes of both: `across`
// and the direction that completes it to a right-handed frame.
struct Tangents {
  Vector3d first, second;
  Tangents(const Vector3d& normal, const Vector3d& across)
      : first((across - normal * normal.dot(across)).normalized()), second(normal.cross(first)) {}
};
Eigen::Matrix2d sensitivity(const HungRod& rod, const Vector3d& tip, const Tangents& at_tip,
                            const Tangents& root) {
  constexpr double kSmall = 1e-5;
  Eigen::Matrix2d out;
  for (int k = 0; k < 2; ++k) {
    const Vector3d turn = (k == 0 ? at_tip.first : at_tip.second) * kSmall;
    const Vector3d change = (atRoot(rod, (tip + turn).normalized()).segment<3>(3) -
                             atRoot(rod, (tip - turn).normalized()).segment<3>(3)) /
                            (2 * kSmall);
    out.col(k) << change.dot(root.first), change.dot(root.second);
  }
  return out;
}

// Newton's method on the direction of gravity at the tip, so that it is `rod.down` at the root.
Vector3d solveTip(const HungRod& rod, Vector3d tip, const Vector3d& across) {
  const Tangents root(rod.down, across);
  for (int i = 0; i < 20; ++i) {
    const Vector3d miss = rod.down - atRoot(rod, tip).segment<3>(3);
    if (miss.norm() < 1e-11) break;
    const Tangents at_tip(tip, across);
    const Eigen::Vector2d turn = sensitivity(rod, tip, at_tip, root)
                                     .fullPivLu()
                                     .solve(Eigen::Vector2d(miss.dot(root.first), miss.dot(root.second)));
    tip = (tip + at_tip.first * turn[0] + at_tip.second * turn[1]).normalized();
  }
  return tip;
}

// The same for a rod that is curved in the plane of its first and third axis and clamped with its root
// downwards: the stable shape hangs straight but for a hook at the tip. Its angle from the vertical falls
// from the tip on, and where it comes to zero before the root the hook was too little open.
Vector3d planarTip(const HungRod& rod) {
  double low = 0, high = 3;
  for (int i = 0; i < 60; ++i) {
    const double angle = (low + high) / 2;
    Eigen::Vector2d y(angle, -rod.curvature);
    int step = 0;
    for (; step < kSteps && y[0] > 0 && y[0] < 4; ++step)
      y = rungeKuttaStep(static_cast<double>(step) / kSteps, y, 1.0 / kSteps,
                         [&](double u, const Eigen::Vector2d& at) {
                           return Eigen::Vector2d(at[1], rod.gamma * u * std::sin(at[0]));
                         });
    (y[0] > 0 ? high : low) = angle;
  }
  return {-std::sin(low), 0, std::cos(low)};
}

}  // namespace

double hangingDepth(const HungRod& rod) {
  const Vector3d across(1, 0, 0);
  HungRod now = rod;
  now.gamma = 0;
  Vector3d tip = tipAtNoWeight(rod);
  while (now.gamma < rod.gamma) {
    now.gamma = std::fmin(rod.gamma, now.gamma * 1.1 + 0.5);
    tip = solveTip(now, tip, across);
  }
  return atRoot(rod, tip)[6];
}

double bendTwistThreshold(double phi, double twist_ratio) {
  HungRod rod;
  rod.curvature = phi;
  rod.twist_ratio = twist_ratio;
  auto staysPlanar = [&](double gamma) {
    rod.gamma = gamma;
    // All that points out of the plane is exactly zero for the planar shape, so a tiny push keeps its digits.
    constexpr double kPush = 1e-13;
    return atRoot(rod, planarTip(rod) + Vector3d(0, kPush, 0))[4] > 0;
  };
  double high = 0.25 * phi * phi * phi + 20;  // more than at any threshold of a rod that is not short
  while (staysPlanar(high)) high *= 0.97;
  double low = high;
  high /= 0.97;
  for (int i = 0; i < 30; ++i) {
    const double gamma = (low + high) / 2;
    (staysPlanar(gamma) ? high : low) = gamma;
  }
  return low;
}

}  // namespace strandcast
