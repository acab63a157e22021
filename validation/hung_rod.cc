#include "validation/hung_rod.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>
#include <limits>

#include "validation/runge_kutta.h"

namespace strandcast {
namespace {

using Eigen::Vector3d;
// State: moment M and direction of gravity G in the material frame, and the depth above the tip.
using State = Eigen::Matrix<double, 7, 1>;

constexpr int kSteps = 600;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Vector3d darboux(const HungRod& rod, const Vector3d& moment) {
  return {moment.x(), rod.curvature + moment.y(), rod.torsion + moment.z() / rod.twist_ratio};
}

// Integrates from the tip, where the moment is 0 and gravity is `down` in the material frame, to the root.
// Over the distance u from the tip: M' = e3 x F - M x W, G' = W x G, with the force F = gamma u G and the
// Darboux vector W.
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

// Direction of gravity at the tip of the weightless rod.
Vector3d tipAtNoWeight(const HungRod& rod) {
  const Vector3d w = darboux(rod, Vector3d::Zero());
  if (w.norm() == 0) return rod.down;
  return Eigen::AngleAxisd(-w.norm(), w.normalized()) * rod.down;
}

// Newton's method for the direction of gravity at the tip that gives `rod.down` at the root.
Vector3d solveTip(const HungRod& rod, Vector3d tip) {
  constexpr double kSmall = 1e-5;  // rad, step of central differences
  auto root = [&](const Vector3d& at_tip) -> Vector3d {
    return atRoot(rod, at_tip.normalized()).segment<3>(3);
  };
  for (int i = 0; i < 20; ++i) {
    const Vector3d miss = rod.down - root(tip);
    if (miss.norm() < 1e-11) break;
    Eigen::Matrix<double, 3, 2> turns, change;
    turns.col(0) = tip.unitOrthogonal();
    turns.col(1) = tip.cross(turns.col(0));
    for (int k = 0; k < 2; ++k)
      change.col(k) = (root(tip + kSmall * turns.col(k)) - root(tip - kSmall * turns.col(k))) / (2 * kSmall);
    tip = (tip + turns * change.colPivHouseholderQr().solve(miss)).normalized();
  }
  return tip;
}

// Direction of gravity at the tip of a rod that is curved in the plane of its first and third axis and
// clamped with the root downwards. The stable planar shape hangs straight except for a hook at the tip. The
// angle from the vertical decreases from the tip to the root; where it reaches zero before the root, the
// assumed tip angle was too small.
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
  HungRod now = rod;
  now.gamma = 0;
  Vector3d tip = tipAtNoWeight(rod);
  while (now.gamma < rod.gamma) {
    now.gamma = std::fmin(rod.gamma, now.gamma * 1.1 + 0.5);
    tip = solveTip(now, tip);
  }
  const State root = atRoot(rod, tip);
  return (root.segment<3>(3) - rod.down).norm() < 1e-8 ? root[6] : kNone;
}

double bendTwistThreshold(double phi, double twist_ratio) {
  if (!(phi >= 6 && phi <= 16)) return kNone;
  HungRod rod;
  rod.curvature = phi;
  rod.twist_ratio = twist_ratio;
  auto staysPlanar = [&](double gamma) {
    rod.gamma = gamma;
    // Out-of-plane components of the planar shape are exactly 0, so a tiny perturbation keeps full precision.
    constexpr double kPush = 1e-13;
    return atRoot(rod, planarTip(rod) + Vector3d(0, kPush, 0))[4] > 0;
  };
  double high = 0.25 * phi * phi * phi + 20;  // above the threshold of any rod that is not short
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
