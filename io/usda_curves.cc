#include "io/usda_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
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
                                           const UsdaCurves& curves, Interpolation otherwise, Kind kind) {
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
  out.strings_ = property->strings;
  if (kind == Kind::kStrings) {
    if (!out.values_.empty()) throw UsdaFault{"has numbers, no strings", property->line};
    out.stored_ = out.strings_.size();
  } else {
    if (!out.strings_.empty() || out.values_.size() % out.components_ != 0)
      throw UsdaFault{
          fmt::format("has {} numbers, which are no values of {}", out.values_.size(), out.components_),
          property->line};
    out.stored_ = out.values_.size() / out.components_;
  }
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
  const size_t count = indexed_ ? indices_.size() : stored_;
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

std::optional<size_t> UsdaPrimvar::stored(size_t element) const {
  if (!indexed_) return element;
  const double index = indices_[element];
  if (index == unauthored_ || !(index >= 0 && index < static_cast<double>(stored_)) ||
      index != std::floor(index))
    return std::nullopt;
  return static_cast<size_t>(index);
}

std::span<const double> UsdaPrimvar::at(size_t element) const {
  const std::optional<size_t> value = stored(element);
  return value ? values_.subspan(*value * components_, components_) : std::span<const double>();
}

const std::string* UsdaPrimvar::stringAt(size_t element) const {
  const std::optional<size_t> value = stored(element);
  return value ? &strings_[*value] : nullptr;
}

namespace {

using Names = std::span<const std::string_view>;

template <class Value>
constexpr bool kIsString = std::is_same_v<Value, std::string_view>;

/// Converts the values of a primvar. `valueOf(numbers)`, or `valueOf(string)` for strings, returns a value,
/// or none if it is unusable. `mend(good values)` returns the replacement for unusable ones. Throws UsdaFault
/// if no value is usable.
template <class Value, class ValueOf, class Mend>
UsdaValues<Value> usableValues(const UsdaPrimvar& primvar, const ValueOf& valueOf, const Mend& mend) {
  UsdaValues<Value> out;
  std::vector<Value> good;
  std::vector<size_t> bad;
  for (size_t i = 0; i < primvar.elements(); ++i) {
    std::optional<Value> value;
    if constexpr (kIsString<Value>) {
      if (const std::string* text = primvar.stringAt(i)) value = valueOf(*text);
    } else if (const std::span<const double> numbers = primvar.at(i); !numbers.empty()) {
      value = valueOf(numbers);
    }
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
UsdaValues<Value> firstUsable(const UsdaStage& stage, size_t prim, const UsdaCurves& curves, Names names,
                              UsdaPrimvar::Interpolation otherwise, const ValueOf& valueOf,
                              const Mend& mend) {
  constexpr auto kKind = kIsString<Value> ? UsdaPrimvar::Kind::kStrings : UsdaPrimvar::Kind::kNumbers;
  std::string first_fault;
  for (const std::string_view name : names) {
    try {
      if (const auto primvar = UsdaPrimvar::of(stage, prim, std::string(name), curves, otherwise, kKind))
        return usableValues<Value>(*primvar, valueOf, mend);
    } catch (const UsdaFault& fault) {
      if (first_fault.empty()) first_fault = fmt::format("{} {}", name, fault.what);
    }
  }
  UsdaValues<Value> none;
  none.fault = first_fault;
  return none;
}

// Names of properties in order of preference.
constexpr std::string_view kWidthNames[] = {"primvars:widths", "widths", "primvars:groom_width",
                                            "groom_width"};
// Names of OpenUSD, then those of Blender, Maya, Unreal and Houdini.
constexpr std::string_view kUvNames[] = {"primvars:st",
                                         "primvars:uv",
                                         "primvars:st0",
                                         "primvars:uv0",
                                         "primvars:UVMap",
                                         "primvars:map1",
                                         "primvars:groom_root_uv",
                                         "groom_root_uv",
                                         "primvars:root_uv",
                                         "primvars:rootuv",
                                         "primvars:surface_uv_coordinate"};
constexpr std::string_view kIdNames[] = {"primvars:groom_id", "groom_id"};
constexpr std::string_view kGuideNames[] = {"primvars:groom_guide", "groom_guide"};
constexpr std::string_view kGroupIdNames[] = {"primvars:groom_group_id", "groom_group_id"};
constexpr std::string_view kGroupNameNames[] = {"primvars:groom_group_name", "groom_group_name"};
constexpr std::string_view kColourNames[] = {"primvars:groom_color", "groom_color", "primvars:displayColor"};

double single(std::span<const double> v) {
  if (v.size() != 1) throw UsdaFault{fmt::format("has {} numbers a value", v.size()), 0};
  return v[0];
}

template <class Value>
Value meanOf(const std::vector<Value>& good) {
  Value sum = good[0] - good[0];
  for (const Value& value : good) sum += value / static_cast<double>(good.size());
  return sum;
}

/// Whole numbers of a range, of which none may be unusable.
UsdaValues<double> wholeNumbers(const UsdaStage& stage, size_t prim, const UsdaCurves& curves, Names names,
                                double least, double most) {
  const auto fail = [&](const std::vector<double>&) -> double {
    throw UsdaFault{fmt::format("has values that are no whole numbers from {:.0f} to {:.0f}", least, most),
                    0};
  };
  return firstUsable<double>(
      stage, prim, curves, names, UsdaPrimvar::Interpolation::kConstant,
      [&](std::span<const double> v) {
        const double number = single(v);
        const bool fits = number >= least && number <= most && number == std::floor(number);
        return fits ? std::optional(number) : std::nullopt;
      },
      fail);
}

}  // namespace

std::vector<std::string> usdaValueNames() {
  std::vector<std::string> all;
  for (const Names names : {Names(kWidthNames), Names(kUvNames), Names(kIdNames), Names(kGuideNames),
                            Names(kGroupIdNames), Names(kGroupNameNames), Names(kColourNames)})
    all.insert(all.end(), names.begin(), names.end());
  return all;
}

UsdaWidths usdaWidthsOf(const UsdaStage& stage, size_t prim, const UsdaCurves& curves) {
  return firstUsable<double>(
      stage, prim, curves, kWidthNames, UsdaPrimvar::Interpolation::kVertex,
      [](std::span<const double> v) {
        const double width = single(v);
        return width >= 0 && std::isfinite(width) ? std::optional(width) : std::nullopt;
      },
      meanOf<double>);
}

UsdaUvs usdaUvsOf(const UsdaStage& stage, size_t prim, const UsdaCurves& curves) {
  return firstUsable<Eigen::Vector2d>(
      stage, prim, curves, kUvNames, UsdaPrimvar::Interpolation::kConstant,
      [](std::span<const double> v) -> std::optional<Eigen::Vector2d> {
        if (v.size() < 2) throw UsdaFault{"has one number a value, no pair", 0};
        const Eigen::Vector2d uv(v[0], v[1]);
        return uv.cast<float>().allFinite() ? std::optional(uv) : std::nullopt;
      },
      [](const std::vector<Eigen::Vector2d>&) -> Eigen::Vector2d { return Eigen::Vector2d::Zero(); });
}

UsdaLabels usdaLabelsOf(const UsdaStage& stage, size_t prim, const UsdaCurves& curves) {
  constexpr auto kConstant = UsdaPrimvar::Interpolation::kConstant;
  UsdaLabels out;
  out.ids = wholeNumbers(stage, prim, curves, kIdNames, 0, 4294967295.0);
  out.group_ids = wholeNumbers(stage, prim, curves, kGroupIdNames, -2147483648.0, 2147483647.0);
  out.guides = firstUsable<double>(
      stage, prim, curves, kGuideNames, kConstant,
      [](std::span<const double> v) {
        const double mark = single(v);
        return std::isfinite(mark) ? std::optional(mark != 0 ? 1.0 : 0.0) : std::nullopt;
      },
      [](const std::vector<double>&) { return 0.0; });
  out.group_names = firstUsable<std::string_view>(
      stage, prim, curves, kGroupNameNames, kConstant,
      [](std::string_view name) {
        const bool fits = name.size() <= 4 * UsdaLabels::kLongestName &&  // four bytes an escape
                          usdaUnescaped(name).size() <= UsdaLabels::kLongestName;
        return fits ? std::optional(name) : std::nullopt;
      },
      [](const std::vector<std::string_view>&) { return std::string_view(); });
  out.colours = firstUsable<Eigen::Vector3d>(
      stage, prim, curves, kColourNames, kConstant,
      [](std::span<const double> v) -> std::optional<Eigen::Vector3d> {
        if (v.size() < 3)  // a fourth number is opacity
          throw UsdaFault{
              fmt::format("has {} a value, no colour", v.size() == 1 ? "one number" : "two numbers"), 0};
        const Eigen::Vector3d colour(v[0], v[1], v[2]);
        const bool fits = colour.cast<float>().allFinite() && colour.minCoeff() >= 0;
        return fits ? std::optional(colour) : std::nullopt;
      },
      meanOf<Eigen::Vector3d>);
  return out;
}

}  // namespace strandcast
