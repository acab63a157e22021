#include "io/usda_xform.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace strandcast {
namespace {

constexpr std::string_view kResetXformStack = "!resetXformStack!", kInvertOp = "!invert!";
constexpr std::string_view kXformOp = "xformOp:";

/// One operation of a prim.
class XformOp {
 public:
  XformOp(std::string_view name, const UsdaProperty& property) : name_(name), property_(property) {}

  Eigen::Affine3d matrix() const {
    if (!property_.misfit.empty()) fail(fmt::format("{:?} {}", name_, property_.misfit));
    for (const double number : property_.numbers)
      if (!std::isfinite(number)) fail(fmt::format("{:?} has a number that is not finite", name_));
    std::string_view kind = name_.substr(std::min(kXformOp.size(), name_.size()));
    kind = kind.substr(0, kind.find(':'));  // a suffix distinguishes operations of one kind
    if (kind == "orient") return orient();
    if (kind == "transform") return transform();
    for (const std::string_view verb : {"translate", "scale", "rotate"})
      if (kind.starts_with(verb)) return alongAxes(verb, kind.substr(verb.size()));
    unknown();
  }
  [[noreturn]] void fail(const std::string& what) const { throw UsdaFault{what, property_.line}; }

 private:
  [[noreturn]] void unknown() const { fail(fmt::format("there is no transform {:?}", name_)); }

  const std::vector<double>& numbers(size_t count) const {
    if (property_.numbers.size() != count)
      fail(fmt::format("{:?} has {} numbers, it takes {}", name_, property_.numbers.size(), count));
    return property_.numbers;
  }

  Eigen::Affine3d orient() const {
    const std::vector<double>& q = numbers(4);  // the real part comes first
    Eigen::Affine3d out = Eigen::Affine3d::Identity();
    out.rotate(Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized());
    return out;
  }
  Eigen::Affine3d transform() const {
    const std::vector<double>& m = numbers(16);  // for row vectors
    Eigen::Affine3d out = Eigen::Affine3d::Identity();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) out(r, c) = m[static_cast<size_t>(4 * c + r)];
    return out;
  }

  /// Reads "translate", "scaleY", "rotateZXY" and the like: one number per axis.
  Eigen::Affine3d alongAxes(std::string_view verb, std::string_view axes) const {
    const bool rotates = verb == "rotate";
    constexpr std::array<std::string_view, 9> kAxes = {"X",   "Y",   "Z",   "XYZ", "XZY",
                                                       "YXZ", "YZX", "ZXY", "ZYX"};
    const bool one = axes.size() == 1;
    if (rotates || one) {
      if (std::find(kAxes.begin(), kAxes.end(), axes) == kAxes.end()) unknown();
    } else if (!axes.empty()) {
      unknown();
    }
    const std::vector<double>& v = numbers(one ? 1 : 3);
    Eigen::Affine3d out = Eigen::Affine3d::Identity();
    if (rotates) {
      for (size_t i = axes.size(); i-- > 0;) {  // the first axis is applied first
        const auto axis = static_cast<size_t>(axes[i] - 'X');
        out.rotate(Eigen::AngleAxisd(v[one ? 0 : axis] * std::numbers::pi / 180,
                                     Eigen::Vector3d::Unit(static_cast<Eigen::Index>(axis))));
      }
      return out;
    }
    const double none = verb == "scale" ? 1 : 0;
    Eigen::Vector3d along = Eigen::Vector3d::Constant(none);
    if (one)
      along[axes[0] - 'X'] = v[0];
    else
      along = {v[0], v[1], v[2]};
    if (verb == "scale")
      out.scale(along);
    else
      out.translate(along);
    return out;
  }

  std::string_view name_;
  const UsdaProperty& property_;
};

}  // namespace

UsdaPlacement usdaPlacementOf(const UsdaPrim& prim, const Eigen::Affine3d& above) {
  UsdaPlacement out{above, {}};
  const UsdaProperty* order = prim.find("xformOpOrder");
  if (order == nullptr) return out;
  for (std::string_view name : order->strings) {
    if (name == kResetXformStack) {  // discards all operations before it, too
      out.to_world.setIdentity();
      continue;
    }
    const bool inverse = name.starts_with(kInvertOp);
    if (inverse) name.remove_prefix(kInvertOp.size());
    const UsdaProperty* property = prim.find(name);
    if (property == nullptr || !property->has_value) {
      out.missing.emplace_back(name);
      continue;
    }
    const XformOp op(name, *property);
    const Eigen::Affine3d own = op.matrix();
    if (inverse && own.linear().determinant() == 0) op.fail(fmt::format("{:?} cannot be inverted", name));
    out.to_world = out.to_world * (inverse ? own.inverse() : own);
  }
  if (!out.to_world.matrix().allFinite()) throw UsdaFault{"its transforms are out of range", order->line};
  return out;
}

}  // namespace strandcast
