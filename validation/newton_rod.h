#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "core/parameters.h"
#include "core/strand_model.h"

namespace strandcast {

/// One strand as an inextensible Kirchhoff rod, each step solved to rounding: what the dynamics of the
/// solvers are held against. Same model and joint law as the solver `rod`, everything else is another way:
/// per edge a rotation and the force it transmits are unknown together (a block-tridiagonal system with 6 x 6
/// blocks), Newton's method iterates to convergence, and time is integrated by the second-order backward
/// difference formula. No bodies, no internal damping, no vertex pinned but the root.
class NewtonRod {
 public:
  /// The rest shape of strand `strand` at `root`, at rest. Throws Error where the model or the parameters ask
  /// for what this solver does not have.
  NewtonRod(const StrandModel& model, size_t strand, const Parameters& parameters, const Pose& root);

  /// From now on; the motion goes on from the present positions and velocities.
  void setParameters(const Parameters& parameters);

  /// Advances by Parameters::time_step in Parameters::substeps; the root goes from one pose to the other as
  /// the solvers interpolate it. Throws Error when Newton's method does not converge.
  void step(const Pose& root_begin, const Pose& root_end);

  const std::vector<Eigen::Vector3d>& positions() const { return position_; }   ///< per vertex, metres, world
  const std::vector<Eigen::Vector3d>& velocities() const { return velocity_; }  ///< per vertex, m/s, world
  int iterations() const { return iterations_; }  ///< of Newton's method in the last substep

 private:
  using Vector3 = Eigen::Vector3d;
  using Matrix3 = Eigen::Matrix3d;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  /// What a substep solves for: positions follow from the frames.
  struct Unknowns {
    std::vector<Eigen::Quaterniond> frame;  ///< per edge
    std::vector<Vector3>
        force;  ///< per edge, m/s^2: what it exerts on its inner vertex; the tension acts along it
  };

  void substep(const Vector3& root, const Eigen::Quaterniond& root_frame);
  Vector3 tangent(const Unknowns& at, size_t e) const { return at.frame[e] * Vector3::UnitZ(); }
  double residual(const Unknowns& at, std::vector<Vector6>& r) const;
  void newtonStep(const Unknowns& at, const std::vector<Vector6>& r, std::vector<Vector6>& step) const;
  Vector3 moment(const Unknowns& at, size_t j) const;
  void momentDerivatives(const Unknowns& at, size_t j, Matrix3& to_inner, Matrix3& to_outer) const;
  Parameters parameters_;
  std::vector<double> length_, bend_, twist_, mass_;  ///< as in StrandModel
  std::vector<Vector3> rest_strain_;

  std::vector<Vector3> position_, velocity_;
  std::vector<Vector3> position_before_, velocity_before_;  ///< one substep earlier
  Unknowns state_;
  bool has_history_ = false;  ///< else the next substep is one of implicit Euler

  // Of the substep in progress.
  Eigen::Quaterniond root_frame_ = Eigen::Quaterniond::Identity();
  std::vector<Vector3> inertial_;  ///< per vertex, m: where it would be without the forces of its edges
  std::vector<double> mobility_;   ///< per vertex, s^2: position per force; 0 at the root
  int iterations_ = 0;
};

}  // namespace strandcast
