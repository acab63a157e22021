#include "io/usda_values.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace strandcast {
namespace {

/// Converts the values of a primvar. `valueOf(numbers)` returns a value, or none if the numbers are unusable.
/// `mend(good values)` returns the replacement for unusable ones. Throws UsdaFault if no value is usable.
template <class Value, class ValueOf, class Mend>
UsdaValues<Value> usableValues(const UsdaPrimvar& primvar, const ValueOf& valueOf, const Mend& mend) {
  UsdaValues<Value> out;
  std::vector<Value> good;
  std::vector<size_t> bad;
  for (size_t i = 0; i < primvar.elements(); ++i) {
    const std::span<const double> numbers = primvar.at(i);
    const std::optional<Value> value = numbers.empty() ? std::nullopt : valueOf(numbers);
    if (value)
      good.push_back(*value);
    else
      bad.push_back(i);
  }
  if (good.empty()) throw UsdaFault{"has no value that can be used", 0};
  out.how = primvar.interpolation();
  out.guessed = primvar.guessed();
  out.mended = bad.size();
  if (bad.empty()) {
    out.values = std::move(good);
    return out;
  }
  out.values.assign(primvar.elements(), mend(good));
  for (size_t i = 0, next_good = 0, next_bad = 0; i < out.values.size(); ++i)
    if (next_bad < bad.size() && bad[next_bad] == i)
      ++next_bad;
    else
      out.values[i] = good[next_good++];
  return out;
}

/// Values of the first property among `names` that is usable.
template <class Value, class ValueOf, class Mend>
UsdaValues<Value> firstUsable(const UsdaStage& stage, size_t prim, const UsdaCurves& curves,
                              const std::vector<std::string>& names, UsdaPrimvar::Interpolation otherwise,
                              const ValueOf& valueOf, const Mend& mend) {
  std::string first_fault;
  for (const std::string& name : names) {
    try {
      if (const auto primvar = UsdaPrimvar::of(stage, prim, name, curves, otherwise))
        return usableValues<Value>(*primvar, valueOf, mend);
    } catch (const UsdaFault& fault) {
      if (first_fault.empty()) first_fault = fmt::format("{} {}", name, fault.what);
    }
  }
  UsdaValues<Value> none;
  none.fault = first_fault;
  return none;
}

}  // namespace

const std::vector<std::string>& usdaWidthNames() {
  static const std::vector<std::string> kNames = {"primvars:widths", "widths"};
  return kNames;
}
const std::vector<std::string>& usdaUvNames() {
  // Names of OpenUSD, then those of Blender, Maya, Unreal and Houdini.
  static const std::vector<std::string> kNames = {"primvars:st",
                                                  "primvars:uv",
                                                  "primvars:st0",
                                                  "primvars:uv0",
                                                  "primvars:UVMap",
                                                  "primvars:map1",
                                                  "primvars:groom_root_uv",
                                                  "primvars:root_uv",
                                                  "primvars:rootuv",
                                                  "primvars:surface_uv_coordinate"};
  return kNames;
}

UsdaWidths usdaWidthsOf(const UsdaStage& stage, size_t prim, const UsdaCurves& curves) {
  return firstUsable<double>(
      stage, prim, curves, usdaWidthNames(), UsdaPrimvar::Interpolation::kVertex,
      [](std::span<const double> v) -> std::optional<double> {
        if (v.size() != 1) throw UsdaFault{fmt::format("has {} numbers a value", v.size()), 0};
        return v[0] >= 0 && std::isfinite(v[0]) ? std::optional(v[0]) : std::nullopt;
      },
      [](const std::vector<double>& good) {
        double sum = 0;
        for (const double width : good) sum += width / static_cast<double>(good.size());
        return sum;
      });
}

UsdaUvs usdaUvsOf(const UsdaStage& stage, size_t prim, const UsdaCurves& curves) {
  return firstUsable<Eigen::Vector2d>(
      stage, prim, curves, usdaUvNames(), UsdaPrimvar::Interpolation::kConstant,
      [](std::span<const double> v) -> std::optional<Eigen::Vector2d> {
        if (v.size() < 2) throw UsdaFault{"has one number a value, no pair", 0};
        const Eigen::Vector2d uv(v[0], v[1]);
        return uv.cast<float>().allFinite() ? std::optional(uv) : std::nullopt;
      },
      [](const std::vector<Eigen::Vector2d>&) -> Eigen::Vector2d { return Eigen::Vector2d::Zero(); });
}

}  // namespace strandcast
