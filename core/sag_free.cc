#include "core/sag_free.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "core/error.h"
#include "core/parameters.h"
#include "core/rod_elasticity.h"

namespace strandcast {
namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

/// One strand in its root frame. Entry e is edge e and the joint before it.
class Strand {
 public:
  struct Joint {
    Eigen::Quaterniond inner;  ///< frame before the joint
    Vector strain;             ///< in `inner`
    Vector answer;             ///< K x (strain - rest strain) that balances the weight, in `inner`
    Vector moment;             ///< of the weight beyond the joint, in the root frame
    Vector stiffness;          ///< K: bending, bending, twist, m^2/s^2
  };
  std::vector<Joint> joints;
  std::vector<Vector> edges, pulls;  ///< l t, m; W, m/s^2; see makeSagFree()

  void read(const StrandModel& model, size_t s, const Vec3& gravity);
  /// Computes the second variations. Call it before stable(), after the last change of the joints' stiffness.
  void linearise();
  /// Whether the second variation of elastic energy and weight by rotations of the edges is positive
  /// definite, with all stiffness multiplied by `factor`.
  bool stable(double factor);

 private:
  std::vector<Matrix> elastic_, geometric_, weight_;  ///< second variations: of joints, of joints, of edges
};

void Strand::read(const StrandModel& model, size_t s, const Vec3& gravity) {
  const uint32_t first = model.offsets[s];
  const size_t count = model.verticesOf(s) - 1;
  const Vector g = (model.rest_roots[s].rotation.conjugate() * gravity).cast<double>();
  joints.resize(count);
  edges.resize(count);
  pulls.resize(count);
  Vector pull = Vector::Zero(), moment = Vector::Zero();
  for (size_t e = count; e-- > 0;) {
    const uint32_t v = first + static_cast<uint32_t>(e);
    if (model.isPinned(s, v + 1))
      pull.setZero();
    else
      pull += g * model.mass[v + 1];
    edges[e] = (model.rest_local[v + 1] - model.rest_local[v]).cast<double>();
    pulls[e] = pull;
    moment += edges[e].cross(pull);

    Joint& joint = joints[e];
    joint.inner = e > 0 ? model.rest_frames[v - 1].cast<double>() : Eigen::Quaterniond::Identity();
    const Eigen::Quaterniond outer = model.rest_frames[v].cast<double>();
    joint.strain = strainOfJoint(joint.inner, outer);
    joint.moment = moment;
    joint.stiffness = Vector(model.bend[v], model.bend[v], model.twist[v]);
    // jointMoment() in kernels/rod.h is c + (strain / 2) x c; this solves it for c.
    const Vector m = joint.inner.conjugate() * moment, u = joint.strain / 2;
    joint.answer = (m + u * u.dot(m) - u.cross(m)) / (1 + u.squaredNorm());
  }
}

void Strand::linearise() {
  auto symmetric = [](const Matrix& m) -> Matrix { return 0.5 * (m + m.transpose()); };
  elastic_.resize(joints.size());
  geometric_.resize(joints.size());
  weight_.resize(joints.size());
  for (size_t e = 0; e < joints.size(); ++e) {
    const Joint& joint = joints[e];
    const Matrix frame = joint.inner.toRotationMatrix();
    const JointDerivative answer = jointDerivative(joint.strain, joint.answer, joint.stiffness);
    elastic_[e] = frame * symmetric(answer.elastic) * frame.transpose();
    geometric_[e] = frame * symmetric(answer.geometric) * frame.transpose();
    weight_[e] = edges[e].dot(pulls[e]) * Matrix::Identity() - symmetric(pulls[e] * edges[e].transpose());
  }
}

bool Strand::stable(double factor) {
  auto joint = [&](size_t e) -> Matrix { return factor * elastic_[e] + geometric_[e]; };
  size_t e = joints.size() - 1;
  Matrix outer = joint(e);
  Matrix diagonal = weight_[e] + outer;
  for (;; --e) {
    // Positive definite: its leading minors are positive.
    const double minor = diagonal(0, 0) * diagonal(1, 1) - diagonal(0, 1) * diagonal(1, 0);
    if (!(diagonal(0, 0) > 0 && minor > 0 && diagonal.determinant() > 0)) return false;
    if (e == 0) return true;
    // Two successive rotation vectors compose to their sum plus half their cross product, to second order.
    const Matrix coupling = -outer - 0.5 * crossMatrix(joints[e].moment);
    const Matrix inner = joint(e - 1);
    diagonal = (weight_[e - 1] + outer + inner - coupling.transpose() * diagonal.inverse() * coupling).eval();
    outer = inner;
  }
}

}  // namespace

SagFreeReport makeSagFree(StrandModel& model, const Vec3& gravity,
                          const std::function<bool(double part)>& progress) {
  if (!(gravity.cwiseAbs().array() <= kStrongestGravity).all())
    throw Error("gravity is not finite or out of range", "makeSagFree",
                fmt::format("give three numbers within +-{:g} m/s^2", kStrongestGravity));
  constexpr double kGrowth = 1.5;                 // of a strand's factor per trial
  constexpr size_t kStrandsPerProgressCall = 64;  // strands per call of `progress`
  std::vector<float> factors(model.strands());
  std::atomic<bool> goes_on{true};
  auto work = [&](size_t begin, size_t end, bool is_first) {
    Strand strand;
    for (size_t s = begin; s < end && goes_on; ++s) {
      if (is_first && progress && (s - begin) % kStrandsPerProgressCall == 0)
        goes_on = progress(static_cast<double>(s - begin) / static_cast<double>(end - begin));
      strand.read(model, s, gravity);
      double largest = 1;
      for (Strand::Joint& joint : strand.joints) {
        const double change = joint.answer.cwiseQuotient(joint.stiffness).norm();
        const double factor = std::max(1.0, change / kLargestChange);
        joint.stiffness *= factor;
        largest = std::max(largest, factor);
      }
      strand.linearise();
      double whole = 1;
      while (whole <= kMaxStiffening && !strand.stable(whole / kWeightHeld)) whole *= kGrowth;
      factors[s] = static_cast<float>(whole <= kMaxStiffening ? largest * whole : -1);
      for (size_t e = 0; e < strand.joints.size(); ++e) {
        const uint32_t v = model.offsets[s] + static_cast<uint32_t>(e);
        const Strand::Joint& joint = strand.joints[e];
        const Vector stiffness = joint.stiffness * whole;
        model.bend[v] = static_cast<float>(stiffness.x());
        model.twist[v] = static_cast<float>(stiffness.z());
        model.rest_strain[v] = (joint.strain - joint.answer.cwiseQuotient(stiffness)).cast<float>();
        model.rest_tension[v] = static_cast<float>(strand.edges[e].normalized().dot(strand.pulls[e]));
      }
    }
  };
  const size_t parts = std::clamp<size_t>(std::thread::hardware_concurrency(), 1, 1 + model.strands() / 256);
  std::vector<std::thread> others;
  for (size_t part = 1; part < parts; ++part)
    others.emplace_back(work, model.strands() * part / parts, model.strands() * (part + 1) / parts, false);
  work(0, model.strands() / parts, true);
  for (std::thread& other : others) other.join();

  SagFreeReport report;
  for (size_t s = 0; s < factors.size(); ++s) {
    if (factors[s] < 0) report.unstable.push_back(static_cast<uint32_t>(s));
    if (factors[s] > 1) report.stiffened.push_back(static_cast<uint32_t>(s));
    if (factors[s] <= report.largest_factor) continue;
    report.largest_factor = factors[s];
    report.stiffest = static_cast<uint32_t>(s);
  }
  return report;
}

}  // namespace strandcast
