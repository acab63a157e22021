// Universal Scene Description in its text form (https://openusd.org): hair as BasisCurves.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "groom/groom_encode.h"
#include "groom/groom_file.h"
#include "groom/usda_stage.h"

namespace strandcast {
namespace {

const std::vector<std::string> kWanted = {"points", "curveVertexCounts", "widths", "type", "basis",
                                          "wrap",   "primvars:st"};

using Control = Eigen::Vector4d;  // position and width
using Weights = std::array<double, 4>;

/// One prim of curves.
class Curves {
 public:
  Curves(const UsdaText& text, const UsdaPrim& prim) : text_(text), prim_(prim) {
    type_ = token("type", "cubic");
    basis_ = token("basis", "bezier");
    wrap_ = token("wrap", "nonperiodic");
    if (type_ != "cubic" && type_ != "linear") fail(fmt::format("curves of type {:?} are not known", type_));
    if (type_ == "cubic" && basis_ != "bezier" && basis_ != "bspline" && basis_ != "catmullRom")
      fail(fmt::format("curves of basis {:?} are not known", basis_));
    if (wrap_ == "periodic") fail("its curves are closed, hair has a root and a tip");
    if (wrap_ != "nonperiodic" && wrap_ != "pinned")
      fail(fmt::format("curves of wrap {:?} are not known", wrap_));
    readCounts();
    const std::vector<double>& points = numbers("points");
    if (points.size() != 3 * points_)
      fail(fmt::format("it has {} numbers for the {} points of its curves", points.size(), points_));
    widths_ = widths();
  }

  void addTo(RawGroom& groom) const {
    StrandSet& out = groom.strands;
    const std::vector<double>& points = numbers("points");
    const bool moved = !prim_.to_world.isApprox(Eigen::Affine3d::Identity(), 0);
    const double grown = moved ? std::cbrt(std::abs(prim_.to_world.linear().determinant())) : 1;
    const size_t first = out.vertices();
    std::vector<float> radii;
    std::vector<Control> controls;
    size_t at = 0;
    for (size_t c = 0; c < counts_.size(); ++c) {
      controls.clear();
      for (size_t i = 0; i < counts_[c]; ++i, ++at)
        controls.emplace_back(points[3 * at], points[3 * at + 1], points[3 * at + 2], widthOf(c, at));
      forVertices(controls, c, [&](const Control& control) {
        const Eigen::Vector3d place =
            moved ? prim_.to_world * control.head<3>() : Eigen::Vector3d(control.head<3>());
        out.positions.push_back(place.cast<float>());
        radii.push_back(static_cast<float>(0.5 * grown * control.w()));
        if (!out.positions.back().allFinite()) fail("a point is out of range");
        if (!std::isfinite(radii.back()) || radii.back() < 0) fail("a width is negative or out of range");
      });
      if (out.vertices() > std::numeric_limits<uint32_t>::max())
        fail("the file has more than 4294967295 strand vertices");
      out.offsets.push_back(static_cast<uint32_t>(out.vertices()));
    }
    if (hasWidths() && out.radii.size() == first)
      out.radii.insert(out.radii.end(), radii.begin(), radii.end());
    const std::vector<double>& uvs = numbers("primvars:st");
    if (hasUvs() && out.uvs.size() + counts_.size() == out.strands())
      for (size_t i = 0; i < uvs.size(); i += 2)
        out.uvs.emplace_back(static_cast<float>(uvs[i]), static_cast<float>(uvs[i + 1]));
  }
  bool hasWidths() const { return widths_ != Widths::kNone; }
  bool hasUvs() const { return numbers("primvars:st").size() == 2 * counts_.size(); }
  /// What of it is not read.
  bool leavesWidths() const { return !numbers("widths").empty() && !hasWidths(); }
  bool leavesUvs() const { return !numbers("primvars:st").empty() && !hasUvs(); }

 private:
  enum class Widths { kNone, kOne, kPerCurve, kPerPoint };

  [[noreturn]] void fail(const std::string& what) const {
    text_.failAt(prim_.line, fmt::format("BasisCurves {:?}: {}", prim_.name, what),
                 "export the hair as linear, bezier, bspline or catmullRom curves that are open");
  }
  const UsdaProperty* find(const std::string& name) const {
    const auto found = prim_.properties.find(name);
    return found == prim_.properties.end() ? nullptr : &found->second;
  }
  std::string token(const std::string& name, const char* otherwise) const {
    const UsdaProperty* property = find(name);
    return property != nullptr && !property->strings.empty() ? property->strings[0] : otherwise;
  }
  const std::vector<double>& numbers(const std::string& name) const {
    static const std::vector<double> kNone;
    const UsdaProperty* property = find(name);
    return property != nullptr ? property->numbers : kNone;
  }
  void readCounts() {
    const double most = static_cast<double>(numbers("points").size() / 3);
    double sum = 0;
    for (const double count : numbers("curveVertexCounts")) {
      sum += count;
      if (!(count >= 1) || count != std::floor(count) || sum > most)
        fail("curveVertexCounts has a number that is no count of its points");
      counts_.push_back(static_cast<size_t>(count));
    }
    points_ = static_cast<size_t>(sum);
  }
  Widths widths() const {
    const size_t count = numbers("widths").size();
    if (count == 0) return Widths::kNone;
    const std::string& how = find("widths")->interpolation;
    const bool any = how.empty();
    if (count == points_ && (any || how == "vertex" || (how == "varying" && type_ == "linear")))
      return Widths::kPerPoint;
    if (count == counts_.size() && (any || how == "uniform")) return Widths::kPerCurve;
    if (count == 1 && (any || how == "constant")) return Widths::kOne;
    return Widths::kNone;
  }
  double widthOf(size_t curve, size_t point) const {
    if (!hasWidths()) return 0;
    return numbers("widths")[widths_ == Widths::kOne ? 0 : widths_ == Widths::kPerCurve ? curve : point];
  }

  /// Calls give() with the vertices of a strand: points on the curve, at the ends of its segments; of bezier
  /// curves, whose segments have three points of their own, at their thirds too.
  template <class Give>
  void forVertices(std::vector<Control>& controls, size_t curve, const Give& give) const {
    if (type_ == "linear") {
      for (const Control& control : controls) give(control);
      return;
    }
    const bool bezier = basis_ == "bezier";
    if (wrap_ == "pinned" && !bezier && controls.size() > 1) {  // points beyond both ends make it reach them
      const Control before = 2 * controls[0] - controls[1];
      const Control behind = 2 * controls.back() - controls[controls.size() - 2];
      controls.insert(controls.begin(), before);
      controls.push_back(behind);
    }
    const size_t count = controls.size(), step = bezier ? 3 : 1;
    if (count < 4 || (count - 4) % step != 0)
      fail(fmt::format("curve {} has {} points, which are no whole cubic segments", curve, counts_[curve]));
    const auto at = [&](size_t first, const Weights& w) -> Control {
      return w[0] * controls[first] + w[1] * controls[first + 1] + w[2] * controls[first + 2] +
             w[3] * controls[first + 3];
    };
    constexpr double kThird = 1.0 / 27;
    constexpr Weights kOneThird = {8 * kThird, 12 * kThird, 6 * kThird, kThird};
    constexpr Weights kTwoThirds = {kThird, 6 * kThird, 12 * kThird, 8 * kThird};
    constexpr Weights kBegin = {1, 0, 0, 0}, kEnd = {0, 0, 0, 1}, kSecond = {0, 1, 0, 0},
                      kThirdOnly = {0, 0, 1, 0};
    constexpr Weights kSpline = {1.0 / 6, 4.0 / 6, 1.0 / 6, 0}, kSplineEnd = {0, 1.0 / 6, 4.0 / 6, 1.0 / 6};
    const bool spline = basis_ == "bspline";
    for (size_t first = 0; first + 4 <= count; first += step) {
      give(at(first, bezier ? kBegin : spline ? kSpline : kSecond));
      if (!bezier) continue;
      give(at(first, kOneThird));
      give(at(first, kTwoThirds));
    }
    give(at(count - 4, bezier ? kEnd : spline ? kSplineEnd : kThirdOnly));
  }

  const UsdaText& text_;
  const UsdaPrim& prim_;
  std::string type_, basis_, wrap_;
  std::vector<size_t> counts_;
  size_t points_ = 0;
  Widths widths_;
};

}  // namespace

RawGroom readUsda(std::span<const std::byte> bytes, const std::string& name) {
  UsdaText text(bytes, name);
  UsdaStage stage = readUsdaStage(text, "BasisCurves", kWanted);
  RawGroom groom;
  groom.format = "usda";
  groom.native_up = stage.up == 'X' ? UpAxis::kX : stage.up == 'Z' ? UpAxis::kZ : UpAxis::kY;
  groom.unit_meters = static_cast<float>(stage.meters_per_unit);
  const auto note = [&](bool is, const char* what) {
    if (is) stage.report.leaveOut(what);
  };
  bool widths = false, uvs = false;
  for (const UsdaPrim& prim : stage.prims) {
    note(prim.is_there && (prim.type == "NurbsCurves" || prim.type == "HermiteCurves"),
         "curves that are no BasisCurves");
    if (!prim.is_there || prim.type != "BasisCurves") continue;
    const Curves curves(text, prim);
    note(curves.leavesWidths(), "widths");
    note(curves.leavesUvs(), "UVs");
    widths = widths || curves.hasWidths();
    uvs = uvs || curves.hasUvs();
    curves.addTo(groom);
  }
  StrandSet& strands = groom.strands;
  if (strands.strands() == 0)
    throw Error("the file has no BasisCurves with points in them", name,
                "export the hair as curves; what other files hold (references, sublayers) is not read: "
                "usdcat --flatten");
  // What only some of the curves have would be undefined for the others.
  if (strands.radii.size() != strands.vertices()) strands.radii.clear();
  if (strands.uvs.size() != strands.strands()) strands.uvs.clear();
  note(widths && strands.radii.empty(), "widths");
  note(uvs && strands.uvs.empty(), "UVs");
  groom.report = std::move(stage.report);
  return groom;
}

std::vector<std::byte> encodeUsda(const StrandSet& strands, float unit_meters, const std::string& name) {
  if (strands.strands() == 0)
    throw Error("there are no strands to write", name, "choose a groom with strands");
  std::string text = "#usda 1.0\n(\n    defaultPrim = \"hair\"\n    doc = \"written by Strandcast\"\n";
  const auto out = std::back_inserter(text);
  if (unit_meters > 0) fmt::format_to(out, "    metersPerUnit = {}\n", unit_meters);
  text += "    upAxis = \"Y\"\n)\n\ndef BasisCurves \"hair\"\n{\n    int[] curveVertexCounts = [";
  for (size_t s = 0; s < strands.strands(); ++s)
    fmt::format_to(out, "{}{}", s > 0 ? ", " : "", strands.verticesOf(s));
  const bool has_radii = strands.radii.size() == strands.vertices();
  Box extent;
  for (size_t i = 0; i < strands.vertices(); ++i) {
    const Eigen::Vector3f around = Eigen::Vector3f::Constant(has_radii ? strands.radii[i] : 0);
    extent.extend(Eigen::Vector3f(strands.positions[i] - around));
    extent.extend(Eigen::Vector3f(strands.positions[i] + around));
  }
  const auto point = [&](const Eigen::Vector3f& p) {
    fmt::format_to(out, "({}, {}, {})", p.x(), p.y(), p.z());
  };
  text += "]\n    float3[] extent = [";
  point(extent.min());
  text += ", ";
  point(extent.max());
  text += "]\n    point3f[] points = [";
  for (size_t i = 0; i < strands.vertices(); ++i) {
    if (i > 0) text += ", ";
    point(strands.positions[i]);
  }
  text += "]\n    uniform token type = \"linear\"\n    uniform token wrap = \"nonperiodic\"\n";
  if (has_radii) {
    text += "    float[] widths = [";
    for (size_t i = 0; i < strands.radii.size(); ++i)
      fmt::format_to(out, "{}{}", i > 0 ? ", " : "", 2 * strands.radii[i]);
    text += "] (\n        interpolation = \"vertex\"\n    )\n";
  }
  if (!strands.uvs.empty()) {
    text += "    texCoord2f[] primvars:st = [";
    for (size_t i = 0; i < strands.uvs.size(); ++i)
      fmt::format_to(out, "{}({}, {})", i > 0 ? ", " : "", strands.uvs[i].x(), strands.uvs[i].y());
    text += "] (\n        interpolation = \"uniform\"\n    )\n";
  }
  text += "}\n";
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

}  // namespace strandcast
