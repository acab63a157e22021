// Universal Scene Description in its text form (https://openusd.org): reads hair from BasisCurves, writes
// linear ones.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "core/error.h"
#include "io/groom_file.h"
#include "io/usda_curves.h"
#include "io/usda_stage.h"

namespace strandcast {
namespace {

using Interpolation = UsdaPrimvar::Interpolation;
using Control = Eigen::Vector4d;  // position and width

constexpr float kUnitOfUsd = 0.01f;  // metres per unit without metersPerUnit: UsdGeomLinearUnits

std::vector<std::string> wantedProperties() {
  std::vector<std::string> wanted = {"points", "curveVertexCounts", "type", "basis", "wrap"};
  for (const std::vector<std::string>* names : {&usdaWidthNames(), &usdaUvNames()})
    wanted.insert(wanted.end(), names->begin(), names->end());
  return wanted;
}

/// Counts occurrences and keeps the first three places.
class Tally {
 public:
  template <class Place>
  void add(const Place& place) {
    if (places_.size() < 3) places_.push_back(place());
    ++count_;
  }
  size_t count() const { return count_; }
  /// "/a, /b, /c, ..."
  std::string places() const {
    return fmt::format("{}{}", fmt::join(places_, ", "), count_ > places_.size() ? ", ..." : "");
  }

 private:
  size_t count_ = 0;
  std::vector<std::string> places_;
};

/// Statistics of widths or UVs. A groom has these for all strands or for none.
struct Coverage {
  size_t prims = 0;  // prims with values
  Tally without, unusable, guessed, mended;

  template <class Value, class Place>
  void add(const UsdaValues<Value>& values, const Place& place) {
    if (values.how)
      ++prims;
    else if (values.fault.empty())
      without.add(place);
    else
      unusable.add([&] { return fmt::format("{}: {}", place(), values.fault); });
    if (values.guessed) guessed.add(place);
    if (values.mended > 0) mended.add([&] { return fmt::format("{} of {}", values.mended, place()); });
  }
  bool isWhole() const { return prims > 0 && without.count() + unusable.count() == 0; }

  void report(std::string_view what, std::string_view mend, FileReport& report) const {
    if (unusable.count() > 0)
      report.addOmission(fmt::format("{} ({})", what, unusable.places()));
    else if (prims > 0 && without.count() > 0)
      report.addOmission(fmt::format("{} (none for {})", what, without.places()));
    if (!isWhole()) return;
    if (guessed.count() > 0)
      report.warnings.push_back(
          fmt::format("{} have no interpolation, their count told it ({})", what, guessed.places()));
    if (mended.count() > 0)
      report.warnings.push_back(
          fmt::format("{} that cannot be used are {} ({})", what, mend, mended.places()));
  }
};

bool isCurves(const UsdaPrim& prim) {
  return prim.type == "BasisCurves" || prim.type == "NurbsCurves" || prim.type == "HermiteCurves";
}

/// Converts the curves of a stage into a groom.
class HairReader {
 public:
  HairReader(const UsdaText& text, UsdaStage stage, const std::string& name)
      : text_(text), stage_(std::move(stage)), name_(name) {}

  RawGroom read() {
    groom_.format = "usda";
    groom_.native_up = stage_.up == 'X' ? UpAxis::kX : stage_.up == 'Z' ? UpAxis::kZ : UpAxis::kY;
    for (size_t i = 0; i < stage_.prims.size(); ++i) {
      if (!isCurves(stage_.prims[i]) || !shows(i)) continue;
      if (stage_.prims[i].type == "BasisCurves")
        addPrim(i);
      else
        no_basis_.add([&] { return stage_.pathOf(i); });
    }
    StrandSet& strands = groom_.strands;
    if (!widths_.isWhole()) strands.radii.clear();
    if (!uvs_.isWhole()) strands.uvs.clear();
    groom_.unit_is_default = stage_.meters_per_unit == 0;
    groom_.unit_meters =
        stage_.meters_per_unit == 0 ? kUnitOfUsd : static_cast<float>(stage_.meters_per_unit);
    report();
    if (strands.strands() == 0) failEmpty();
    return std::move(groom_);
  }

 private:
  /// Whether a prim is drawn in place. Hidden prims are counted by reason.
  bool shows(size_t index) {
    const UsdaPrim& prim = stage_.prims[index];
    Tally* hidden = nullptr;
    if (!prim.is_active)
      hidden = &inactive_;
    else if (!prim.is_there)
      hidden = prim.is_abstract ? &abstract_ : &undefined_;
    else if (prim.is_prototype)
      hidden = &prototypes_;
    else if (!prim.is_visible)
      hidden = &invisible_;
    else if (prim.purpose == "guide" || prim.purpose == "proxy")
      hidden = prim.purpose == "guide" ? &guides_ : &proxies_;
    if (hidden != nullptr) hidden->add([&] { return stage_.pathOf(index); });
    return hidden == nullptr;
  }

  void addPrim(size_t index) {
    const UsdaPrim& prim = stage_.prims[index];
    try {
      if (!prim.fault.empty()) throw UsdaFault{prim.fault, prim.fault_line};
      const UsdaCurves curves(prim);
      if (curves.curves() > 0) addCurves(index, curves);
    } catch (const UsdaFault& fault) {
      recordFault(prim, fault);
      unreadable_.add([&] { return fmt::format("{}: {}", stage_.pathOf(index), fault.what); });
    }
  }
  void recordFault(const UsdaPrim& prim, const UsdaFault& fault) {
    if (!first_fault_)
      first_fault_ = UsdaFault{fmt::format("BasisCurves {:?}: {}", prim.name, fault.what), fault.line};
  }

  void addCurves(size_t index, const UsdaCurves& curves) {
    const UsdaPrim& prim = stage_.prims[index];
    StrandSet& out = groom_.strands;
    const size_t before = out.strands();
    const UsdaWidths widths = usdaWidthsOf(stage_, index, curves);
    const UsdaUvs uvs = usdaUvsOf(stage_, index, curves);
    for (size_t c = 0; c < curves.curves(); ++c) {
      if (!curves.isWhole(c)) {
        recordShortCurve(index, curves, c);
      } else if (!addCurve(prim, curves, c, widths)) {
        recordFault(prim, {fmt::format("curve {} has a point or width that is not finite", c),
                           prim.find("points")->line});
        unbounded_.add([&] { return fmt::format("{}, curve {}", stage_.pathOf(index), c); });
      } else {
        out.uvs.push_back(rootUv(index, curves, c, uvs));
      }
    }
    if (out.strands() == before) return;
    const auto place = [&] { return stage_.pathOf(index); };
    widths_.add(widths, place);
    uvs_.add(uvs, place);
    is_sampled_ = is_sampled_ || prim.is_sampled;
    for (const std::string& primvar : prim.other_primvars)
      if (primvar == "displayColor" || primvar == "displayOpacity")
        has_colors_ = true;
      else if (other_primvars_.insert(primvar).second)
        other_names_.add([&] { return printableName(primvar); });
  }

  void recordShortCurve(size_t index, const UsdaCurves& curves, size_t c) {
    const UsdaPrim& prim = stage_.prims[index];
    const size_t count = curves.pointsOf(c);
    const std::string points = count == 1 ? "1 point" : fmt::format("{} points", count);
    recordFault(prim, {fmt::format("curve {} has {}, which are no {}", c, points,
                                   curves.isLinear() ? "line" : "whole cubic segments"),
                       prim.line});
    unfit_.add([&] { return fmt::format("{}, curve {} of {}", stage_.pathOf(index), c, points); });
  }

  /// Adds a curve. Returns false, and adds nothing, if a vertex is out of range.
  bool addCurve(const UsdaPrim& prim, const UsdaCurves& curves, size_t c, const UsdaWidths& widths) {
    StrandSet& out = groom_.strands;
    const std::vector<double>& points = prim.find("points")->numbers;
    const bool moved = !prim.to_world.isApprox(Eigen::Affine3d::Identity(), 0);
    const double grown = moved ? std::cbrt(std::abs(prim.to_world.linear().determinant())) : 1;
    controls_.clear();
    for (size_t i = curves.firstPoint(c); i < curves.firstPoint(c) + curves.pointsOf(c); ++i)
      controls_.emplace_back(points[3 * i], points[3 * i + 1], points[3 * i + 2], widths.ofControl(c, i, 0));
    curves.pin(controls_);
    const size_t first = out.vertices();
    bool finite = true;
    curves.forVertices(controls_.size(), [&](const UsdaCurves::Vertex& vertex) {
      const Control control = curves.at(controls_, vertex);
      const Eigen::Vector3d place =
          moved ? prim.to_world * control.head<3>() : Eigen::Vector3d(control.head<3>());
      const double width = widths.how == Interpolation::kVarying
                               ? widths.varying(curves.firstVarying(c), vertex)
                               : control.w();
      out.positions.push_back(place.cast<float>());
      out.radii.push_back(static_cast<float>(std::max(0.5 * grown * width, 0.0)));
      finite = finite && out.positions.back().allFinite() && std::isfinite(out.radii.back());
    });
    if (!finite) {
      out.positions.resize(first);
      out.radii.resize(first);
      return false;
    }
    if (out.vertices() > std::numeric_limits<uint32_t>::max())
      text_.failAt(prim.line, "the file has more than 4294967295 strand vertices", "export it in parts");
    out.offsets.push_back(static_cast<uint32_t>(out.vertices()));
    return true;
  }

  /// UV at the start of the strand, the only one that a groom keeps.
  Vec2 rootUv(size_t index, const UsdaCurves& curves, size_t c, const UsdaUvs& uvs) {
    if (!uvs.how) return Vec2::Zero();
    const bool varying = uvs.how == Interpolation::kVarying;
    if (!varying && uvs.how != Interpolation::kVertex)
      return uvs.ofControl(c, 0, Eigen::Vector2d::Zero()).cast<float>();
    const auto first = uvs.values.begin() +
                       static_cast<std::ptrdiff_t>(varying ? curves.firstVarying(c) : curves.firstPoint(c));
    const auto last =
        first + static_cast<std::ptrdiff_t>(varying ? curves.varyingsOf(c) : curves.pointsOf(c));
    if (std::any_of(first, last, [&](const Eigen::Vector2d& uv) { return uv != *first; }))
      along_.add([&] { return stage_.pathOf(index); });
    if (varying) return first->cast<float>();
    uv_controls_.assign(first, last);
    curves.pin(uv_controls_);
    std::optional<Eigen::Vector2d> root;
    curves.forVertices(uv_controls_.size(), [&](const UsdaCurves::Vertex& vertex) {
      if (!root) root = curves.at(uv_controls_, vertex);
    });
    return root->cast<float>();
  }

  void report() {
    FileReport& out = groom_.report = std::move(stage_.report);
    const auto addOmission = [&](const Tally& tally, std::string_view one, std::string_view many) {
      if (tally.count() == 0) return;
      const std::string counted =
          tally.count() == 1 ? fmt::format("1 {}", one) : fmt::format("{} {}", tally.count(), many);
      out.addOmission(fmt::format("{} ({})", counted, tally.places()));
    };
    addOmission(inactive_, "inactive prim", "inactive prims");
    addOmission(abstract_, "prim of a class", "prims of classes");
    addOmission(undefined_, "prim of an over without a def", "prims of overs without a def");
    addOmission(invisible_, "invisible prim", "invisible prims");
    addOmission(guides_, "prim of purpose guide", "prims of purpose guide");
    addOmission(proxies_, "prim of purpose proxy", "prims of purpose proxy");
    addOmission(prototypes_, "prototype of a PointInstancer", "prototypes of PointInstancers");
    addOmission(no_basis_, "prim of curves that are no BasisCurves",
                "prims of curves that are no BasisCurves");
    addOmission(unreadable_, "prim that cannot be read", "prims that cannot be read");
    addOmission(unfit_, "curve with too few or too many points", "curves with too few or too many points");
    addOmission(unbounded_, "curve out of range", "curves out of range");
    widths_.report("widths", "the mean of the others", out);
    uvs_.report("UVs", "(0, 0)", out);
    if (along_.count() > 0 && uvs_.isWhole()) out.addOmission("UVs along the strands but those of the roots");
    if (has_colors_) out.addOmission("colours");
    addOmission(other_names_, "other primvar", "other primvars");
    if (is_sampled_) out.addOmission("time samples");
  }

  [[noreturn]] void failEmpty() const {
    if (first_fault_)
      text_.failAt(first_fault_->line, first_fault_->what,
                   "export the hair as linear, bezier, bspline or catmullRom curves that are open");
    const bool hidden = inactive_.count() + abstract_.count() + undefined_.count() + invisible_.count() +
                            guides_.count() + proxies_.count() + prototypes_.count() >
                        0;
    const std::string without = groom_.report.omissionsLine();
    throw Error(fmt::format("the file has no BasisCurves with points in them{}{}", hidden ? " that show" : "",
                            without.empty() ? "" : fmt::format(" ({})", without)),
                name_,
                hidden ? "make the hair visible, active and defined (def), and its purpose default or render"
                       : "export the hair as curves; what other files hold (references, sublayers) is not "
                         "read: usdcat --flatten");
  }

  const UsdaText& text_;
  UsdaStage stage_;
  const std::string& name_;
  RawGroom groom_;
  Tally inactive_, abstract_, undefined_, invisible_, guides_, proxies_, prototypes_, no_basis_, unreadable_,
      unfit_, unbounded_, along_, other_names_;
  Coverage widths_, uvs_;
  std::optional<UsdaFault> first_fault_;
  std::set<std::string> other_primvars_;
  bool is_sampled_ = false, has_colors_ = false;
  std::vector<Control> controls_;
  std::vector<Eigen::Vector2d> uv_controls_;
};

}  // namespace

RawGroom readUsda(std::span<const std::byte> bytes, const std::string& name) {
  UsdaText text(bytes, name);
  UsdaStage stage = readUsdaStage(text, "BasisCurves", wantedProperties());
  return HairReader(text, std::move(stage), name).read();
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
