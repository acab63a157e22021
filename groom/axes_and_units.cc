#include "groom/axes_and_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/pose_check.h"

namespace strandcast {

void checkUnit(float unit_meters) {
  if (!(unit_meters >= 0) || !std::isfinite(unit_meters))
    throw Error("the unit must be a positive number of metres", fmt::format("unit_meters {}", unit_meters),
                "say for example 0.01 for centimetres, or 0 to have it guessed");
}

void turnYUp(std::span<Vec3> points, UpAxis up) {
  for (Vec3& p : points) {
    if (up == UpAxis::kZ) p = Vec3(p.x(), p.z(), -p.y());
    if (up == UpAxis::kX) p = Vec3(-p.y(), p.x(), p.z());
  }
}

void turnZUp(std::span<Vec3> points) {
  for (Vec3& p : points) p = Vec3(p.x(), -p.z(), p.y());
}

void scaleToMeters(std::span<Vec3> points, float unit_meters, const std::string& name) {
  for (size_t i = 0; i < points.size(); ++i) {
    points[i] *= unit_meters;
    if (!(points[i].cwiseAbs().maxCoeff() <= kFarthestPose))
      throw Error("a vertex lies further than 10 km from the origin", fmt::format("{}, vertex {}", name, i),
                  "give the file's unit (--unit-meters)");
  }
}

bool isSameUnit(float a, float b) {
  constexpr float kRounded = 1e-4f;  // what files round their units to
  return std::abs(a - b) <= kRounded * std::max(a, b);
}

const char* nameOf(UpAxis axis) {
  switch (axis) {
    case UpAxis::kX:
      return "X";
    case UpAxis::kY:
      return "Y";
    case UpAxis::kZ:
      return "Z";
    case UpAxis::kAuto:
      break;
  }
  return "auto";
}

std::span<const float> usualUnits() {
  static constexpr std::array<float, 5> kUnits{1.0f, 0.1f, 0.01f, 0.0025f, 0.001f};
  return kUnits;
}

float guessUnit(const Box& bounds) {
  constexpr double kTypicalSize = 0.3;  // m: the middle of 0.1 to 1 m, on a logarithmic scale
  if (bounds.isEmpty()) return 1.0f;
  const double size = (bounds.max().cast<double>() - bounds.min().cast<double>()).maxCoeff();
  if (!(size > 0)) return 1.0f;
  float best = 1.0f;
  for (const float unit : usualUnits())
    if (std::abs(std::log(size * unit / kTypicalSize)) < std::abs(std::log(size * best / kTypicalSize)))
      best = unit;
  return best;
}

}  // namespace strandcast
