#pragma once
#include <optional>
#include <span>
#include <string>

#include "groom/usda_curves.h"
#include "groom/usda_stage.h"

namespace strandcast {

/// The values of one primvar (or of `widths`, which is read like one) over the curves of a prim.
class UsdaPrimvar {
 public:
  enum class Interpolation { kConstant, kUniform, kVarying, kVertex };

  /// The primvar of that name, of the prim or, where it is constant, of the nearest prim above that has it;
  /// none where there is no value. Without interpolation it has `otherwise`, or where its count of values
  /// does not fit that, the first that it fits (guessed() then). Throws UsdaFault where its interpolation is
  /// not known to curves, or its values do not fit.
  static std::optional<UsdaPrimvar> of(const UsdaStage& stage, size_t prim, const std::string& name,
                                       const UsdaCurves& curves, Interpolation otherwise);

  Interpolation interpolation() const { return interpolation_; }
  bool guessed() const { return guessed_; }
  /// How many values the curves take.
  size_t elements() const { return elements_; }
  /// Numbers a value has: those of its type times `elementSize`.
  size_t components() const { return components_; }
  /// A value: index 0 of constant ones, the curve's, the varying's or the point's. Empty where the index that
  /// stands there is the unauthored one or not that of a value.
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
