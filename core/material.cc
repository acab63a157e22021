#include "core/material.h"

#include <fmt/format.h>

#include "core/error.h"

namespace strandcast {

float RootTipCurve::at(float place) const {
  if (place <= knots.front().first) return knots.front().second;
  for (size_t i = 1; i < knots.size(); ++i) {
    const auto& [a, fa] = knots[i - 1];
    const auto& [b, fb] = knots[i];
    if (place <= b) return b > a ? fa + (fb - fa) * (place - a) / (b - a) : fb;
  }
  return knots.back().second;
}

void checkMaterial(const Material& material, const char* where) {
  auto inside = [&](float value, float low, float high, const char* name, const char* unit) {
    if (!(value >= low && value <= high))
      throw Error(fmt::format("{} = {:g} is out of range", name, value), where,
                  fmt::format("give {:g} to {:g} {}", low, high, unit));
  };
  inside(material.youngs_modulus, 1e3f, 1e13f, "youngs_modulus", "Pa");
  inside(material.poisson_ratio, -0.9f, 0.5f, "poisson_ratio", "");
  inside(material.radius, 1e-6f, 5e-3f, "radius", "m");
  inside(material.density, 1, 20000, "density", "kg/m^3");
  for (const RootTipCurve* curve : {&material.radius_scale, &material.stiffness_scale}) {
    float before = -1e30f;
    if (curve->knots.empty()) throw Error("a root-to-tip curve has no knot", where, "give at least one");
    for (const auto& [place, factor] : curve->knots) {
      inside(factor, 1e-3f, 1e3f, "a curve's factor", "");
      if (!(place >= before))
        throw Error("a root-to-tip curve goes backwards", where, "give its places in order");
      before = place;
    }
  }
}

}  // namespace strandcast
