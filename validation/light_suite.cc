#include <fmt/format.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>
#include <random>

#include "light/chiang_fibre.h"
#include "light/far_fibre.h"
#include "validation/cylinder_rays.h"
#include "validation/suite.h"

namespace strandcast {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr double kAround = 2 * std::numbers::pi;
constexpr double kRadians = kAround / 360;
constexpr double kTiltDegrees[] = {0, 2, 5};  // degrees

Vector3d fibreDirection(double theta, double phi) {
  return {std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi)};
}
double cosineOfInclination(const Vector3d& w) { return std::hypot(w.y(), w.z()); }

FibreMaterial fibreOf(double roughness, double tilt_degrees, const Array3d& sigma_a) {
  FibreMaterial material;
  material.sigma_a = sigma_a;
  material.longitudinal_roughness = material.azimuthal_roughness = roughness;
  material.tilt = tilt_degrees * kRadians;
  return material;
}

/// Integral over all directions, per channel, by the midpoint rule in theta and phi with steps that resolve
/// lobes of this roughness. `of`: of a direction, without the measure.
template <class Function>
Array3d overSphere(double roughness, const Function& of) {
  namespace f64 = kernels::f64;
  const double narrowest = 0.5 * std::sqrt(f64::longitudinalVariance(roughness));
  const int rows = std::max(240, static_cast<int>(std::ceil(4 * std::numbers::pi / narrowest)));
  const int columns = std::max(120, static_cast<int>(std::ceil(4 / f64::logisticScale(roughness))));
  Array3d sum = Array3d::Zero();
  for (int i = 0; i < rows; ++i) {
    const double theta = std::numbers::pi * ((i + 0.5) / rows - 0.5);
    Array3d row = Array3d::Zero();
    for (int j = 0; j < columns; ++j) row += of(fibreDirection(theta, kAround * (j + 0.5) / columns));
    sum += row * std::cos(theta);
  }
  return sum * (std::numbers::pi / rows) * (kAround / columns);
}

// Ray optics.
// ---------------------------------------------------------------------------------------------------------

struct RayTrial {
  double degrees, sigma, roughness;
};
constexpr RayTrial kRayTrials[] = {{0, 0, 0.3},   {30, 0, 0.3},   {60, 0, 0.3},
                                   {0, 0.5, 0.3}, {60, 0.5, 0.3}, {30, 0.2, 0.15}};
constexpr const char* kLobes[] = {"R", "TT", "TRT"};

std::string nameOfRays(const RayTrial& trial, const char* lobe, const char* what) {
  return fmt::format("rays: {} {:g} deg, sigma {:g}, roughness {:g}, {}", lobe, trial.degrees, trial.sigma,
                     trial.roughness, what);
}

std::vector<std::string> rayNames() {
  std::vector<std::string> names;
  for (const RayTrial& trial : kRayTrials)
    for (const char* lobe : kLobes)
      for (const char* what : {"N", "albedo"}) names.push_back(nameOfRays(trial, lobe, what));
  return names;
}

std::vector<Case> rayCases(const Laboratory& laboratory) {
  constexpr int kAngles = 180, kRays = 400000;
  std::vector<Case> cases;
  for (const RayTrial& trial : kRayTrials) {
    laboratory.checkStopped();
    const double theta = trial.degrees * kRadians, s = kernels::f64::logisticScale(trial.roughness);
    const FibreTable table(trial.roughness, 1.55);
    const ScatteredRays rays = traceCylinder({1.55, trial.sigma}, theta, kRays, 1);
    std::array<double, 3> error{}, peak{}, albedo{};
    for (int j = 0; j < kAngles; ++j) {
      const double phi = kAround * ((j + 0.5) / kAngles - 0.5);
      const kernels::f64::FibreLobes n = table.at(std::cos(theta), phi, trial.sigma);
      const std::array<double, 3> found{n.r, n.tt, n.trt};
      for (size_t p = 0; p < 3; ++p) {
        const double exact = roughenedDensity(rays.histogram[p], s, phi);
        error[p] += std::abs(found[p] - exact) / kAngles;
        peak[p] = std::max(peak[p], exact);
        albedo[p] += found[p] * kAround / kAngles;
      }
    }
    for (size_t p = 0; p < 3; ++p) {
      cases.push_back(absoluteCase(
          {nameOfRays(trial, kLobes[p], "N"), "mean error of N over its peak, by ray optics", "%"},
          100 * error[p] / peak[p], 0, 2));
      cases.push_back(relativeCase({nameOfRays(trial, kLobes[p], "albedo"), "integral of N over phi", ""},
                                   albedo[p], rays.albedo[p], 0.5));
    }
    cases.back().note =
        fmt::format("{} rays; {:.2f} % of the light is left after TRT", kRays, 100 * rays.rest);
  }
  return cases;
}

/// Mean error of TRT over its peak, of a fibre with this axis ratio in three orientations; of Marschner's
/// model, and of a round fibre in its place.
std::pair<double, double> ellipticErrors(double axis_ratio) {
  constexpr int kAngles = 180, kRays = 200000;
  const double s = kernels::f64::logisticScale(0.3);
  FibreMaterial material = fibreOf(0.3, 0, Array3d::Zero());
  material.axis_ratio = axis_ratio;
  // R and TT are moved out of the way.
  kernels::f64::MarschnerLobes lobes = marschnerLobes(material);
  lobes.shift.x = lobes.shift.y = 1.5;
  lobes.width.x = lobes.width.y = 1e-3;
  const MarschnerFibre fibre(material, lobes);
  const double longitudinal = kernels::f64::marschnerLongitudinal(0, 0, lobes.width.z);
  const ScatteredRays round = traceCylinder({}, 0, kRays, 2);
  double model = 0, instead = 0;
  for (const double azimuth : {0.0, kAround / 8, kAround / 4}) {
    const ScatteredRays exact = traceCylinder({1.55, 0, axis_ratio, azimuth}, 0, kRays, 3);
    double error = 0, error_round = 0, peak = 0;
    for (int j = 0; j < kAngles; ++j) {
      const double phi = kAround * ((j + 0.5) / kAngles - 0.5),
                   truth = roughenedDensity(exact.histogram[2], s, phi);
      const double found =
          fibre.f(fibreDirection(0, azimuth + phi), fibreDirection(0, azimuth))[0] / longitudinal;
      error += std::abs(found - truth) / kAngles;
      error_round += std::abs(roughenedDensity(round.histogram[2], s, phi) - truth) / kAngles;
      peak = std::max(peak, truth);
    }
    model += error / peak / 3;
    instead += error_round / peak / 3;
  }
  return {model, instead};
}

const std::vector<double> kAxisRatios{0.95, 0.9, 0.85};

std::vector<Case> ellipseCases(const Laboratory& laboratory) {
  std::vector<Case> cases;
  for (const double ratio : kAxisRatios) {
    laboratory.checkStopped();
    const auto [model, instead] = ellipticErrors(ratio);
    cases.push_back(absoluteCase({fmt::format("ellipse: axis ratio {:g}", ratio),
                                  "mean error of TRT over its peak; the limit is that of a round fibre", "%"},
                                 100 * model, 0, 100 * instead));
  }
  return cases;
}

// One fibre in uniform light, and its probability densities.
// ---------------------------------------------------------

const std::vector<double> kRoughnesses{0.05, 0.1, 0.3, 0.6, 1};

std::vector<std::string> withTilts(std::string_view what, const std::vector<double>& roughnesses) {
  std::vector<std::string> names;
  for (const double roughness : roughnesses)
    for (const double tilt : kTiltDegrees)
      names.push_back(fmt::format("{}: roughness {:g}, tilt {:g} deg", what, roughness, tilt));
  return names;
}

/// Calls `use(wo, h)` for views along and across the fibre.
template <class Use>
void forViews(const Use& use) {
  for (const double theta : {-75.0, -20.0, 0.0, 45.0, 85.0})
    for (const double h : {-0.95, 0.0, 0.6}) use(fibreDirection(theta * kRadians, 0.4), h);
}

std::vector<Case> furnaceCases(const Laboratory& laboratory) {
  std::vector<Case> cases;
  const std::vector<std::string> names = withTilts("furnace", kRoughnesses);
  for (const double roughness : kRoughnesses)
    for (const double tilt : kTiltDegrees) {
      laboratory.checkStopped();
      const ChiangFibre fibre(fibreOf(roughness, tilt, Array3d::Zero()));
      double worst = 1;
      forViews([&](const Vector3d& wo, double h) {
        const double radiance = overSphere(roughness, [&](const Vector3d& wi) -> Array3d {
          return fibre.f(wo, wi, h) * cosineOfInclination(wi);
        })[0];
        if (!(std::abs(radiance - 1) <= std::abs(worst - 1))) worst = radiance;
      });
      cases.push_back(relativeCase(
          {names[cases.size()], "radiance under a sky of 1, farthest of 15 views", ""}, worst, 1, 0.2));
    }
  return cases;
}

std::vector<Case> pdfCases(const Laboratory& laboratory) {
  std::vector<Case> cases;
  const std::vector<std::string> names = withTilts("pdf", kRoughnesses);
  for (const double roughness : kRoughnesses)
    for (const double tilt : kTiltDegrees) {
      laboratory.checkStopped();
      const ChiangFibre fibre(fibreOf(roughness, tilt, {0.1, 0.5, 2}));
      double worst = 1;
      forViews([&](const Vector3d& wo, double h) {
        const double whole = overSphere(
            roughness, [&](const Vector3d& wi) { return Array3d::Constant(fibre.pdf(wo, wi, h)); })[0];
        if (!(std::abs(whole - 1) <= std::abs(worst - 1))) worst = whole;
      });
      cases.push_back(
          relativeCase({names[cases.size()], "integral of pdf, farthest of 15 views", ""}, worst, 1, 0.2));
    }
  return cases;
}

/// Chi-square of samples in bins of theta and phi: how many standard deviations it is above its mean, by
/// the cube-root transformation of Wilson and Hilferty 1931.
double chiSquareDeviation(const ChiangFibre& fibre, const Vector3d& wo, double h, int samples,
                          unsigned seed) {
  constexpr int kRows = 20, kColumns = 40, kFine = 32, kLeastExpected = 8;
  auto bin = [](double theta, double phi) {
    const double turn = phi / kAround - std::floor(phi / kAround);
    const int row = std::min(static_cast<int>((theta / std::numbers::pi + 0.5) * kRows), kRows - 1);
    return row * kColumns + std::min(static_cast<int>(turn * kColumns), kColumns - 1);
  };
  std::vector<double> expected(kRows * kColumns), found(kRows * kColumns);
  constexpr double kArea = std::numbers::pi / (kRows * kFine) * kAround / (kColumns * kFine);
  for (int i = 0; i < kRows * kFine; ++i)
    for (int j = 0; j < kColumns * kFine; ++j) {
      const double theta = std::numbers::pi * ((i + 0.5) / (kRows * kFine) - 0.5);
      const double phi = kAround * (j + 0.5) / (kColumns * kFine);
      expected[static_cast<size_t>(bin(theta, phi))] +=
          fibre.pdf(wo, fibreDirection(theta, phi), h) * std::cos(theta) * kArea * samples;
    }
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<> uniform;
  for (int k = 0; k < samples; ++k) {
    const double u0 = uniform(random), u1 = uniform(random), u2 = uniform(random), u3 = uniform(random);
    const Vector3d wi = fibre.sample(wo, h, u0, u1, u2, u3).wi;
    ++found[static_cast<size_t>(bin(std::asin(std::clamp(wi.x(), -1.0, 1.0)), std::atan2(wi.z(), wi.y())))];
  }
  double chi2 = 0, rest_expected = 0, rest_found = 0, freedom = -1;
  auto add = [&](double e, double n) {
    chi2 += (n - e) * (n - e) / e;
    ++freedom;
  };
  for (size_t b = 0; b < expected.size(); ++b)
    if (expected[b] >= kLeastExpected) {
      add(expected[b], found[b]);
    } else {
      rest_expected += expected[b];
      rest_found += found[b];
    }
  if (rest_expected > kLeastExpected) add(rest_expected, rest_found);
  const double spread = 2 / (9 * freedom);
  return (std::cbrt(chi2 / freedom) - 1 + spread) / std::sqrt(spread);
}

const std::vector<double> kSampledRoughnesses{0.05, 0.3, 0.6, 0.9};

std::vector<Case> samplingCases(const Laboratory& laboratory) {
  constexpr int kSamples = 100000;
  std::vector<Case> cases;
  const std::vector<std::string> names = withTilts("chi-square", kSampledRoughnesses);
  for (const double roughness : kSampledRoughnesses)
    for (const double tilt : kTiltDegrees) {
      laboratory.checkStopped();
      const ChiangFibre fibre(fibreOf(roughness, tilt, {0.1, 0.5, 2}));
      double worst = -100;
      unsigned seed = 1;
      for (const double theta : {-60.0, 10.0, 80.0})
        worst = worse(worst,
                      chiSquareDeviation(fibre, fibreDirection(theta * kRadians, 2), 0.4, kSamples, seed++));
      cases.push_back(
          absoluteCase({names[cases.size()], "standard deviations above the mean, worst of 3 views", ""},
                       std::max(worst, 0.0), 0, 4));
    }
  return cases;
}

/// A sky that is bright on one side and along the fibre.
Array3d skyAt(const Vector3d& w) {
  return Array3d(1 + 0.8 * w.y(), 1 + w.x() * w.x(), 0.2 + std::pow(std::max(w.z(), 0.0), 4));
}

/// Additive recurrence of low discrepancy in four dimensions: powers of 1 / g, g^5 = g + 1.
constexpr double kRecurrence[] = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                                  0.5385972572236101};

std::vector<Case> importanceCases(const Laboratory& laboratory) {
  constexpr int kSamples = 200000;
  std::vector<Case> cases;
  const std::vector<std::string> names = withTilts("importance", kSampledRoughnesses);
  for (const double roughness : kSampledRoughnesses)
    for (const double tilt : kTiltDegrees) {
      laboratory.checkStopped();
      const ChiangFibre fibre(fibreOf(roughness, tilt, {0.1, 0.5, 2}));
      const Vector3d wo = fibreDirection(0.5, 1);
      const double h = -0.3;
      const Array3d exact = overSphere(roughness, [&](const Vector3d& wi) -> Array3d {
        return fibre.f(wo, wi, h) * cosineOfInclination(wi) * skyAt(wi);
      });
      Array3d sum = Array3d::Zero();
      double most = 0;
      for (int k = 0; k < kSamples; ++k) {
        const auto u = [k](int dimension) { return std::fmod(0.5 + k * kRecurrence[dimension], 1.0); };
        const ChiangFibre::Sample s = fibre.sample(wo, h, u(0), u(1), u(2), u(3));
        const Array3d weight = s.f * cosineOfInclination(s.wi) / s.pdf;
        most = std::max(most, weight.maxCoeff());
        sum += weight * skyAt(s.wi);
      }
      const Array3d ratio = sum / kSamples / exact;
      const double farthest = (ratio - 1).abs().maxCoeff();
      cases.push_back(
          relativeCase({names[cases.size()], "sampled over integrated radiance, farthest channel", ""},
                       1 + farthest, 1, 0.5));
      cases.back().note = fmt::format("largest weight of a sample {:.3f}", most);
    }
  return cases;
}

// Reciprocity.
// -------------------------------------------------------------------------------------------------------

std::vector<Case> reciprocityCases(const Laboratory&) {
  FibreMaterial material = fibreOf(0.3, 2, {0.1, 0.5, 2});
  const MarschnerFibre marschner(material);
  material.tilt = 0;
  const ChiangFibre chiang(material);
  double far = 0, equal = 0, differences = 0, values = 0;
  for (int k = 0; k < 2000; ++k) {
    const double theta = 1.4 * std::sin(3.0 * k), phi = 1.7 * k, h = 0.95 * std::sin(5.0 * k);
    const Vector3d a = fibreDirection(theta, phi), b = fibreDirection(1.4 * std::cos(7.0 * k), 2.3 * k),
                   c = fibreDirection(k % 2 == 0 ? theta : -theta, 2.3 * k);
    auto differenceOf = [](const Array3d& one, const Array3d& two) {
      return ((one - two).abs() / (one + two)).maxCoeff() * 2;
    };
    far = worse(far, differenceOf(marschner.f(a, b), marschner.f(b, a)));
    equal = worse(equal, differenceOf(chiang.f(a, c, h), chiang.f(c, a, -h)));
    const Array3d there = chiang.f(a, b, h) * cosineOfInclination(b),
                  back = chiang.f(b, a, -h) * cosineOfInclination(a);
    differences += (there - back).square().sum();
    values += there.square().sum();
  }
  std::vector<Case> cases{
      absoluteCase({"reciprocity: marschner",
                    "worst difference of f when directions are exchanged, over its mean", "%"},
                   100 * far, 0, 1e-3),
      absoluteCase({"reciprocity: chiang, equal inclinations",
                    "the same between directions of equal |theta|, without tilt", "%"},
                   100 * equal, 0, 1e-3)};
  cases.back().note = fmt::format(
      "elsewhere the model is not reciprocal: f cos differs by {:.1f} % RMS, because attenuation is that of "
      "theta_o",
      100 * std::sqrt(differences / values));
  return cases;
}

// Functions and tables.
// ----------------------------------------------------------------------------------------------

/// log I0: the power series in long double up to 30, and the mean of exp(x cos t) beyond.
double exactLogBesselI0(double x) {
  if (x <= 30) {
    const long double quarter = 0.25L * x * x;
    long double term = 1, sum = 1;
    for (int k = 1; k < 400; ++k) sum += term *= quarter / (static_cast<long double>(k) * k);
    return static_cast<double>(std::log(sum));
  }
  // Only angles within 9 standard deviations of 0, 1 / sqrt(x), contribute.
  const int points = 4000;
  const double widest = std::min(std::numbers::pi, 9 / std::sqrt(x));
  double sum = 0;
  for (int k = 0; k < points; ++k)
    sum += std::exp(-2 * x * std::pow(std::sin(0.5 * widest * (k + 0.5) / points), 2));
  return x + std::log(sum * widest / (points * std::numbers::pi));
}

std::vector<Case> besselCases(const Laboratory&) {
  double worst = 0, worst_float = 0, at = 0;
  for (double x = 1e-4; x < 1e6; x *= 1.01) {
    const double exact = exactLogBesselI0(x), error = std::abs(kernels::f64::logBesselI0(x) - exact);
    if (!(error <= worst)) {
      worst = error;
      at = x;
    }
    const double scaled = std::log(static_cast<double>(kernels::f32::besselI0Scaled(static_cast<float>(x))));
    worst_float =
        worse(worst_float, std::abs(scaled - (exactLogBesselI0(static_cast<double>(static_cast<float>(x))) -
                                              static_cast<double>(static_cast<float>(x)))));
  }
  std::vector<Case> cases{
      absoluteCase(
          {"log I0: double", "worst error of log I0(x), x from 1e-4 to 1e6: relative error of I0", ""}, worst,
          0, 1e-5),
      absoluteCase({"log I0: float", "the same of log I0(x) - x in single precision", ""}, worst_float, 0,
                   1e-5)};
  cases[0].note = fmt::format("at x = {:.3g}", at);
  return cases;
}

const std::vector<double> kTableRoughnesses{0.1, 0.15, 0.2, 0.3, 0.6, 1};

std::vector<Case> tableCases(const Laboratory& laboratory) {
  std::vector<Case> cases;
  double slowest = 0;
  size_t bytes = 0;
  for (const double roughness : kTableRoughnesses) {
    double worst = 0, squares = 0, exact_squares = 0;
    std::shared_ptr<const FibreTable> table;
    double quickest = 1e9;  // of three
    for (int k = 0; k < 3; ++k) {
      const std::clock_t start = std::clock();
      table = std::make_shared<const FibreTable>(roughness, 1.55);
      quickest = std::min(quickest, 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    slowest = std::max(slowest, quickest);
    bytes = table->numbers().size_bytes();
    for (const double sigma : {0.02, 0.3, 1.3, 5.0}) {
      laboratory.checkStopped();
      const FibreMaterial material = fibreOf(roughness, 2, sigma * Array3d(1, 0.5, 0.2));
      const ChiangFibre near_field(material);
      const FarChiangFibre far_field(material, table);
      for (const double degrees : {-80.0, -55.0, -33.0, 0.0, 12.0, 71.0})
        for (int j = 0; j < 48; ++j) {
          const Vector3d wo = fibreDirection(degrees * kRadians, 0),
                         wi = fibreDirection((3 - degrees) * kRadians, kAround * (j + 0.3) / 48);
          // h = sin(gamma); the substitution of gamma makes the ends of the interval smooth. Narrow lobes
          // need more points.
          const int points = roughness < 0.3 ? 256 : 64;
          Array3d exact = Array3d::Zero();
          for (int k = 0; k < points; ++k) {
            const double x = std::numbers::pi * ((2 * k + 1.0) / points - 1), gamma = 0.5 * (x + std::sin(x));
            exact += near_field.f(wo, wi, std::sin(gamma)) *
                     (0.5 * std::cos(gamma) * (1 + std::cos(x)) * std::numbers::pi / points);
          }
          const Array3d error = far_field.f(wo, wi) - exact;
          worst = worse(worst, (error / exact).abs().maxCoeff());
          squares += error.square().sum();
          exact_squares += exact.square().sum();
        }
    }
    const double rms = std::sqrt(squares / exact_squares);
    const std::string name = fmt::format("far field: roughness {:g}", roughness);
    if (roughness > FibreTable::kLeastRoughness) {
      cases.push_back(absoluteCase(
          {name, "worst relative error of f against quadrature across the fibre", "%"}, 100 * worst, 0, 1));
      cases.back().note = fmt::format("RMS error over RMS {:.3f} %", 100 * rms);
    } else {  // the edge of the caustic of TRT is steeper than the steps of the table
      cases.push_back(
          absoluteCase({name, "RMS error of f over its RMS, against quadrature", "%"}, 100 * rms, 0, 1));
      cases.back().note = fmt::format("worst relative error {:.1f} %", 100 * worst);
    }
  }
  cases.push_back(absoluteCase({"far field: size", "bytes of a material's table", ""},
                               static_cast<double>(bytes), 0, 1e6));
  cases.push_back(absoluteCase({"far field: time", "processor time of the slowest of these tables", "ms"},
                               slowest, 0, 50));
  return cases;
}

}  // namespace

Suite lightSuite() {
  return {"light",
          "scattering of light by a fibre: ray optics, energy, sampling, tables",
          {{"log I0 against its series and quadrature", {"log I0: double", "log I0: float"}, besselCases},
           {"tables of N against ray optics in a cylinder", rayNames(), rayCases},
           {"TRT of an elliptic fibre against ray optics", caseNames("ellipse: axis ratio {:g}", kAxisRatios),
            ellipseCases},
           {"white furnace of one clear fibre", withTilts("furnace", kRoughnesses), furnaceCases},
           {"integral of the density of sampling", withTilts("pdf", kRoughnesses), pdfCases},
           {"samples against their density", withTilts("chi-square", kSampledRoughnesses), samplingCases},
           {"importance sampling against uniform integration", withTilts("importance", kSampledRoughnesses),
            importanceCases},
           {"exchange of light and viewer",
            {"reciprocity: marschner", "reciprocity: chiang, equal inclinations"},
            reciprocityCases},
           {"far-field tables against 64 points across the fibre",
            [] {
              std::vector<std::string> names = caseNames("far field: roughness {:g}", kTableRoughnesses);
              names.insert(names.end(), {"far field: size", "far field: time"});
              return names;
            }(),
            tableCases}}};
}

}  // namespace strandcast
