#include "air/wind.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "kernels/scalar_grid.h"

namespace strandcast {
namespace {

constexpr int kGusts = 8, kModes = 96, kBox = 32;
constexpr double kTurn = 2 * std::numbers::pi, kHighest = 8;

// Uniform in [0, 1). The distributions of <random> differ between standard libraries.
double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

Eigen::Vector3d direction(std::mt19937_64& random) {
  const double z = 2 * uniform(random) - 1, angle = kTurn * uniform(random), r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

Vec3 toTurbulenceBox(const Vec3& v) {
  const auto turned = kernels::f32::toTurbulenceBox({v.x(), v.y(), v.z()});
  return {turned.x, turned.y, turned.z};
}

size_t boxIndex(int i, int j, int k) {
  return (static_cast<size_t>(k & (kBox - 1)) * kBox + static_cast<size_t>(j & (kBox - 1))) * kBox +
         static_cast<size_t>(i & (kBox - 1));
}

}  // namespace

Ambient::Ambient() { makeBox(0); }

void Ambient::makeBox(uint64_t seed) {
  std::mt19937_64 random(seed);
  gust_phases_.clear();
  for (int n = 0; n < kGusts; ++n) gust_phases_.push_back(static_cast<float>(kTurn * uniform(random)));
  std::vector<Eigen::Vector3d> sum(size_t{kBox} * kBox * kBox, Eigen::Vector3d::Zero());
  std::vector<double> cosines(kBox), sines(kBox);
  for (int i = 0; i < kBox; ++i) {
    cosines[i] = std::cos(kTurn * i / kBox);
    sines[i] = std::sin(kTurn * i / kBox);
  }
  for (int mode = 0; mode < kModes; ++mode) {
    // |n| is distributed uniformly in its logarithm, so each mode represents the energy E(n) n.
    Eigen::Vector3i wave;
    double n = 0;
    do {
      wave = (std::pow(kHighest, uniform(random)) * direction(random)).array().round().cast<int>();
      n = wave.cast<double>().norm();
    } while (!(n >= 1 && n < kHighest));
    const Eigen::Vector3d amplitude =
        wave.cast<double>().cross(direction(random)).normalized() * std::pow(n, -1.0 / 3);
    const int phase = static_cast<int>(kBox * uniform(random));
    for (int k = 0; k < kBox; ++k)
      for (int j = 0; j < kBox; ++j)
        for (int i = 0; i < kBox; ++i)
          sum[boxIndex(i, j, k)] +=
              amplitude * cosines[(wave.x() * i + wave.y() * j + wave.z() * k + phase) & (kBox - 1)];
  }
  double square = 0;
  for (const Eigen::Vector3d& u : sum) square += u.squaredNorm() / 3;
  const double scale = 1 / std::sqrt(square / static_cast<double>(sum.size()));
  box_.clear();
  for (const Eigen::Vector3d& u : sum) box_.push_back((scale * u).cast<float>());
}

void Ambient::configure(const Parameters& p) {
  if (p.wind_seed != seed_) makeBox(static_cast<uint64_t>(p.wind_seed));
  seed_ = p.wind_seed;
  wind_ = p.wind;
  gust_ = p.gust;
  gust_period_ = p.gust_period;
  turbulence_ = p.turbulence * p.wind.norm();
  turbulence_length_ = p.turbulence_length;
  setProgress(progress_);
}

void Ambient::advance(double seconds) {
  Progress next = progress_;
  next.carried += toTurbulenceBox(wind_).cast<double>() * (seconds / static_cast<double>(turbulence_length_));
  next.carried -= next.carried.array().floor().matrix();
  next.gust += seconds / static_cast<double>(gust_period_);
  next.gust -= std::floor(next.gust);
  setProgress(next);
}

void Ambient::moveOrigin(const Vec3& way) {
  const Eigen::Vector3d w = way.cast<double>();
  const auto turned = kernels::f64::toTurbulenceBox({w.x(), w.y(), w.z()});  // floats would shift the eddies
  Progress next = progress_;
  next.carried -= Eigen::Vector3d(turned.x, turned.y, turned.z) / static_cast<double>(turbulence_length_);
  next.carried -= next.carried.array().floor().matrix();
  setProgress(next);
}

void Ambient::setProgress(const Progress& progress) {
  progress_ = progress;
  carried_ = (progress.carried * static_cast<double>(turbulence_length_)).cast<float>();
  computeMean();
}

void Ambient::computeMean() {
  double sum = 0, square = 0;
  for (int n = 1; n <= kGusts; ++n) {
    const double amplitude = std::pow(n, -5.0 / 6);
    sum += amplitude * std::cos(kTurn * n * progress_.gust + gust_phases_[n - 1]);
    square += amplitude * amplitude / 2;
  }
  mean_ = wind_ * static_cast<float>(1 + gust_ * sum / std::sqrt(square));
}

Vec3 Ambient::at(const Vec3& point) const {
  if (!(turbulence_ > 0)) return mean_;
  const Vec3 place = (toTurbulenceBox(point) - carried_) * boxPlacesPerMetre();
  if (!place.allFinite()) return mean_;  // the position of a strand that diverged
  const Vec3 low = place.array().floor(), part = place - low;
  const Vec3 first =
      low - kBox * (low / kBox).array().floor().matrix();  // index modulo kBox; exact in floats
  Vec3 out = Vec3::Zero();
  for (int c = 0; c < 8; ++c) {
    float weight = turbulence_;
    for (int axis = 0; axis < 3; ++axis) weight *= (c >> axis & 1) != 0 ? part[axis] : 1 - part[axis];
    out += weight *
           box_[boxIndex(static_cast<int>(first.x()) + (c & 1), static_cast<int>(first.y()) + (c >> 1 & 1),
                         static_cast<int>(first.z()) + (c >> 2))];
  }
  return mean_ + toTurbulenceBox(out);
}

float Ambient::boxPlacesPerMetre() const { return kBox / turbulence_length_; }

Eigen::Vector3i WindBox::centreAt(const Vec3& middle) {
  const double cell = static_cast<double>(cell_);
  const Vec3 wanted = middle / cell_ - Vec3::Constant(0.5f * static_cast<float>(cells_));
  const Vec3 off = wanted - (corner_ / cell).cast<float>();
  if (off.cwiseAbs().maxCoeff() <= 1) return Eigen::Vector3i::Zero();
  const Eigen::Vector3i shift = off.array().round().matrix().cast<int>();
  corner_ += shift.cast<double>() * cell;
  return shift;
}

namespace {

constexpr float kWindBox = 2;  // edge of the wind's box over the largest edge of the groom's box

}  // namespace

Vec3 Wind::placeOf(int axis, int i, int j, int k) const {
  Vec3 place(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k));
  for (int a = 0; a < 3; ++a)
    if (a != axis) place[a] += 0.5f;
  return origin() + place * cell();
}

void Wind::setVelocity(const std::function<Vec3(const Vec3&)>& velocity) {
  setComponents([&](int axis, int i, int j, int k) { return velocity(placeOf(axis, i, j, k))[axis]; });
}

double Wind::flowOut() const {
  const int n = cells();
  double sum = 0;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      sum += component(0, n, a, b) - component(0, 0, a, b) + component(1, a, n, b) - component(1, a, 0, b) +
             component(2, a, b, n) - component(2, a, b, 0);
  return sum * static_cast<double>(cell()) * static_cast<double>(cell());
}

float windCell(const Box& box, int cells) {
  return kWindBox * std::max(box.sizes().maxCoeff(), 1e-3f) / static_cast<float>(cells);
}

}  // namespace strandcast
