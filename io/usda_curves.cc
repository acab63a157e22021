#include "io/usda_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace strandcast {
UsdaCurves::UsdaCurves(const UsdaPrim& prim) {
  const auto fail = [&](const std::string& what) { throw UsdaFault{what, prim.line}; };
  const std::string type = prim.token("type", "cubic"), basis = prim.token("basis", "bezier"),
                    wrap = prim.token("wrap", "nonperiodic");
  linear_ = type == "linear";
  if (type != "cubic" && !linear_) fail(fmt::format("curves of type {:?} are not known", type));
  if (basis == "bspline")
    basis_ = Basis::kBspline;
  else if (basis == "catmullRom")
    basis_ = Basis::kCatmullRom;
  else if (basis != "bezier" && !linear_)
    fail(fmt::format("curves of basis {:?} are not read", basis));
  if (wrap == "periodic") fail("its curves are closed, hair has a root and a tip");
  pinned_ = wrap == "pinned";
  if (!pinned_ && wrap != "nonperiodic") fail(fmt::format("curves of wrap {:?} are not known", wrap));

  const UsdaProperty* points = prim.find("points");
  const UsdaProperty* counts = prim.find("curveVertexCounts");
  for (const std::string_view name : {"points", "curveVertexCounts"})
    if (const UsdaProperty* property = prim.find(name); property != nullptr && !property->misfit.empty())
      throw UsdaFault{fmt::format("{} {}", name, property->misfit), property->line};
  const size_t numbers = points == nullptr ? 0 : points->numbers.size();
  const auto most = static_cast<double>(numbers / 3);
  double sum = 0;
  if (counts != nullptr)
    for (const double count : counts->numbers) {
      sum += count;
      if (!(count >= 0) || count != std::floor(count) || sum > most)
        fail("curveVertexCounts has a number that is no count of its points");
      counts_.push_back(static_cast<size_t>(count));
      first_point_.push_back(first_point_.back() + counts_.back());
      first_varying_.push_back(first_varying_.back() + varyingsFor(counts_.back()));
    }
  if (numbers != 3 * first_point_.back())
    fail(fmt::format("it has {} numbers for the {} points of its curves", numbers, first_point_.back()));
}

size_t UsdaCurves::varyingsFor(size_t count) const {
  if (linear_) return count;
  if (pinned_ && basis_ != Basis::kBezier) return (count > 2 ? count - 2 : 0) + 2;
  return (count > 4 ? count - 4 : 0) / stride() + 2;
}

bool UsdaCurves::isWhole(size_t curve) const {
  const size_t count = counts_[curve];
  if (linear_ || (pinned_ && basis_ != Basis::kBezier)) return count >= 2;
  return count >= 4 && (count - 4) % stride() == 0;
}

std::array<double, 4> UsdaCurves::beginWeights() const {
  if (basis_ == Basis::kBezier) return {1, 0, 0, 0};
  if (basis_ == Basis::kBspline) return {1.0 / 6, 4.0 / 6, 1.0 / 6, 0};
  return {0, 1, 0, 0};
}
std::array<double, 4> UsdaCurves::endWeights() const {
  if (basis_ == Basis::kBezier) return {0, 0, 0, 1};
  if (basis_ == Basis::kBspline) return {0, 1.0 / 6, 4.0 / 6, 1.0 / 6};
  return {0, 0, 1, 0};
}

namespace {

constexpr std::array<std::string_view, 4> kInterpolations = {"constant", "uniform", "varying", "vertex"};

size_t valuesOf(const UsdaCurves& curves, UsdaPrimvar::Interpolation interpolation) {
  switch (interpolation) {
    case UsdaPrimvar::Interpolation::kUniform:
      return curves.curves();
    case UsdaPrimvar::Interpolation::kVarying:
      return curves.varyings();
    case UsdaPrimvar::Interpolation::kVertex:
      return curves.points();
    default:
      return 1;
  }
}

}  // namespace

std::optional<UsdaPrimvar> UsdaPrimvar::of(const UsdaStage& stage, size_t prim, const std::string& name,
                                           const UsdaCurves& curves, Interpolation otherwise) {
  const UsdaPrim* owner = &stage.prims[prim];
  const UsdaProperty* property = owner->find(name);
  if (property == nullptr || !property->has_value) {
    if (owner->constant_primvars == nullptr) return std::nullopt;
    const auto found = owner->constant_primvars->find(name);
    if (found == owner->constant_primvars->end()) return std::nullopt;
    owner = &stage.prims[found->second];
    property = owner->find(name);
  }
  if (!property->misfit.empty()) throw UsdaFault{property->misfit, property->line};
  UsdaPrimvar out;
  const double element = property->element_size.value_or(1);
  if (!(element >= 1 && element <= 1024) || element != std::floor(element))
    throw UsdaFault{fmt::format("has an elementSize of {}", element), property->line};
  out.components_ = usdaNumbersOf(property->type) * static_cast<size_t>(element);
  out.values_ = property->numbers;
  if (!property->strings.empty() || out.values_.size() % out.components_ != 0)
    throw UsdaFault{
        fmt::format("has {} numbers, which are no values of {}", out.values_.size(), out.components_),
        property->line};
  out.unauthored_ = property->unauthored_index.value_or(-1);
  const UsdaProperty* indices = owner->find(name + ":indices");
  out.indexed_ = indices != nullptr && indices->has_value;
  if (out.indexed_ && !indices->misfit.empty())
    throw UsdaFault{fmt::format("has indices and each {}", indices->misfit), indices->line};
  if (out.indexed_) out.indices_ = indices->numbers;
  out.choose(*property, curves, otherwise);
  return out;
}

void UsdaPrimvar::choose(const UsdaProperty& property, const UsdaCurves& curves, Interpolation otherwise) {
  const size_t count = indexed_ ? indices_.size() : values_.size() / components_;
  const std::string& how = property.interpolation;
  if (how.empty()) {
    interpolation_ = otherwise;
    elements_ = count;
    if (count == valuesOf(curves, otherwise)) return;
    guessed_ = true;
    for (const Interpolation other :
         {Interpolation::kUniform, Interpolation::kVertex, Interpolation::kVarying, Interpolation::kConstant})
      if (count == valuesOf(curves, other)) {
        interpolation_ = other;
        return;
      }
    throw UsdaFault{fmt::format("has {} values and no interpolation that fits them", count), property.line};
  }
  const auto* found = std::find(kInterpolations.begin(), kInterpolations.end(), how);
  if (found == kInterpolations.end())
    throw UsdaFault{fmt::format("has {:?} interpolation, which curves do not have", how.substr(0, 32)),
                    property.line};
  interpolation_ = static_cast<Interpolation>(found - kInterpolations.begin());
  elements_ = valuesOf(curves, interpolation_);
  if (count != elements_)
    throw UsdaFault{fmt::format("has {} values where {} interpolation takes {}", count, how, elements_),
                    property.line};
}

std::span<const double> UsdaPrimvar::at(size_t element) const {
  const size_t count = values_.size() / components_;
  if (indexed_) {
    const double index = indices_[element];
    if (index == unauthored_ || !(index >= 0 && index < static_cast<double>(count)) ||
        index != std::floor(index))
      return {};
    element = static_cast<size_t>(index);
  }
  return values_.subspan(element * components_, components_);
}

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
