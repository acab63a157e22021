#include "air/wind_source.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "core/error.h"
#include "kernels/scalar_grid.h"

namespace strandcast {

bool WindSource::velocityAt(const Vec3& point, Vec3& velocity) const {
  const Vec3 away = point - position, axis = direction.normalized();
  const float far = away.norm(), along = away.dot(axis);
  const Vec3 out = far > 0 ? Vec3(away / far) : axis;
  switch (kind) {
    case Kind::kCone:
      if (far > length || along < far * std::cos(angle)) return false;
      velocity = out * (speed * (1 - far / length));
      return true;
    case Kind::kSphere:
      if (far > radius) return false;
      velocity = out * speed;
      return true;
    case Kind::kTurbine:
      break;
  }
  const Vec3 across = away - along * axis;
  if (std::fabs(along) > length / 2 || across.norm() > radius) return false;
  velocity = speed * axis + axis.cross(across) * (swirl / radius);
  return true;
}

Box WindSource::reach() const {
  const float far = kind == Kind::kSphere ? radius : kind == Kind::kCone ? length : radius + length;
  const Eigen::Vector3f middle = position, half = Eigen::Vector3f::Constant(far);
  return {middle - half, middle + half};
}

std::vector<WindSource> withoutNames(const std::vector<NamedWindSource>& named) {
  std::vector<WindSource> sources;
  for (const NamedWindSource& one : named) sources.push_back(one.source);
  return sources;
}

WindSource onGrid(WindSource source, float cell) {
  if (source.kind == WindSource::Kind::kSphere && source.radius < cell) {
    source.speed *= (source.radius / cell) * (source.radius / cell);
    source.radius = cell;
  }
  if (source.kind != WindSource::Kind::kTurbine || source.length >= cell) return source;
  source.rate *= source.length / cell;
  source.length = cell;
  return source;
}

SphereOnGrid::SphereOnGrid(const WindSource& sphere, const Vec3& corner, float cell) {
  constexpr double kLargestSummed = 24;  // cells; above, the integral of the shares is accurate enough
  const WindSource on_grid = onGrid(sphere, cell);
  const double edge = static_cast<double>(cell);
  middle_ = (on_grid.position.cast<double>() - corner.cast<double>()) / edge;
  radius_ = static_cast<double>(on_grid.radius) / edge;
  double shares = 4.0 / 3 * std::numbers::pi * radius_ * (radius_ * radius_ + 0.25);
  if (radius_ <= kLargestSummed) {
    shares = 0;
    const Eigen::Vector3d part = middle_ - middle_.array().floor().matrix();
    const int reach = static_cast<int>(radius_) + 2;
    for (int k = -reach; k <= reach; ++k)
      for (int j = -reach; j <= reach; ++j)
        for (int i = -reach; i <= reach; ++i)
          shares += kernels::f64::sphereShare(
              (Eigen::Vector3d(i, j, k) + Eigen::Vector3d::Constant(0.5) - part).norm(), radius_);
  }
  per_share_ = 4 * std::numbers::pi * radius_ * radius_ * static_cast<double>(on_grid.speed) / shares;
}

double SphereOnGrid::outflow(int i, int j, int k) const {
  const Eigen::Vector3d away = Eigen::Vector3d(i, j, k) + Eigen::Vector3d::Constant(0.5) - middle_;
  return per_share_ * kernels::f64::sphereShare(away.norm(), radius_);
}

Eigen::Vector3i SphereOnGrid::first(int cells) const {
  return (middle_.array() - (radius_ + 1)).floor().max(0).min(cells).cast<int>();
}

Eigen::Vector3i SphereOnGrid::last(int cells) const {
  return (middle_.array() + radius_).floor().max(-1).min(cells - 1).cast<int>();
}

std::vector<WindSource> movedBy(std::vector<WindSource> sources, const Vec3& way) {
  for (WindSource& source : sources) source.position += way;
  return sources;
}

std::span<const WindSourceNumber> windSourceNumbers() {
  constexpr double kDegree = std::numbers::pi / 180;
  static const WindSourceNumber kNumbers[] = {
      {4, "radius", "m", "of a sphere or turbine", 1e-3, 100, 1, &WindSource::radius},
      {8, "length", "m", "reach of a cone, thickness of a turbine", 1e-3, 100, 1, &WindSource::length},
      {16, "angle", "degrees", "half a cone's opening", 0.1, 90, kDegree, &WindSource::angle},
      {32, "speed", "m/s", "of its air", -100, 100, 1, &WindSource::speed},
      {64, "swirl", "m/s", "of a turbine's rim", -100, 100, 1, &WindSource::swirl},
      {128, "rate", "1/s", "at which air on a grid takes on that of a cone or turbine", 0, 1000, 1,
       &WindSource::rate}};
  return kNumbers;
}

void copyParts(WindSource& source, const WindSource& of, WindSourceParts parts) {
  if ((parts & kSourcePosition) != 0) source.position = of.position;
  if ((parts & kSourceDirection) != 0) source.direction = of.direction;
  for (const WindSourceNumber& number : windSourceNumbers())
    if ((parts & number.part) != 0) source.*number.into = of.*number.into;
}

WindSource between(const WindSource& from, const WindSource& to, float part) {
  if (part >= 1) return to;
  WindSource out = to;
  out.position = from.position + part * (to.position - from.position);
  const Eigen::Quaternionf turn = Eigen::Quaternionf::FromTwoVectors(from.direction, to.direction);
  out.direction = Eigen::Quaternionf::Identity().slerp(part, turn) * from.direction.normalized();
  for (const WindSourceNumber& number : windSourceNumbers())
    out.*number.into = from.*number.into + part * (to.*number.into - from.*number.into);
  return out;
}

WindSource::Kind windSourceKind(const std::string& name, const std::string& where) {
  for (const WindSource::Kind kind :
       {WindSource::Kind::kCone, WindSource::Kind::kSphere, WindSource::Kind::kTurbine})
    if (windSourceKindName(kind) == name) return kind;
  throw Error("unknown source of wind '" + name + "'", where, "choose one of cone, sphere, turbine");
}

std::string windSourceKindName(WindSource::Kind kind) {
  switch (kind) {
    case WindSource::Kind::kCone:
      return "cone";
    case WindSource::Kind::kSphere:
      return "sphere";
    case WindSource::Kind::kTurbine:
      break;
  }
  return "turbine";
}

void checkWindSourceName(const std::string& name, const std::string& where) {
  constexpr size_t kLongest = 64;
  const bool is_name =
      !name.empty() && name.size() <= kLongest && std::all_of(name.begin(), name.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte > 0x20 && byte != 0x7f;
      });
  if (!is_name)
    throw Error("'" + name + "' is no name for a source of wind", where,
                "give 1 to 64 bytes without spaces and control characters");
}

void checkWindSource(const WindSource& s, const std::string& where) {
  auto within = [](float value, float low, float high) { return value >= low && value <= high; };
  const float least = std::nextafter(0.0f, 1.0f);
  if (s.kind < WindSource::Kind::kCone || s.kind > WindSource::Kind::kTurbine)
    throw Error("a source of wind is of no known kind", where, "choose cone, sphere or turbine");
  if (!s.position.allFinite() || !within(s.direction.norm(), 1e-3f, 1e3f))
    throw Error("a source of wind has no place or direction", where,
                "give finite numbers, and a direction of 0.001 to 1000 in length");
  if (!within(s.radius, least, 100) || !within(s.length, least, 100))
    throw Error("a source of wind has no size", where, "give radius and length above 0 to 100 m");
  if (!within(s.angle, least, static_cast<float>(std::numbers::pi / 2) * 1.0001f))
    throw Error("a source's angle is out of range", where, "give above 0 to 90 degrees");
  if (!within(s.speed, -100, 100) || !within(s.swirl, -100, 100) || !within(s.rate, 0, 1000))
    throw Error("a source's speed, swirl or rate is out of range", where,
                "give speeds within +-100 m/s and a rate of 0 to 1000 1/s");
}

WindSourceParts partsOf(WindSource::Kind kind) {
  WindSourceParts unused = 0;
  const auto ignoreOptions = [&](std::initializer_list<const char*> names) {
    for (const WindSourceNumber& number : windSourceNumbers())
      for (const std::string name : names)
        if (name == number.name) unused |= number.part;
  };
  switch (kind) {
    case WindSource::Kind::kCone:
      ignoreOptions({"radius", "swirl"});
      break;
    case WindSource::Kind::kTurbine:
      ignoreOptions({"angle"});
      break;
    case WindSource::Kind::kSphere:
      ignoreOptions({"length", "angle", "swirl", "rate"});
      unused |= kSourceDirection;
  }
  return kAllSourceParts & ~unused;
}

std::string unusedParts(WindSource::Kind kind, WindSourceParts parts) {
  const WindSourceParts unused = parts & ~partsOf(kind);
  std::string names = (unused & kSourceDirection) != 0 ? "direction" : "";
  for (const WindSourceNumber& number : windSourceNumbers())
    if ((unused & number.part) != 0) names += (names.empty() ? "" : ", ") + std::string(number.name);
  return names;
}

}  // namespace strandcast
