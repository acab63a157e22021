#include "io/usda_primvar.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace strandcast {
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

}  // namespace strandcast
