#include "validation/newton_rod.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/rod_elasticity.h"

namespace strandcast {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
namespace f64 = kernels::f64;

constexpr int kMaxIterations = 60;
constexpr int kMaxHalvings = 30;
// Tolerance of the residual, relative to lengths and stiffnesses: a few roundings of the largest terms.
constexpr double kTolerance = 1e-11;

Quaterniond rotationOf(const Vector3d& turn) {
  const double angle = turn.norm();
  if (angle < 1e-300) return Quaterniond::Identity();
  return Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
}

}  // namespace

NewtonRod::NewtonRod(const StrandModel& model, size_t strand, const Parameters& parameters,
                     const Pose& root) {
  const uint32_t first = model.offsets[strand], n = static_cast<uint32_t>(model.verticesOf(strand));
  const Quaterniond rotation = root.rotation.cast<double>().normalized();
  for (uint32_t i = 0; i < n; ++i) {
    if (i > 0 && model.isPinned(strand, first + i))
      throw Error(fmt::format("vertex {} is pinned, this solver holds only the root", i),
                  fmt::format("strand {}", strand), "take a strand without pinned vertices");
    mass_.push_back(model.mass[first + i]);
    position_.push_back(root.position.cast<double>() + rotation * model.rest_local[first + i].cast<double>());
    if (i + 1 == n) break;
    bend_.push_back(model.bend[first + i]);
    twist_.push_back(model.twist[first + i]);
    rest_strain_.push_back(model.rest_strain[first + i].cast<double>());
    length_.push_back((model.rest_local[first + i + 1] - model.rest_local[first + i]).cast<double>().norm());
    state_.frame.push_back((rotation * model.rest_frames[first + i].cast<double>()).normalized());
    state_.force.push_back(Vector3::Zero());
  }
  velocity_.assign(n, Vector3::Zero());
  inertial_.resize(n);
  mobility_.resize(n);
  setParameters(parameters);
}

void NewtonRod::setParameters(const Parameters& parameters) {
  if (parameters.damping_time != 0)
    throw Error("this solver has no internal damping", "damping_time", "set it to 0");
  parameters_ = parameters;
  has_history_ = false;
}

void NewtonRod::step(const Pose& root_begin, const Pose& root_end) {
  const Vector3 from = root_begin.position.cast<double>(), to = root_end.position.cast<double>();
  const f64::quat frame_from = toLanes(root_begin.rotation.cast<double>().normalized());
  const f64::quat frame_to = toLanes(root_end.rotation.cast<double>().normalized());
  for (int s = 1; s <= parameters_.substeps; ++s) {
    const double time = static_cast<double>(s) / parameters_.substeps;
    const f64::quat q = f64::interpolateRotation(frame_from, frame_to, time);
    substep(from + time * (to - from), Quaterniond(q.w, q.x, q.y, q.z));
  }
}

// Backward differences: v = (a0 x + a1 x_before + a2 x_before2) / h, and the acceleration from v likewise.
// Second order (3/2, -2, 1/2) with history, first order (1, -1, 0) without.
void NewtonRod::substep(const Vector3& root, const Quaterniond& root_frame) {
  const double h = static_cast<double>(parameters_.time_step) / parameters_.substeps;
  const double a0 = has_history_ ? 1.5 : 1, a1 = has_history_ ? -2 : -1, a2 = has_history_ ? 0.5 : 0;
  const Vector3 gravity = parameters_.gravity.cast<double>(), wind = parameters_.wind.cast<double>();
  const double drag = parameters_.air_drag;
  if (!has_history_) {
    position_before_ = position_;
    velocity_before_ = velocity_;
  }
  const double scale = a0 * (a0 + drag * h);  // factor of x / h^2 in acceleration plus drag
  root_frame_ = root_frame;
  inertial_[0] = root;
  mobility_[0] = 0;
  for (size_t i = 1; i < position_.size(); ++i) {
    const Vector3 past_x = a1 * position_[i] + a2 * position_before_[i];
    const Vector3 past_v = a1 * velocity_[i] + a2 * velocity_before_[i];
    inertial_[i] = (h * h * (gravity + drag * wind) - h * past_v - (a0 + drag * h) * past_x) / scale;
    mobility_[i] = h * h / (scale * mass_[i]);
  }

  std::vector<Vector6> r, r_trial, change;
  double error = residual(state_, r);
  bool stalled = false;
  for (iterations_ = 0; error > kTolerance && !stalled; ++iterations_) {
    if (iterations_ == kMaxIterations)
      throw Error(fmt::format("Newton's method stands at a residual of {:.3g} after {} iterations", error,
                              kMaxIterations),
                  "NewtonRod::step", "take a smaller time step");
    newtonStep(state_, r, change);
    double part = 1;
    for (int halving = 0;; ++halving) {
      Unknowns trial = state_;
      for (size_t e = 0; e < length_.size(); ++e) {
        trial.frame[e] = (rotationOf(part * change[e].head<3>()) * trial.frame[e]).normalized();
        trial.force[e] += part * change[e].tail<3>();
      }
      const double trial_error = residual(trial, r_trial);
      if (trial_error < error) {
        state_ = std::move(trial);
        r.swap(r_trial);
        error = trial_error;
        break;
      }
      if (halving == kMaxHalvings) {
        stalled = true;
        break;
      }
      part *= 0.5;
    }
  }
  if (stalled && error > 1e3 * kTolerance)
    throw Error(fmt::format("Newton's method finds no descent at a residual of {:.3g}", error),
                "NewtonRod::step", "take a smaller time step");

  std::vector<Vector3> x(position_.size());
  x[0] = root;
  for (size_t e = 0; e < length_.size(); ++e) x[e + 1] = x[e] + length_[e] * tangent(state_, e);
  for (size_t i = 0; i < x.size(); ++i) {
    const Vector3 v = (a0 * x[i] + a1 * position_[i] + a2 * position_before_[i]) / h;
    position_before_[i] = position_[i];
    velocity_before_[i] = velocity_[i];
    position_[i] = x[i];
    velocity_[i] = v;
  }
  has_history_ = true;
}

Eigen::Vector3d NewtonRod::moment(const Unknowns& at, size_t j) const {
  const Quaterniond& inner = j > 0 ? at.frame[j - 1] : root_frame_;
  const Vector3 u = strainOfJoint(inner, at.frame[j]);
  return fromLanes(
      f64::jointMoment(toLanes(inner), toLanes(u), toLanes(u - rest_strain_[j]), bend_[j], twist_[j]));
}

// Derivatives of moment(j) with respect to rotations (world frame, from the left) of the inner and the outer
// frame.
void NewtonRod::momentDerivatives(const Unknowns& at, size_t j, Matrix3& to_inner, Matrix3& to_outer) const {
  const Quaterniond& inner = j > 0 ? at.frame[j - 1] : root_frame_;
  const Vector3 u = strainOfJoint(inner, at.frame[j]);
  const Vector3 stiffness(bend_[j], bend_[j], twist_[j]);
  const Vector3 c = stiffness.cwiseProduct(u - rest_strain_[j]);
  const JointDerivative answer = jointDerivative(u, c, stiffness);
  const Matrix3 a = inner.toRotationMatrix();
  to_outer = a * (answer.elastic + answer.geometric) * a.transpose();
  to_inner = -to_outer - crossMatrix(a * (c + 0.5 * u.cross(c)));
}

// Residual per edge: the sum of moments, and the difference of its end positions less the edge vector.
// Returns the largest entry, moments relative to the stiffest joint, lengths relative to the edge.
double NewtonRod::residual(const Unknowns& at, std::vector<Vector6>& r) const {
  const size_t edges = length_.size();
  r.resize(edges);
  const double stiffest = *std::max_element(bend_.begin(), bend_.end());
  auto place = [&](size_t i) -> Vector3 {
    Vector3 force = i < edges ? at.force[i] : Vector3(Vector3::Zero());
    if (i > 0) force -= at.force[i - 1];
    return inertial_[i] + mobility_[i] * force;
  };
  double largest = 0;
  Vector3 m = moment(at, 0), x = place(0);
  for (size_t e = 0; e < edges; ++e) {
    const Vector3 m_out = e + 1 < edges ? moment(at, e + 1) : Vector3(Vector3::Zero());
    const Vector3 edge = length_[e] * tangent(at, e), x_out = place(e + 1);
    r[e] << m_out - m + edge.cross(at.force[e]), x_out - x - edge;
    largest = std::max({largest, r[e].head<3>().norm() / stiffest, r[e].tail<3>().norm() / length_[e]});
    m = m_out;
    x = x_out;
  }
  return largest;
}

// Solves (derivative of the residual) step = -r by block elimination from root to tip.
void NewtonRod::newtonStep(const Unknowns& at, const std::vector<Vector6>& r,
                           std::vector<Vector6>& step) const {
  const size_t edges = length_.size();
  step.resize(edges);
  std::vector<Matrix6> factor(edges);  // factor of the next edge's unknowns
  Matrix3 inner, outer, inner_next = Matrix3::Zero(), outer_next = Matrix3::Zero();
  momentDerivatives(at, 0, inner, outer);
  for (size_t e = 0; e < edges; ++e) {
    Matrix6 diagonal = Matrix6::Zero(), before = Matrix6::Zero(), after = Matrix6::Zero();
    const Matrix3 turn = length_[e] * crossMatrix(tangent(at, e));
    diagonal.topLeftCorner<3, 3>() = crossMatrix(at.force[e]) * turn - outer;
    diagonal.topRightCorner<3, 3>() = turn;
    diagonal.bottomLeftCorner<3, 3>() = turn;
    diagonal.bottomRightCorner<3, 3>() = -(mobility_[e] + mobility_[e + 1]) * Matrix3::Identity();
    before.topLeftCorner<3, 3>() = -inner;
    before.bottomRightCorner<3, 3>() = mobility_[e] * Matrix3::Identity();
    if (e + 1 < edges) {
      momentDerivatives(at, e + 1, inner_next, outer_next);
      diagonal.topLeftCorner<3, 3>() += inner_next;
      after.topLeftCorner<3, 3>() = outer_next;
      after.bottomRightCorner<3, 3>() = mobility_[e + 1] * Matrix3::Identity();
    }
    Vector6 right = -r[e];
    if (e > 0) {
      diagonal -= before * factor[e - 1];
      right -= before * step[e - 1];
    }
    const Eigen::PartialPivLU<Matrix6> lu(diagonal);
    factor[e] = lu.solve(after);
    step[e] = lu.solve(right);
    inner = inner_next;
    outer = outer_next;
  }
  for (size_t e = edges - 1; e-- > 0;) step[e] -= factor[e] * step[e + 1];
}

}  // namespace strandcast
