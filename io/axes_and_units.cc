#include "io/axes_and_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/geometry.h"

namespace strandcast {
namespace {

/// Distance of a size from that of a head of hair: the magnitude of the logarithm of their ratio.
double deviationFromHeadSize(double meters) {
  constexpr double kTypicalSize = 0.3;  // m: the geometric mean of 0.1 and 1 m
  return std::abs(std::log(meters / kTypicalSize));
}

const char* plainNameOf(float unit) {
  if (unit == 0.3048f) return " (feet)";
  if (unit == 0.0254f) return " (inches)";
  return unit == 0.01f ? " (centimetres)" : unit == 0.001f ? " (millimetres)" : "";
}

}  // namespace

void checkUnit(float unit_meters) {
  if (!(unit_meters >= 0) || !std::isfinite(unit_meters))
    throw Error("the unit must be a positive number of metres", fmt::format("unit_meters {}", unit_meters),
                "say for example 0.01 for centimetres, or 0 to have it guessed");
}

void rotateToYUp(std::span<Vec3> points, UpAxis up) {
  for (Vec3& p : points) {
    if (up == UpAxis::kZ) p = Vec3(p.x(), p.z(), -p.y());
    if (up == UpAxis::kX) p = Vec3(-p.y(), p.x(), p.z());
  }
}

void rotateToZUp(std::span<Vec3> points) {
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
  constexpr float kRounded = 1e-4f;  // relative rounding of units in files
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
  static constexpr std::array<float, 7> kUnits{1.0f, 0.1f, 0.01f, 0.0025f, 0.001f, 0.0254f, 0.3048f};
  return kUnits;
}

float guessUnit(const Box& bounds) {
  // Without inches and feet: these would change the guess for grooms in centimetres and metres.
  constexpr size_t kBySize = 5;
  if (bounds.isEmpty()) return 1.0f;
  const double size = (bounds.max().cast<double>() - bounds.min().cast<double>()).maxCoeff();
  if (!(size > 0)) return 1.0f;
  float best = 1.0f;
  for (const float unit : usualUnits().first(kBySize))
    if (deviationFromHeadSize(size * unit) < deviationFromHeadSize(size * best)) best = unit;
  return best;
}

bool isUnlikelySize(float meters) {
  constexpr float kSmallest = 1e-3f, kLargest = 20;  // m
  return meters < kSmallest || meters > kLargest;
}

std::string likelierUnits(float size, float taken) {
  constexpr double kSmallest = 0.1, kLargest = 1;  // m
  constexpr size_t kMax = 3;
  std::vector<std::pair<double, float>> found;  // deviationFromHeadSize(), unit
  for (const float unit : usualUnits()) {
    const double meters = static_cast<double>(size) * unit;
    const double off = deviationFromHeadSize(meters);
    if (!isSameUnit(unit, taken) && meters >= kSmallest && meters <= kLargest &&
        off < deviationFromHeadSize(static_cast<double>(size) * taken))
      found.emplace_back(off, unit);
  }
  std::sort(found.begin(), found.end());
  if (found.size() > kMax) found.resize(kMax);
  std::string out;
  for (const auto& [off, unit] : found)
    out += fmt::format("{}{:g} m{} would make it {:.2g} m large", out.empty() ? "" : ", ", unit,
                       plainNameOf(unit), unit * size);
  return out;
}

}  // namespace strandcast
