#include "light/fibre_table.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace strandcast {
namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;
using kernels::f64::FibreLobes;
using kernels::f64::FibreRay;

/// Values of absorption per radius at which tables hold lengths, see fibreKnot().
constexpr std::array<double, 4> kAbsorptionKnots{0, 2.0 / 3, 2, 6};

/// Nodes and weights of Gauss and Legendre on 0 to 1, by Newton's method.
struct GaussRule {
  ArrayXd nodes, weights;
  explicit GaussRule(int n) : nodes(n), weights(n) {
    for (int i = 0; i < n; ++i) {
      double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1;
      for (int step = 0; step < 6; ++step) {
        double p = 1, before = 0;
        for (int k = 1; k <= n; ++k) {
          const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
          before = p;
          p = next;
        }
        slope = n * (x * p - before) / (x * x - 1);
        x -= p / slope;
      }
      nodes[i] = 0.5 * (1 + x);
      weights[i] = 1 / ((1 - x * x) * slope * slope);
    }
  }
};

/// Fourier coefficients of the trimmed logistic distribution: its integrals with cos(k x), k = 0 to `count`
/// - 1.
ArrayXd logisticHarmonics(double s, int count) {
  constexpr int kPoints = 4096;
  ArrayXd harmonics = ArrayXd::Zero(count);
  for (int i = 0; i < kPoints; ++i) {
    const double x = std::numbers::pi * (i + 0.5) / kPoints;
    const double weight = kernels::f64::trimmedLogistic(x, s);
    if (weight < 1e-12) break;
    double now = weight, before = weight * std::cos(x);
    const double twice = 2 * std::cos(x);
    for (int k = 0; k < count; ++k) {
      harmonics[k] += now;
      const double next = twice * now - before;
      before = now;
      now = next;
    }
  }
  return harmonics * (2 * std::numbers::pi / kPoints);
}

/// Functions of phi per lobe with paths inside: N, its first moment of the length of paths, and N at the
/// knots above 0.
constexpr int kOfLobe = 5;

/// The distribution of the Fresnel reflectance F across the fibre in what longer paths carry without
/// absorption, as two nodes of Gauss, from its moments.
class ResidualNodes {
 public:
  void add(double weight, double fresnel, double length) {
    double moment = weight * (1 - fresnel) * fresnel * fresnel;
    length_ += moment * length;
    for (double& sum : moments_) {
      sum += moment;
      moment *= fresnel;
    }
  }
  /// The five numbers of FibreResidual.
  void write(float* numbers) const {
    const auto [m0, m1, m2, m3] = moments_;
    double share = 0.5, low = 1, high = 1;
    const double spread = m0 * m2 - m1 * m1;
    if (spread > 1e-12 * m0 * m0) {
      const double b = (m0 * m3 - m1 * m2) / spread, c = (b * m1 - m2) / m0;
      const double half = std::sqrt(std::max(0.25 * b * b - c, 0.0));
      low = std::clamp(0.5 * b - half, 0.0, 1.0);
      high = std::clamp(0.5 * b + half, 0.0, 1.0);
      share = (high - m1 / m0) / std::max(high - low, 1e-12);
    }
    numbers[0] = static_cast<float>(m0 / (2 * std::numbers::pi));
    numbers[1] = static_cast<float>(share);
    numbers[2] = static_cast<float>(low);
    numbers[3] = static_cast<float>(high);
    numbers[4] = static_cast<float>(m0 > 0 ? length_ / m0 : 2.0);
  }

 private:
  std::array<double, 4> moments_{};
  double length_ = 0;
};

/// The numbers of FibrePaths from functions of phi. `longest`: bound of lengths, which noise would exceed
/// where N is nearly 0.
void writePaths(const double* of_lobe, double longest, float* numbers) {
  const double n = std::max(of_lobe[0], 0.0), divisor = std::max(n, 1e-12);
  numbers[0] = static_cast<float>(n);
  numbers[1] = static_cast<float>(std::clamp(of_lobe[1] / divisor, 0.0, longest));
  for (int knot = 1; knot < 4; ++knot) {
    const double left = std::max(of_lobe[knot + 1] / divisor, 1e-300);
    numbers[knot + 1] = static_cast<float>(
        std::clamp(-std::log(left) / kAbsorptionKnots[static_cast<size_t>(knot)], 0.0, longest));
  }
}

}  // namespace

FibreTable::FibreTable(double azimuthal_roughness, double index, int rows, int columns,
                       std::optional<double> bending_index, Incidence incidence)
    : rows_(rows), columns_(columns), numbers_(static_cast<size_t>(rows * columns * kTexel)) {
  const double bending = bending_index.value_or(index);
  const double s = kernels::f64::logisticScale(std::max(azimuthal_roughness, kLeastRoughness));
  // The distribution's harmonics fall as exp(-pi k s): those left out are below 1e-4.
  const int harmonics = std::max(24, static_cast<int>(std::ceil(3.0 / s)));
  // An integrand of these harmonics is smooth in gamma_o, with h = sin(gamma_o).
  const GaussRule rule(harmonics + 32);
  const ArrayXd gammas = rule.nodes * (0.5 * std::numbers::pi);
  const ArrayXd weights = rule.weights * gammas.cos() * (0.5 * std::numbers::pi);
  const Eigen::Index points = weights.size();

  MatrixXd cosines(harmonics, columns_);  // times the coefficients of the Fourier series
  ArrayXd coefficients = logisticHarmonics(s, harmonics);
  if (incidence == Incidence::kHalfTurn)  // the mean of cos(k x) over half a turn about x
    for (int k = 1; k < harmonics; ++k)
      coefficients[k] *= std::sin(0.5 * std::numbers::pi * k) / (0.5 * std::numbers::pi * k);
  for (int k = 0; k < harmonics; ++k)
    for (int j = 0; j < columns_; ++j)
      cosines(k, j) = std::cos(std::numbers::pi * k * j / (columns_ - 1)) * coefficients[k] *
                      (k == 0 ? 0.5 : 1.0) / std::numbers::pi;

  ArrayXd of_r(points);
  MatrixXd of_tt(points, kOfLobe), of_trt(points, kOfLobe), series(1 + 2 * kOfLobe, harmonics);
  std::array<ArrayXd, 3> now, before, twice;  // cos(k Phi) of R, TT, TRT by Chebyshev's recurrence in k
  std::array<MatrixXd, 3> waves;
  for (MatrixXd& matrix : waves) matrix.resize(points, harmonics);
  for (auto* list : {&now, &before, &twice})
    for (ArrayXd& array : *list) array.resize(points);
  for (int row = 0; row < rows_; ++row) {
    const double cos_theta = row / (rows_ - 1.0), sin_theta = std::sqrt(1 - cos_theta * cos_theta);
    ResidualNodes residual;
    for (Eigen::Index i = 0; i < points; ++i) {
      FibreRay ray = kernels::f64::fibreRay(sin_theta, cos_theta, std::sin(gammas[i]), bending);
      ray.fresnel = kernels::f64::fresnelReflectance(cos_theta * std::cos(gammas[i]), index);
      for (int p = 0; p < 3; ++p) {
        const auto lobe = static_cast<size_t>(p);
        before[lobe][i] = std::cos(kernels::f64::fibreAzimuth(ray, p));
        twice[lobe][i] = 2 * before[lobe][i];
        now[lobe][i] = 1;
      }
      residual.add(weights[i], ray.fresnel, ray.passage);
      for (int knot = 0; knot < 4; ++knot) {
        const FibreLobes share = kernels::f64::fibreShares(
            ray.fresnel, std::exp(-kAbsorptionKnots[static_cast<size_t>(knot)] * ray.passage));
        const int column = knot == 0 ? 0 : knot + 1;
        of_r[i] = weights[i] * share.r;
        of_tt(i, column) = weights[i] * share.tt;
        of_trt(i, column) = weights[i] * share.trt;
      }
      of_tt(i, 1) = of_tt(i, 0) * ray.passage;
      of_trt(i, 1) = 2 * of_trt(i, 0) * ray.passage;
    }
    for (int k = 0; k < harmonics; ++k) {
      for (size_t p = 0; p < 3; ++p) {
        waves[p].col(k) = now[p];
        before[p] = twice[p] * now[p] - before[p];
        now[p].swap(before[p]);
      }
    }
    series.topRows<1>().noalias() = of_r.matrix().transpose() * waves[0];
    series.middleRows<kOfLobe>(1).noalias() = of_tt.transpose() * waves[1];
    series.middleRows<kOfLobe>(1 + kOfLobe).noalias() = of_trt.transpose() * waves[2];
    const MatrixXd functions = series * cosines;
    const double longest =
        2 * bending / std::sqrt(std::max(bending * bending - sin_theta * sin_theta, 1e-12));
    for (int j = 0; j < columns_; ++j) {
      float* texel = &numbers_[static_cast<size_t>((row * columns_ + j) * kTexel)];
      texel[0] = static_cast<float>(std::max(functions(0, j), 0.0));
      residual.write(texel + 1);
      writePaths(&functions(1, j), longest, texel + 6);
      writePaths(&functions(1 + kOfLobe, j), 2 * longest, texel + 11);
    }
  }
}

kernels::f64::FibreTexel FibreTable::texel(double cos_theta, double phi) const {
  return kernels::f64::fibreTexel(numbers_.data(), size(), cos_theta, phi);
}

kernels::f64::FibreLobes FibreTable::at(double cos_theta, double phi, double sigma) const {
  return kernels::f64::fibreAzimuthal(texel(cos_theta, phi), sigma);
}

}  // namespace strandcast
