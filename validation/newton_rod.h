#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "core/parameters.h"
#include "core/strand_model.h"

namespace strandcast {

/// One strand as an inextensible Kirchhoff rod, each step solved to rounding: the reference for the dynamics
/// of the solvers. Model and joint law are those of the solver `rod`; the method is independent. Unknowns are
/// a rotation and a transmitted force per edge (a block-tridiagonal system with 6 x 6 blocks). Newton's
/// method iterates to convergence. Time integration is the second-order backward difference formula. There
/// are no bodies, no internal damping, and no pinned vertex but the root.
class NewtonRod {
 public:
  /// Starts with the rest shape of strand `strand` at `root`, without velocity. Throws Error where the model
  /// or the parameters need features that this solver lacks.
  NewtonRod(const StrandModel& model, size_t strand, const Parameters& parameters, const Pose& root);

  /// Sets parameters; the motion continues from the current positions and velocities.
  void setParameters(const Parameters& parameters);

  /// Advances by Parameters::time_step in Parameters::substeps. The pose of the root is interpolated as in
  /// the solvers. Throws Error when Newton's method does not converge.
  void step(const Pose& root_begin, const Pose& root_end);

  const std::vector<Eigen::Vector3d>& positions() const { return position_; }   ///< per vertex, metres, world
  const std::vector<Eigen::Vector3d>& velocities() const { return velocity_; }  ///< per vertex, m/s, world
  int iterations() const { return iterations_; }  ///< iterations of Newton's method in the last substep

 private:
  using Vector3 = Eigen::Vector3d;
  using Matrix3 = Eigen::Matrix3d;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  /// Unknowns of a substep. Positions follow from the frames.
  struct Unknowns {
    std::vector<Eigen::Quaterniond> frame;  ///< per edge
    std::vector<Vector3> force;  ///< per edge, m/s^2: force of the edge on its inner vertex; its component
                                 ///< along the edge is the tension
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
  bool has_history_ = false;  ///< false: the next substep is implicit Euler

  // State of the substep in progress.
  Eigen::Quaterniond root_frame_ = Eigen::Quaterniond::Identity();
  std::vector<Vector3> inertial_;  ///< per vertex, m: position without the forces of its edges
  std::vector<double> mobility_;   ///< per vertex, s^2: position per force; 0 at the root
  int iterations_ = 0;
};

}  // namespace strandcast
