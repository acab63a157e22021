// Universal Scene Description in its text form (https://openusd.org): reads hair from BasisCurves, writes
// linear ones.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <type_traits>
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
  const std::vector<std::string> names = usdaValueNames();
  wanted.insert(wanted.end(), names.begin(), names.end());
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

/// Statistics of values that a groom has for all strands or for none. Prims may lack them if there is a value
/// that stands for none.
struct Coverage {
  bool may_lack = false;
  size_t prims = 0;     // prims with values
  bool varies = false;  // values differ along a strand
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
  bool isWhole() const { return prims > 0 && unusable.count() == 0 && (may_lack || without.count() == 0); }

  /// `mend` stands for unusable values, `kept` for those along a strand.
  void report(std::string_view what, std::string_view mend, FileReport& report,
              std::string_view kept = "those of the roots") const {
    if (unusable.count() > 0)
      report.addOmission(fmt::format("{} ({})", what, unusable.places()));
    else if (prims > 0 && without.count() > 0 && !may_lack)
      report.addOmission(fmt::format("{} (none for {})", what, without.places()));
    if (!isWhole()) return;
    if (varies) report.addOmission(fmt::format("{} along the strands but {}", what, kept));
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

/// Puts strands into groups by their id or, where the file has none, by their name.
class Grouping {
 public:
  Grouping() { ids_.may_lack = names_.may_lack = true; }

  void addPrim(const UsdaLabels& labels, const auto& place) {
    ids_.add(labels.group_ids, place);
    names_.add(labels.group_names, place);
  }
  void addStrand(int32_t id, std::string_view name) {
    const auto next = static_cast<uint32_t>(names_by_number_.size());
    const auto [known, is_new] = numbers_by_name_.try_emplace(usdaUnescaped(name), next);
    if (is_new) names_by_number_.push_back(known->first);
    strands_.push_back({id, known->second});
  }
  Coverage& ids() { return ids_; }
  Coverage& names() { return names_; }

  /// Fills the table of groups in the order of their first strands, and each strand's index.
  void finish(RawGroom& groom) {
    const bool by_id = ids_.isWhole(), has_names = names_.isWhole();
    if (!by_id && !has_names) return;
    std::map<int64_t, uint32_t> known;
    for (const Label& label : strands_) {
      const auto next = static_cast<uint32_t>(groom.groups.size());
      const auto [group, is_new] = known.try_emplace(by_id ? int64_t{label.id} : int64_t{label.name}, next);
      groom.strands.groups.push_back(group->second);
      const std::string& name = names_by_number_[has_names ? label.name : 0];
      if (is_new) groom.groups.push_back({by_id ? label.id : static_cast<int32_t>(next), name});
      std::string& first = groom.groups[group->second].name;
      if (first.empty()) first = name;
      if (!name.empty() && name != first) renamed_.insert(group->second);
    }
  }
  void report(const RawGroom& groom, FileReport& out) const {
    ids_.report("group ids", "0", out);
    names_.report("group names", "left out", out);
    Tally renamed;
    for (const uint32_t group : renamed_)
      renamed.add([&] {
        return fmt::format("{}: {}", groom.groups[group].id, printableName(groom.groups[group].name));
      });
    if (renamed.count() > 0)
      out.warnings.push_back(
          fmt::format("groups with more than one name have the first of them ({})", renamed.places()));
  }

 private:
  struct Label {
    int32_t id;
    uint32_t name;  // index into names_by_number_
  };
  Coverage ids_, names_;
  std::vector<Label> strands_;
  std::map<std::string, uint32_t> numbers_by_name_ = {{"", 0}};
  std::vector<std::string> names_by_number_ = {""};
  std::set<uint32_t> renamed_;
};

/// Converts the curves of a stage into a groom.
class HairReader {
 public:
  HairReader(const UsdaText& text, UsdaStage stage, const std::string& name)
      : text_(text), stage_(std::move(stage)), name_(name) {
    marks_.may_lack = true;
  }

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
    if (!ids_.isWhole()) strands.ids.clear();
    if (!marks_.isWhole()) strands.is_guide.clear();
    if (!colours_.isWhole()) strands.colours.clear();
    grouping_.finish(groom_);
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
    const UsdaLabels labels = usdaLabelsOf(stage_, index, curves);
    for (size_t c = 0; c < curves.curves(); ++c) {
      if (!curves.isWhole(c)) {
        recordShortCurve(index, curves, c);
      } else if (!addCurve(prim, curves, c, widths)) {
        recordFault(prim, {fmt::format("curve {} has a point or width that is not finite", c),
                           prim.find("points")->line});
        unbounded_.add([&] { return fmt::format("{}, curve {}", stage_.pathOf(index), c); });
      } else {
        out.uvs.push_back(rootUv(curves, c, uvs));
        addLabels(curves, c, labels);
      }
    }
    if (out.strands() == before) return;
    const auto place = [&] { return stage_.pathOf(index); };
    widths_.add(widths, place);
    uvs_.add(uvs, place);
    ids_.add(labels.ids, place);
    marks_.add(labels.guides, place);
    grouping_.addPrim(labels, place);
    colours_.add(labels.colours, place);
    is_sampled_ = is_sampled_ || prim.is_sampled;
    for (const std::string& primvar : prim.other_primvars)
      if (primvar == "displayOpacity")
        has_opacities_ = true;
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

  /// Values of a curve; none where its prim has none. Records whether they differ.
  template <class Value>
  static std::span<const Value> alongCurve(const UsdaCurves& curves, size_t c,
                                           const UsdaValues<Value>& values, Coverage& coverage) {
    if (!values.how) return {};
    const std::span<const Value> along = values.of(curves, c);
    coverage.varies = coverage.varies || std::any_of(along.begin(), along.end(), [&](const Value& value) {
                        return value != along.front();
                      });
    return along;
  }

  /// UV at the start of the strand, the only one that a groom keeps.
  Vec2 rootUv(const UsdaCurves& curves, size_t c, const UsdaUvs& uvs) {
    const std::span<const Eigen::Vector2d> along = alongCurve(curves, c, uvs, uvs_);
    if (along.empty()) return Vec2::Zero();
    if (uvs.how != Interpolation::kVertex) return along.front().cast<float>();
    uv_controls_.assign(along.begin(), along.end());
    curves.pin(uv_controls_);
    std::optional<Eigen::Vector2d> root;
    curves.forVertices(uv_controls_.size(), [&](const UsdaCurves::Vertex& vertex) {
      if (!root) root = curves.at(uv_controls_, vertex);
    });
    return root->cast<float>();
  }

  /// Labels of a strand: those of its root, and the mean of its colours.
  void addLabels(const UsdaCurves& curves, size_t c, const UsdaLabels& labels) {
    const auto ofRoot = [&](const auto& values, Coverage& coverage) {
      const auto along = alongCurve(curves, c, values, coverage);
      return along.empty() ? std::decay_t<decltype(along.front())>() : along.front();
    };
    StrandSet& out = groom_.strands;
    out.ids.push_back(static_cast<uint32_t>(ofRoot(labels.ids, ids_)));
    out.is_guide.push_back(static_cast<uint8_t>(ofRoot(labels.guides, marks_)));
    grouping_.addStrand(static_cast<int32_t>(ofRoot(labels.group_ids, grouping_.ids())),
                        ofRoot(labels.group_names, grouping_.names()));
    Eigen::Vector3d colour = Eigen::Vector3d::Zero();
    const std::span<const Eigen::Vector3d> colours = alongCurve(curves, c, labels.colours, colours_);
    for (const Eigen::Vector3d& one : colours) colour += one / static_cast<double>(colours.size());
    out.colours.emplace_back(colour.cast<float>());
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
    marks_.report("guide marks", "0", out);
    ids_.report("ids", "", out);
    grouping_.report(groom_, out);
    colours_.report("colours", "the mean of the others", out, "their means");
    reportRepeatedIds(out);
    if (has_opacities_) out.addOmission("opacities");
    addOmission(other_names_, "other primvar", "other primvars");
    if (is_sampled_) out.addOmission("time samples");
  }

  void reportRepeatedIds(FileReport& out) const {
    std::vector<uint32_t> ids = groom_.strands.ids;
    std::sort(ids.begin(), ids.end());
    const auto repeated = ids.end() - std::unique(ids.begin(), ids.end());
    if (repeated > 0)
      out.warnings.push_back(fmt::format("{} of the ids repeat that of an earlier strand", repeated));
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
      unfit_, unbounded_, other_names_;
  Coverage widths_, uvs_, ids_, marks_, colours_;
  Grouping grouping_;
  std::optional<UsdaFault> first_fault_;
  std::set<std::string> other_primvars_;
  bool is_sampled_ = false, has_opacities_ = false;
  std::vector<Control> controls_;
  std::vector<Eigen::Vector2d> uv_controls_;
};

}  // namespace

RawGroom readUsda(std::span<const std::byte> bytes, const std::string& name) {
  UsdaText text(bytes, name);
  UsdaStage stage = readUsdaStage(text, "BasisCurves", wantedProperties());
  return HairReader(text, std::move(stage), name).read();
}

namespace {

/// "    TYPE NAME = [VALUE(0), ...] ( interpolation = "uniform" )"
template <class Value>
void writeUniform(std::string& text, std::string_view declared, size_t count, const Value& value) {
  fmt::format_to(std::back_inserter(text), "    {} = [", declared);
  for (size_t i = 0; i < count; ++i) text += (i > 0 ? ", " : "") + value(i);
  text += "] (\n        interpolation = \"uniform\"\n    )\n";
}

/// Writes the labels that a set has, under the names of Unreal's grooms and OpenUSD.
void writeLabels(std::string& text, const StrandSet& strands, std::span<const StrandGroup> groups) {
  const auto writeNumbers = [&](std::string_view declared, const auto& numbers) {
    if (numbers.empty()) return;
    writeUniform(text, declared, numbers.size(), [&](size_t s) { return fmt::format("{}", numbers[s]); });
  };
  const bool fit_int = std::all_of(strands.ids.begin(), strands.ids.end(), [](uint32_t id) {
    return id <= uint32_t{std::numeric_limits<int32_t>::max()};
  });
  writeNumbers("int[] primvars:groom_guide", strands.is_guide);
  writeNumbers(fit_int ? "int[] primvars:groom_id" : "uint[] primvars:groom_id", strands.ids);
  if (!strands.groups.empty()) {
    std::vector<int64_t> ids;
    for (const uint32_t group : strands.groups)
      ids.push_back(group < groups.size() ? int64_t{groups[group].id} : int64_t{group});
    writeNumbers("int[] primvars:groom_group_id", ids);
    if (std::any_of(groups.begin(), groups.end(), [](const auto& group) { return !group.name.empty(); })) {
      writeUniform(text, "string[] primvars:groom_group_name", groups.size(),
                   [&](size_t g) { return fmt::format("\"{}\"", usdaEscaped(groups[g].name)); });
      text += "    int[] primvars:groom_group_name:indices = [";
      for (size_t s = 0; s < strands.groups.size(); ++s)
        fmt::format_to(std::back_inserter(text), "{}{}", s > 0 ? ", " : "", strands.groups[s]);
      text += "]\n";
    }
  }
  if (strands.colours.empty()) return;
  writeUniform(text, "color3f[] primvars:displayColor", strands.colours.size(), [&](size_t s) {
    const Vec3& c = strands.colours[s];
    return fmt::format("({}, {}, {})", c.x(), c.y(), c.z());
  });
}

}  // namespace

std::vector<std::byte> encodeUsda(const StrandSet& strands, float unit_meters, const std::string& name,
                                  std::span<const StrandGroup> groups) {
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
  if (!strands.uvs.empty())
    writeUniform(text, "texCoord2f[] primvars:st", strands.uvs.size(),
                 [&](size_t s) { return fmt::format("({}, {})", strands.uvs[s].x(), strands.uvs[s].y()); });
  writeLabels(text, strands, groups);
  text += "}\n";
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

}  // namespace strandcast
