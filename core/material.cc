#include "core/material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/name_lookup.h"

namespace strandcast {
namespace {

/// A setting: either a number or a curve.
struct Entry {
  MaterialSettingInfo info;
  double low, high;  ///< of the number, or of the curve's factors
  float Material::*number = nullptr;
  RootTipCurve Material::*curve = nullptr;
  bool or_zero = false;  ///< 0 (off) is valid, too
};

std::string rangeOf(double low, double high) { return fmt::format("{:g} to {:g}", low, high); }

Entry number(const char* name, const char* unit, double low, double high, const char* help,
             float Material::*member) {
  return {{name, unit, rangeOf(low, high), help, false}, low, high, member, nullptr};
}
Entry numberOrZero(const char* name, double low, double high, const char* help, float Material::*member) {
  Entry entry = number(name, "", low, high, help, member);
  entry.info.range = "0 or " + entry.info.range;
  entry.or_zero = true;
  return entry;
}
Entry curve(const char* name, double low, double high, const char* help, RootTipCurve Material::*member) {
  return {{name, "", rangeOf(low, high), help, true}, low, high, nullptr, member};
}

const std::vector<Entry>& entries() {
  using M = Material;
  static const std::vector<Entry> list = {
      number("youngs_modulus", "Pa", 1e3, 1e13,
             "Young's modulus, which sets the bending stiffness; human hair 3e9 to 4e9", &M::youngs_modulus),
      number("poisson_ratio", "", -0.9, 0.5,
             "Poisson's ratio, which sets the twist stiffness: G = E / (2 + 2 nu)", &M::poisson_ratio),
      number("radius", "m", 1e-6, 5e-3, "radius at the root; bending stiffness grows with its 4th power",
             &M::radius),
      number("density", "kg/m^3", 1, 20000, "density; human hair 1300", &M::density),
      curve("radius_curve", 1e-3, 1e3, "taper: factor of radius from root to tip", &M::radius_scale),
      curve("stiffness_curve", 1e-3, 1e3, "factor of youngs_modulus from root to tip", &M::stiffness_scale),
      curve("density_curve", 0.1, 10, "factor of density from root to tip", &M::density_scale),
      curve("air_drag_curve", 0, 1e3, "factor of the parameter air_drag from root to tip",
            &M::air_drag_scale),
      curve("goal_curve", 0, 1, "factor of the parameter goal_rate from root to tip", &M::goal_scale),
      number("damping_scale", "", 0, 1e3, "factor of the parameter damping_time", &M::damping_scale),
      number("friction_scale", "", 0, 1e3, "factor of the friction of every body", &M::friction_scale),
      curve("damping_curve", 0, 1e3, "factor of damping_scale from root to tip", &M::damping_curve),
      curve("friction_curve", 0, 1e3, "factor of friction_scale from root to tip", &M::friction_curve),
      numberOrZero(
          "tether", 1, 10,
          "largest distance from the root over arc length, 0 = off; only for gauss_seidel, which stretches",
          &M::tether),
  };
  return list;
}

void checkNumber(const Entry& entry, double value, const std::string& where) {
  constexpr double kRounding = 1e-6;  // the limits are valid as floats, too
  if (!(value >= entry.low - kRounding * std::fabs(entry.low) &&
        value <= entry.high + kRounding * std::fabs(entry.high)) &&
      !(entry.or_zero && value == 0))
    throw Error(fmt::format("'{}' = {:g} is out of range", entry.info.name, value), where,
                fmt::format("give {} {}", entry.info.range, entry.info.unit));
}

void checkCurve(const Entry& entry, const RootTipCurve& curve, const std::string& where) {
  if (curve.knots.empty())
    throw Error(fmt::format("'{}' has no knot", entry.info.name), where, "give at least one");
  float before = -1;
  int here = 0;  // knots at one position
  for (const auto& [place, factor] : curve.knots) {
    checkNumber(entry, factor, where);
    here = place == before ? here + 1 : 1;
    const bool is_within = place > 0 && place < 1;  // a step at an end has one side only
    if (here > (is_within ? 2 : 1))
      throw Error(
          fmt::format("'{}' has {} knots at {:g}, more than it can use", entry.info.name, here, place), where,
          is_within ? "two knots make a step: leave the others out" : "leave one of them out");
    if (!(place >= 0 && place >= before && place <= 1))
      throw Error(fmt::format("'{}' has a knot at {:g}", entry.info.name, place), where,
                  "give places in order, from 0 (root) to 1 (tip)");
    before = place;
  }
}

/// Ratio of the greatest to the least value of radius^power x `other` along a strand.
double rangeAlong(const RootTipCurve& radius, int power, const RootTipCurve& other) {
  double least = std::numeric_limits<double>::max(), most = 0;
  const auto take = [&](double radius_factor, double other_factor) {
    const double product = std::pow(radius_factor, power) * other_factor;
    least = std::min(least, product);
    most = std::max(most, product);
  };
  for (const auto& [place, factor] : radius.knots) take(factor, other.at(place));
  for (const auto& [place, factor] : other.knots) take(radius.at(place), factor);
  take(radius.knots.back().second, other.knots.back().second);
  return most / least;
}

/// Bounds on taper so that the solver works in float: masses and stiffnesses at both ends of a strand are in
/// one system.
void checkTaper(const Material& material, const std::string& where) {
  constexpr double kMaxRadii = 100, kMaxBending = 1e10, kMaxMass = 1e4, kRounding = 1e-6;
  const RootTipCurve even, &radius = material.radius_scale;
  const auto check = [&](double times, double most, const char* who, const char* how, const char* what) {
    if (times > most * (1 + kRounding))
      throw Error(fmt::format("{} hair {:g} times as {} at one place as at another", who, times, how), where,
                  fmt::format("make {} differ by a factor of at most {:g}", what, most));
  };
  check(rangeAlong(radius, 1, even), kMaxRadii, "'radius_curve' makes", "thick", "its factors");
  check(rangeAlong(radius, 4, material.stiffness_scale), kMaxBending,
        "'radius_curve' and 'stiffness_curve' make", "stiff", "radius^4 x stiffness");
  check(rangeAlong(radius, 2, material.density_scale), kMaxMass, "'radius_curve' and 'density_curve' make",
        "heavy", "radius^2 x density");
}

/// A scale times its curve must be in the range of either alone.
void checkProduct(const char* name, float scale, const char* curve_name, const RootTipCurve& curve,
                  const std::string& where) {
  constexpr double kMax = 1e3, kRounding = 1e-6;
  double most = 0;
  for (const auto& [place, factor] : curve.knots) most = std::max<double>(most, factor);
  if (scale * most > kMax * (1 + kRounding))
    throw Error(fmt::format("'{}' x '{}' is up to {:g}", name, curve_name, scale * most), where,
                fmt::format("give at most {:g}", kMax));
}

void setShearModulus(Material& material, double shear, const std::string& where) {
  const double ratio = material.youngs_modulus / (2 * shear) - 1;
  constexpr double kRounding = 1e-5;  // the limits that the message names are valid
  if (!(ratio >= -0.9 - kRounding && ratio <= 0.5 + kRounding))
    throw Error(
        fmt::format("'{}' = {:g} does not fit youngs_modulus = {:g}", kShearModulus, shear,
                    material.youngs_modulus),
        where,
        fmt::format("give {:g} to {:g} Pa", material.youngs_modulus / 3, material.youngs_modulus / 0.2));
  material.poisson_ratio = static_cast<float>(std::clamp(ratio, -0.9, 0.5));
}

const Entry& entryOf(const std::string& name, const std::string& where) {
  std::vector<std::string> names = {kShearModulus};
  for (const Entry& entry : entries()) {
    if (entry.info.name == name) return entry;
    names.push_back(entry.info.name);
  }
  throw Error("unknown material setting '" + name + "'", where, didYouMean(name, names));
}

RootTipCurve curveOf(const Entry& entry, const std::vector<double>& values, const std::string& where) {
  if (values.size() == 1) return {{{0.0f, static_cast<float>(values[0])}}};
  if (values.empty() || values.size() % 2 != 0)
    throw Error(fmt::format("'{}' is not a curve", entry.info.name), where,
                "give pairs of place (0 root to 1 tip) and factor, or one factor");
  RootTipCurve curve{{}};
  for (size_t i = 0; i < values.size(); i += 2)
    curve.knots.emplace_back(static_cast<float>(values[i]), static_cast<float>(values[i + 1]));
  return curve;
}

}  // namespace

float RootTipCurve::at(float place) const {
  if (place <= knots.front().first) return knots.front().second;
  for (size_t i = 1; i < knots.size(); ++i) {
    const auto& [a, fa] = knots[i - 1];
    const auto& [b, fb] = knots[i];
    if (place <= b) return b > a ? fa + (fb - fa) * (place - a) / (b - a) : fb;
  }
  return knots.back().second;
}

void checkMaterial(const Material& material, const std::string& where) {
  for (const Entry& entry : entries()) {
    if (entry.number != nullptr)
      checkNumber(entry, material.*entry.number, where);
    else
      checkCurve(entry, material.*entry.curve, where);
  }
  checkTaper(material, where);
  checkProduct("damping_scale", material.damping_scale, "damping_curve", material.damping_curve, where);
  checkProduct("friction_scale", material.friction_scale, "friction_curve", material.friction_curve, where);
}

const std::vector<MaterialSettingInfo>& materialSettingList() {
  static const std::vector<MaterialSettingInfo> list = [] {
    std::vector<MaterialSettingInfo> infos;
    for (const Entry& entry : entries()) infos.push_back(entry.info);
    infos.insert(infos.begin() + 2, {kShearModulus, "Pa", "a third of youngs_modulus to 5 times it",
                                     "shear modulus G, instead of poisson_ratio", false});
    return infos;
  }();
  return list;
}

void setMaterial(Material& material, const std::string& name, const std::vector<double>& values,
                 const std::string& where) {
  for (const double value : values)
    if (!std::isfinite(value)) throw Error("'" + name + "' is not finite", where, "give finite numbers");
  auto one = [&] {
    if (values.size() != 1)
      throw Error(fmt::format("'{}' takes 1 number, not {}", name, values.size()), where, "");
    return values[0];
  };
  if (name == kShearModulus) return setShearModulus(material, one(), where);
  const Entry& entry = entryOf(name, where);
  if (entry.number != nullptr) {
    checkNumber(entry, one(), where);
    material.*entry.number = static_cast<float>(values[0]);
  } else {
    RootTipCurve curve = curveOf(entry, values, where);
    checkCurve(entry, curve, where);
    material.*entry.curve = std::move(curve);
  }
}

}  // namespace strandcast
