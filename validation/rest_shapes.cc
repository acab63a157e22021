#include "validation/rest_shapes.h"

#include <Eigen/Core>
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <Eigen/QR>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "validation/shooting.h"

namespace strandcast {
namespace {

// psi: angle of the tangent from the vertical. Over the distance u from the tip psi' = m / b, m' = (force +
// alpha) sin psi, with moment m, stiffness b and force = weight beyond u, relative to their values at the
// clamp. Measured from the vertical, the tip angle of a heavy rod keeps its relative precision near 0.
using State = Eigen::Vector4d;  // psi, m, drop, reach

State atClamp(double gamma, double alpha, const ElasticaStep& step, double tip_angle) {
  State y(tip_angle, 0, 0, 0);
  const double outer = 1 - step.place;
  // force(u): weight beyond; u is counted from `from`
  auto follow = [&](double from, double to, double stiffness, auto force) {
    const int steps = static_cast<int>(std::ceil(2000 * (to - from)));
    const double h = (to - from) / steps;
    for (int i = 0; i < steps; ++i)
      y = rungeKuttaStep(i * h, y, h, [&](double u, const State& at) {
        return State(at[1] / stiffness, (gamma * force(u) + alpha) * std::sin(at[0]), std::cos(at[0]),
                     std::sin(at[0]));
      });
  };
  const double at_tip = step.weight + step.weight_growth;
  auto beyond = [&](double u) { return u * (at_tip - step.weight_growth * u / (2 * outer)); };
  follow(0, outer, step.stiffness, beyond);
  const double outer_weight = outer > 0 ? beyond(outer) : 0;
  follow(outer, 1, 1, [&](double u) { return outer_weight + u; });
  return y;
}

}  // namespace

ElasticaTip restingElastica(double gamma, double alpha, const ElasticaStep& step) {
  constexpr double kHorizontal = std::numbers::pi / 2;
  const double tip_angle =
      shootFromTip(kHorizontal, [&](double angle) { return atClamp(gamma, alpha, step, angle)[0]; });
  const State clamp = atClamp(gamma, alpha, step, tip_angle);
  return {clamp[2], clamp[3]};
}

namespace {

using PressedState =
    Eigen::Vector4d;  // angle from the vertical, its derivative, position sideways, position down

// theta'' = -N sin theta - T cos theta over the length from the clamp. `forces`: theta'(0), N, T.
PressedState alongRod(const Eigen::Vector3d& forces, double length) {
  constexpr int kSteps = 400;
  PressedState y(0, forces[0], 0, 0);
  for (int i = 0; i < kSteps; ++i)
    y = rungeKuttaStep(length * i / kSteps, y, length / kSteps, [&](double, const PressedState& at) {
      return PressedState(at[1], -forces[1] * std::sin(at[0]) - forces[2] * std::cos(at[0]), std::sin(at[0]),
                          std::cos(at[0]));
    });
  return y;
}

Eigen::Vector3d missed(const Eigen::Vector3d& forces, double height) {
  const PressedState tip = alongRod(forces, 1);
  return {tip[1], tip[2], tip[3] - height};
}

}  // namespace

PressedElastica pressedElastica(double shortening, int edges) {
  // Start of the continuation: the first buckling mode of a clamped-hinged column, tan k = k.
  constexpr double kBuckling = 4.493409457909064, kStep = 0.0025;
  const double first = std::min(shortening, kStep);
  const double size = 2 * std::sqrt(first);  // amplitude of the angle, a sufficient first guess
  Eigen::Vector3d forces(size * kBuckling, kBuckling * kBuckling, -size * kBuckling);
  for (double at = first;; at = std::min(at + kStep, shortening)) {
    for (int iteration = 0;; ++iteration) {
      const Eigen::Vector3d off = missed(forces, 1 - at);
      if (off.norm() < 1e-10) break;
      if (iteration == 50) throw Error("no shape in balance", "pressedElastica", "press less");
      Eigen::Matrix3d slope;
      for (int c = 0; c < 3; ++c) {
        Eigen::Vector3d nudged = forces;
        nudged[c] += 1e-6;
        slope.col(c) = (missed(nudged, 1 - at) - off) / 1e-6;
      }
      const Eigen::Vector3d step = slope.fullPivLu().solve(off);
      forces -= step * std::min(1.0, 2 / step.norm());
    }
    if (at == shortening) break;
  }
  PressedElastica out{forces[1], forces[2], {}};
  for (int i = 0; i <= edges; ++i) {
    const PressedState point = alongRod(forces, static_cast<double>(i) / edges);
    out.shape.emplace_back(static_cast<float>(point[2]), static_cast<float>(point[3]));
  }
  return out;
}

namespace {

constexpr double kAcross = std::numbers::pi / 2;

// psi: angle of the tangent (sin psi, cos psi) from the wind. Over the distance from the tip psi'' = t_x N_y
// - t_y N_x; the force N of the part beyond grows by the drag.
using WindState =
    Eigen::Matrix<double, 6, 1>;  // psi, psi', N across and downwind, position across and downwind

// State at the clamp, or where the strand turns against the wind before the clamp.
WindState atClamp(double load, double ratio, double tip_angle) {
  constexpr int kSteps = 2000;
  WindState y = WindState::Zero();
  y[0] = tip_angle;
  for (int i = 0; i < kSteps && y[0] <= kAcross; ++i)
    y = rungeKuttaStep(static_cast<double>(i) / kSteps, y, 1.0 / kSteps, [&](double, const WindState& at) {
      const double s = std::sin(at[0]), c = std::cos(at[0]);
      WindState slope;
      slope << at[1], s * at[3] - c * at[2], -load * (1 - ratio) * s * c, load * (s * s + ratio * c * c), s,
          c;
      return slope;
    });
  return y;
}

}  // namespace

WindElasticaTip windElastica(double load, double along_over_across) {
  const double tip_angle =
      shootFromTip(kAcross, [&](double angle) { return atClamp(load, along_over_across, angle)[0]; });
  const WindState clamp = atClamp(load, along_over_across, tip_angle);
  return {clamp[5], clamp[4]};
}

double catenarySag(double span) {
  // y = c cosh(x / c), with u = span / (2 c): length 1 = 2 c sinh(u), so sinh(u) / u = 1 / span, and the sag
  // is c (cosh(u) - 1) = tanh(u / 2) / 2.
  double low = 1e-9, high = 700;
  for (int i = 0; i < 80; ++i) {
    const double u = (low + high) / 2;
    (std::sinh(u) / u > 1 / span ? high : low) = u;
  }
  return std::tanh(low / 2) / 2;
}

namespace {

using Eigen::Vector3d;
// State: moment M and direction of gravity G in the material frame, and the depth above the tip.
using RodState = Eigen::Matrix<double, 7, 1>;

constexpr int kRodSteps = 600;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Vector3d darboux(const HungRod& rod, const Vector3d& moment) {
  return {moment.x(), rod.curvature + moment.y(), rod.torsion + moment.z() / rod.twist_ratio};
}

// Integrates from the tip, where the moment is 0 and gravity is `down` in the material frame, to the root.
// Over the distance u from the tip: M' = e3 x F - M x W, G' = W x G, with the force F = gamma u G and the
// Darboux vector W.
RodState atRoot(const HungRod& rod, const Vector3d& down) {
  RodState y;
  y << Vector3d::Zero(), down, 0;
  for (int i = 0; i < kRodSteps; ++i)
    y = rungeKuttaStep(
        static_cast<double>(i) / kRodSteps, y, 1.0 / kRodSteps, [&](double u, const RodState& at) {
          const Vector3d m = at.head<3>(), g = at.segment<3>(3), w = darboux(rod, m);
          RodState slope;
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
    for (; step < kRodSteps && y[0] > 0 && y[0] < 4; ++step)
      y = rungeKuttaStep(static_cast<double>(step) / kRodSteps, y, 1.0 / kRodSteps,
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
  const RodState root = atRoot(rod, tip);
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
