#pragma once
#include <optional>
#include <span>
#include <string>

#include "io/usda_curves.h"
#include "io/usda_stage.h"

namespace strandcast {

/// Values of one primvar (or of `widths`, which is read like one) over the curves of a prim.
class UsdaPrimvar {
 public:
  enum class Interpolation { kConstant, kUniform, kVarying, kVertex };

  /// Finds the primvar `name` on the prim or, if constant, on the nearest ancestor that has it. None where
  /// there is no value. A primvar without interpolation has `otherwise`; where its count of values does not
  /// match that, it has the first interpolation that the count matches (guessed() is then true). Throws
  /// UsdaFault when the interpolation does not exist for curves, or the values do not match it.
  static std::optional<UsdaPrimvar> of(const UsdaStage& stage, size_t prim, const std::string& name,
                                       const UsdaCurves& curves, Interpolation otherwise);

  Interpolation interpolation() const { return interpolation_; }
  bool guessed() const { return guessed_; }
  /// Number of values for the curves of the prim.
  size_t elements() const { return elements_; }
  /// Numbers per value: those of its type times `elementSize`.
  size_t components() const { return components_; }
  /// Numbers of one value. `element` is 0 for a constant primvar, else the index of the curve, varying value
  /// or point. Empty where its index is the unauthored one or out of range.
  std::span<const double> at(size_t element) const;

 private:
  UsdaPrimvar() = default;
  void choose(const UsdaProperty& property, const UsdaCurves& curves, Interpolation otherwise);

  Interpolation interpolation_ = Interpolation::kConstant;
  bool guessed_ = false;
  size_t components_ = 1, elements_ = 1;
  std::span<const double> values_, indices_;
  bool indexed_ = false;
  double unauthored_ = -1;
};

}  // namespace strandcast
