#include "collision/field_accuracy.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace strandcast {
namespace {

/// Random points in the stored bricks of a field.
class BandPlaces {
 public:
  explicit BandPlaces(const DistanceField& field) : grid_(field.grid) {
    for (size_t i = 0; i < field.index.size(); ++i)
      if (field.index[i] < kInsideBrick) stored_.push_back(static_cast<uint32_t>(i));
  }
  bool empty() const { return stored_.empty(); }
  Vec3 next() {
    const uint32_t brick = stored_[random_() % stored_.size()], nx = grid_.bricks[0], ny = grid_.bricks[1];
    const float x = fraction(), y = fraction(), z = fraction();
    return samplePosition(grid_, brick % nx * kBrickCells, brick / nx % ny * kBrickCells,
                          brick / nx / ny * kBrickCells) +
           Vec3(x, y, z) * (grid_.cell * kBrickCells);
  }

 private:
  float fraction() { return std::ldexp(static_cast<float>(random_() >> 40), -24); }

  const FieldGrid& grid_;
  std::vector<uint32_t> stored_;
  std::mt19937_64 random_{1};
};

double degrees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
}

}  // namespace

FieldAccuracy measureField(const DistanceField& field, const BodyDistance& body, size_t points,
                           const BakeProgress& progress) {
  const FieldGrid& grid = field.grid;
  FieldAccuracy out;
  std::vector<double> angles;
  double squares = 0;
  BandPlaces places(field);
  for (size_t tries = 0; out.points < points && tries < 50 * points && !places.empty(); ++tries) {
    if (tries % 16 == 0 && progress &&
        !progress("measuring", static_cast<double>(out.points) / static_cast<double>(points)))
      throw BakeStopped();
    const Vec3 p = places.next();
    if (body.toMesh(p, grid.band) >= grid.band) continue;
    ++out.points;
    const BodyPoint exact = body.at(p);
    const FieldSample found = field.at(p);
    const double error = std::fabs(double{found.distance} - double{exact.signed_distance});
    out.worst = std::max(out.worst, error);
    squares += error * error;
    if (exact.in_doubt) ++out.unclear;
    if (std::fabs(exact.signed_distance) > grid.cell && found.distance * exact.signed_distance < 0)
      ++out.wrong_side;
    // Very near the surface rounding spoils the direction to it.
    if (exact.to_lid || std::fabs(exact.signed_distance) < 0.01f * grid.cell) continue;
    const double side = exact.signed_distance < 0 ? -1 : 1;
    angles.push_back(
        degrees((p - body.nearestOnMesh(p)).cast<double>() * side, found.gradient.cast<double>()));
  }
  if (out.points > 0) out.rms = std::sqrt(squares / static_cast<double>(out.points));
  if (!angles.empty()) {
    std::sort(angles.begin(), angles.end());
    out.median_angle = angles[angles.size() / 2];
    out.p99_angle = angles[angles.size() * 99 / 100];
    out.worst_angle = angles.back();
  }
  return out;
}

}  // namespace strandcast
