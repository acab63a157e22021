#include "io/usda_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

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

namespace {

constexpr std::string_view kSamples = ".timeSamples", kIndicesSuffix = ":indices", kPrimvars = "primvars:";
constexpr size_t kDeepest = 1000;        // depth of nested prims
constexpr size_t kDeepestVariants = 64;  // depth of nested variant sets: each level is scanned once more
constexpr size_t kMaxListedNames = 3;    // names listed in a report
constexpr std::array<std::string_view, 9> kScalars = {"float", "double", "half",  "int", "uint",
                                                      "int64", "uint64", "uchar", "bool"};

template <class List>
bool holds(const List& list, std::string_view what) {
  return std::find(list.begin(), list.end(), what) != list.end();
}

/// An open block: a prim, a variant set, or a selected variant.
struct OpenBlock {
  enum class Kind { kPrim, kVariantSet, kVariant } kind = Kind::kPrim;
  size_t prim = 0;
  bool weak = false;  // inside a variant
  size_t number = 0;  // running number of blocks, from 1

  /// A variant set of a prim or variant. Its block is read after the rest of the prim or variant, so that
  /// stronger opinions come first.
  struct VariantSet {
    size_t order;    // rank of strength, 0 is the strongest
    UsdaText block;  // the text after its opening bracket
    std::string name;
  };
  std::vector<VariantSet> sets;
  bool is_ordered = false;  // `sets` is sorted, the strongest last

  // For a variant set:
  std::string selection;
  std::optional<UsdaText> back;  // where reading continues after the set
};

/// State of a prim while it is read.
struct PrimSpecs {
  bool defined = false, abstract = false, weak = false;
  std::optional<bool> active;                                  // empty if not stated
  std::map<std::string, std::string, std::less<>> selections;  // set name -> selected variant
  std::map<std::string, size_t, std::less<>> set_order;        // rank in `variantSets`, 0 is the strongest
  size_t next_order = 0;

  /// Adds opinions of weaker specs.
  void mergeWeaker(const PrimSpecs& weaker) {
    if (!defined && !abstract) {
      defined = weaker.defined;
      abstract = weaker.abstract;
    }
    if (!active) active = weaker.active;
    selections.insert(weaker.selections.begin(), weaker.selections.end());
    for (const auto& [name, order] : weaker.set_order) set_order.try_emplace(name, next_order + order);
    next_order += weaker.next_order;
    weak = weak && weaker.weak;
  }
};

class StageReader {
 public:
  StageReader(UsdaText& text, std::string_view wanted, const std::vector<std::string>& properties)
      : text_(text), wanted_(wanted), wanted_properties_(properties) {}

  UsdaStage read() {
    if (text_.acceptMark('(')) readMetadata([&](std::string_view key, bool) { return readOfLayer(key); });
    while (text_.kind() != UsdaText::Kind::kEnd) {
      if (text_.isMark('}')) {
        if (open_.empty()) text_.fail("there is a '}' too many");
        close();
      } else if (!acceptSeparator() && !readVariant() && !readPrim() && !deferVariants() && !readReorder()) {
        if (open_.empty()) text_.fail("there should be a prim (def, over or class)");
        readProperty(stage_.prims[open_.back().prim]);
      }
    }
    if (!open_.empty())
      text_.fail(fmt::format("the file ends within prim {:?}", stage_.prims[open_.back().prim].name));
    for (size_t i = 0; i < stage_.prims.size(); ++i) inherit(i);
    report();
    return std::move(stage_);
  }

 private:
  bool acceptSeparator() { return text_.acceptMark(';'); }

  /// Reads metadata after its opening bracket. `read(key, removes)` reads the value of a key, or returns
  /// false to have it skipped. `removes`: the key follows `delete` or `reorder`, which add nothing.
  template <class Read>
  void readMetadata(const Read& read) {
    bool removes = false;
    while (!text_.acceptMark(')')) {
      if (text_.kind() == UsdaText::Kind::kEnd) text_.fail("the file ends within metadata");
      if (text_.acceptMark(';') || text_.acceptMark(',')) continue;
      const bool is_word = text_.kind() == UsdaText::Kind::kWord;
      const std::string key(is_word ? text_.text() : std::string_view());
      text_.skipValue();  // the key, or a comment
      const bool is_key = is_word && text_.acceptMark('=');
      if (is_key && !read(key, removes)) text_.skipValue();
      removes = !is_key && (key == "delete" || key == "reorder");
    }
  }
  bool readOfLayer(std::string_view key) {
    if (key == "metersPerUnit") {
      const std::vector<double> unit = text_.readNumbers();
      if (unit.empty()) return true;
      if (unit.size() != 1 || !(unit[0] >= 1e-9 && unit[0] <= 1e9))
        text_.fail("metersPerUnit is out of range");
      stage_.meters_per_unit = unit[0];
      return true;
    }
    if (key == "upAxis") {
      const std::vector<std::string> up = text_.readStrings();
      if (up.empty()) return true;
      if (up.size() != 1 || (up[0] != "X" && up[0] != "Y" && up[0] != "Z"))
        text_.fail("upAxis is none of X, Y, Z");
      stage_.up = up[0][0];
      return true;
    }
    if (key != "subLayers") return false;
    addTo(sublayers_, text_.readTargets());
    return true;
  }

  bool readPrim() {
    const bool defines = text_.isWord("def"), abstract = text_.isWord("class");
    if (!defines && !abstract && !text_.isWord("over")) return false;
    UsdaPrim prim;
    PrimSpecs specs;
    specs.defined = defines;
    specs.abstract = abstract;
    prim.line = text_.line();
    text_.next();
    if (text_.kind() == UsdaText::Kind::kWord) {
      prim.type = text_.text();
      text_.next();
    }
    prim.name = text_.readString();
    if (text_.acceptMark('('))
      readMetadata([&](std::string_view key, bool removes) { return readOfPrim(specs, key, removes); });
    text_.expectMark('{');
    if (open_.size() == kDeepest)
      text_.fail(fmt::format("prims lie more than {} deep in one another", kDeepest));
    if (!open_.empty()) {
      prim.parent = open_.back().prim;
      specs.weak = open_.back().weak;
    }
    const bool weak = specs.weak;
    open(OpenBlock::Kind::kPrim, add(std::move(prim), std::move(specs)), weak);
    return true;
  }
  bool readOfPrim(PrimSpecs& specs, std::string_view key, bool removes) {
    if (key == "active") {
      if (!specs.active) specs.active = !(text_.isWord("false") || text_.isWord("no") || text_.text() == "0");
      return false;
    }
    if (key == "variantSets") {
      for (const std::string& name : text_.readStrings())
        if (!removes) specs.set_order.try_emplace(name, specs.next_order++);
      return true;
    }
    if (key == "variants") {
      readSelections(specs);
      return true;
    }
    if (key != "references" && key != "payload" && key != "inherits" && key != "specializes") return false;
    const std::vector<std::string> targets = text_.readTargets();
    if (!removes) addTo(references_, targets);
    return true;
  }
  /// Reads for example { string style = "long" }.
  void readSelections(PrimSpecs& specs) {
    text_.expectMark('{');
    while (!text_.acceptMark('}')) {
      if (text_.kind() == UsdaText::Kind::kEnd) text_.fail("the file ends within the selected variants");
      if (text_.acceptMark(';') || text_.acceptMark(',')) continue;
      std::string set(text_.text());
      text_.next();
      if (!text_.acceptMark('=')) continue;  // it was the type
      specs.selections.try_emplace(set, text_.readString());
    }
  }
  /// Adds a prim, or merges it into a prim of the same path: a variant may add opinions to an existing prim.
  size_t add(UsdaPrim prim, PrimSpecs specs) {
    const auto [place, is_new] = children_.try_emplace({prim.parent, prim.name}, stage_.prims.size());
    const size_t same = place->second;
    if (is_new || (!specs.weak && !specs_[same].weak)) {
      stage_.prims.push_back(std::move(prim));
      specs_.push_back(std::move(specs));
      return stage_.prims.size() - 1;
    }
    UsdaPrim& known = stage_.prims[same];  // stronger: deferVariants() ensures the order
    if (known.type.empty()) known.type = prim.type;
    specs_[same].mergeWeaker(specs);
    return same;
  }

  void open(OpenBlock::Kind kind, size_t prim, bool weak) {
    OpenBlock block;
    block.kind = kind;
    block.prim = prim;
    block.weak = weak;
    block.number = ++blocks_;
    open_.push_back(std::move(block));
  }
  /// At the closing bracket of the innermost block: opens its next variant set, or leaves the block.
  void close() {
    OpenBlock& block = open_.back();
    if (!block.sets.empty()) return openVariants(block);
    if (block.kind == OpenBlock::Kind::kVariantSet)
      text_ = std::move(*block.back);
    else
      text_.next();
    open_.pop_back();
  }
  /// Skips the block of a variant set; close() opens it later.
  bool deferVariants() {
    if (open_.empty() || !text_.acceptWord("variantSet")) return false;
    std::string name(text_.readString());
    text_.expectMark('=');
    if (!text_.isMark('{')) text_.fail("there should be a '{'");
    UsdaText block = text_;
    block.next();
    open_.back().sets.push_back({0, std::move(block), std::move(name)});
    text_.skipValue();
    return true;
  }
  void openVariants(OpenBlock& block) {
    const PrimSpecs& specs = specs_[block.prim];
    if (!block.is_ordered) {
      for (OpenBlock::VariantSet& set : block.sets) {
        const auto order = specs.set_order.find(set.name);
        set.order = order == specs.set_order.end() ? std::numeric_limits<size_t>::max() : order->second;
      }
      std::stable_sort(block.sets.begin(), block.sets.end(),
                       [](const auto& a, const auto& b) { return a.order < b.order; });
      std::reverse(block.sets.begin(), block.sets.end());
      block.is_ordered = true;
    }
    const auto is_set = [](const OpenBlock& one) { return one.kind == OpenBlock::Kind::kVariantSet; };
    if (open_.size() == kDeepest ||
        std::count_if(open_.begin(), open_.end(), is_set) == static_cast<std::ptrdiff_t>(kDeepestVariants))
      text_.fail(fmt::format("variant sets lie more than {} deep in one another", kDeepestVariants));
    OpenBlock::VariantSet set = std::move(block.sets.back());
    block.sets.pop_back();
    const auto selected = specs.selections.find(set.name);
    open(OpenBlock::Kind::kVariantSet, block.prim, true);
    if (selected != specs.selections.end()) open_.back().selection = selected->second;
    open_.back().back = std::exchange(text_, std::move(set.block));
  }
  /// Reads one variant of the open set.
  bool readVariant() {
    if (open_.empty() || open_.back().kind != OpenBlock::Kind::kVariantSet) return false;
    const size_t prim = open_.back().prim;
    const bool selected = text_.readString() == open_.back().selection;
    if (text_.acceptMark('('))
      readMetadata([&](std::string_view key, bool removes) {
        return selected && readOfPrim(specs_[prim], key, removes);
      });
    if (!text_.isMark('{')) text_.fail("there should be a '{'");
    if (selected) {
      text_.next();
      open(OpenBlock::Kind::kVariant, prim, true);
    } else {
      stage_.report.addOmission("variants that are not selected");
      text_.skipValue();
    }
    return true;
  }
  /// Skips "reorder nameChildren = [...]" and "reorder rel targets = [...]".
  bool readReorder() {
    if (!text_.acceptWord("reorder")) return false;
    while (text_.kind() == UsdaText::Kind::kWord) text_.next();
    text_.expectMark('=');
    text_.skipValue();
    return true;
  }

  void readProperty(UsdaPrim& prim) {
    constexpr std::array<std::string_view, 8> kBefore = {"custom",  "uniform", "varying", "config",
                                                         "prepend", "append",  "delete",  "add"};
    while (text_.kind() == UsdaText::Kind::kWord && holds(kBefore, text_.text())) text_.next();
    if (text_.kind() != UsdaText::Kind::kWord) text_.fail("there should be a property");
    const std::string type(text_.text());  // or `rel`
    text_.next();
    if (text_.acceptMark('[')) text_.expectMark(']');
    if (text_.kind() != UsdaText::Kind::kWord) text_.fail("there should be the name of a property");
    std::string name(text_.text());
    const size_t line = text_.line();
    text_.next();
    const bool sampled = name.ends_with(kSamples);
    if (sampled) name.resize(name.size() - kSamples.size());
    // An `over` without a type may turn out to be of the wanted type, by a weaker `def`.
    const bool may_be_wanted = prim.type.empty() || prim.type == wanted_;
    UsdaProperty* property = isKept(name, may_be_wanted) ? &prim.properties[name] : nullptr;
    if (property != nullptr && property->line == 0) {
      property->type = type;
      property->line = line;
    }
    if (text_.acceptMark('=')) {
      if (may_be_wanted) noteOther(prim, name);
      const size_t block = open_.back().number;
      if (property == nullptr || (property->source != 0 && property->source != block)) {
        text_.skipValue();  // a stronger block has set the value
      } else {
        property->source = block;
        if (sampled)
          readSamples(*property, type, line);
        else
          readDefault(*property, type, line);
      }
    }
    if (text_.acceptMark('('))
      readMetadata(
          [&](std::string_view key, bool) { return property != nullptr && readOfProperty(*property, key); });
  }
  bool isKept(std::string_view name, bool wanted_prim) const {
    if (name.starts_with("xformOp:")) return name.find('.') == std::string_view::npos;
    if (name == "xformOpOrder" || name == "visibility" || name == "purpose") return true;
    const bool primvar = name.starts_with(kPrimvars);
    if (primvar && name.ends_with(kIndicesSuffix)) name.remove_suffix(kIndicesSuffix.size());
    return (primvar || wanted_prim) && holds(wanted_properties_, name);
  }
  void noteOther(UsdaPrim& prim, std::string_view name) const {
    if (!name.starts_with(kPrimvars) || name.ends_with(kIndicesSuffix)) return;
    if (name.find('.') != std::string_view::npos || holds(wanted_properties_, name)) return;
    prim.other_primvars.emplace(name.substr(kPrimvars.size()));
  }
  bool readOfProperty(UsdaProperty& property, std::string_view key) {
    if (key == "interpolation") {
      const std::vector<std::string> how = text_.readStrings();
      if (how.size() == 1 && property.interpolation.empty()) property.interpolation = how[0];
      return true;
    }
    if (key != "elementSize" && key != "unauthoredValuesIndex") return false;
    const std::vector<double> number = text_.readNumbers();
    std::optional<double>& known = key == "elementSize" ? property.element_size : property.unauthored_index;
    if (number.size() == 1 && !known) known = number[0];
    return true;
  }
  void readDefault(UsdaProperty& property, const std::string& type, size_t line) {
    property.line = line;
    property.sampled = false;
    readValue(property, type);
  }
  /// Keeps the earliest sample that is not `None`.
  void readSamples(UsdaProperty& property, const std::string& type, size_t line) {
    const bool has_default = property.has_value && !property.sampled;
    property.has_samples = true;
    text_.expectMark('{');
    while (!text_.acceptMark('}')) {
      if (text_.kind() == UsdaText::Kind::kEnd) text_.fail("the file ends within time samples");
      if (text_.acceptMark(',') || text_.acceptMark(';')) continue;
      const std::vector<double> time = text_.readNumbers();
      text_.expectMark(':');
      const bool later = time.size() != 1 || (property.has_value && property.time <= time[0]);
      if (has_default || later || text_.isWord("None")) {
        text_.skipValue();
        continue;
      }
      property.line = line;
      property.sampled = true;
      property.time = time[0];
      readValue(property, type);
    }
  }
  void readValue(UsdaProperty& property, const std::string& type) {
    property.numbers.clear();
    property.strings.clear();
    property.misfit.clear();
    property.has_value = !text_.isWord("None");
    // The first element tells the type of an array.
    UsdaText ahead = text_;
    while (ahead.isMark('[') || ahead.isMark('(')) ahead.next();
    if (ahead.kind() == UsdaText::Kind::kString) {
      property.strings = text_.readStrings();
      return;
    }
    UsdaText::TupleSizes sizes;
    property.numbers = text_.readNumbers(&sizes, type == "bool");
    const size_t numbers = usdaNumbersOf(type);
    const size_t side_by_side = type.starts_with("matrix") ? sizeOfRow(numbers) : numbers;
    if (property.numbers.empty() || (numbers == 1 && !holds(kScalars, type))) return;
    if (sizes.fewest != side_by_side || sizes.most != side_by_side)
      property.misfit =
          fmt::format("has tuples of {} where {} takes {}",
                      sizes.fewest != side_by_side ? sizes.fewest : sizes.most, type, side_by_side);
  }
  static size_t sizeOfRow(size_t numbers) { return numbers == 4 ? 2 : numbers == 9 ? 3 : 4; }

  /// Sets what a prim inherits from its ancestors.
  void inherit(size_t index) {
    UsdaPrim& prim = stage_.prims[index];
    const PrimSpecs& specs = specs_[index];
    const UsdaPrim* above = prim.parent == UsdaPrim::kNoParent ? nullptr : &stage_.prims[prim.parent];
    if (prim.type != wanted_) {  // drop properties that were kept while the type was unknown
      std::erase_if(prim.properties, [&](const auto& property) { return !isKept(property.first, false); });
      prim.other_primvars.clear();
    }
    prim.is_active = specs.active.value_or(true) && (above == nullptr || above->is_active);
    prim.is_abstract = specs.abstract || (above != nullptr && above->is_abstract);
    prim.is_defined = (specs.defined || specs.abstract) && (above == nullptr || above->is_defined);
    prim.is_there = prim.is_active && prim.is_defined && !prim.is_abstract;
    prim.is_prototype = above != nullptr && (above->is_prototype || above->type == "PointInstancer");
    prim.is_visible =
        (above == nullptr || above->is_visible) && prim.token("visibility", "inherited") != "invisible";
    prim.purpose = prim.token("purpose", above == nullptr ? "default" : above->purpose);
    inheritPrimvars(prim, index, above);
    if (above != nullptr) {
      prim.is_sampled = above->is_sampled;
      prim.to_world = above->to_world;
      prim.fault = above->fault;
      prim.fault_line = above->fault_line;
    }
    for (const auto& [name, property] : prim.properties)
      prim.is_sampled = prim.is_sampled || property.has_samples;
    if (!prim.is_there || !prim.fault.empty()) return;
    if (prim.type == "Scope") {  // Scope is not a UsdGeomXformable
      if (prim.find("xformOpOrder") != nullptr)
        stage_.report.addOmission(fmt::format(
            "the transforms of Scope {}, which OpenUSD does not apply either", stage_.pathOf(index)));
      return;
    }
    try {
      UsdaPlacement placement = usdaPlacementOf(prim, prim.to_world);
      prim.to_world = placement.to_world;
      for (const std::string& op : placement.missing)
        if (missing_++ == 0)
          first_missing_ = fmt::format("{} of {}", printableName(op), stage_.pathOf(index));
    } catch (const UsdaFault& fault) {
      prim.fault = fault.what;
      prim.fault_line = fault.line;
    }
  }
  static void inheritPrimvars(UsdaPrim& prim, size_t index, const UsdaPrim* above) {
    if (above != nullptr) prim.constant_primvars = above->constant_primvars;
    const auto first = prim.properties.lower_bound(kPrimvars);
    if (first == prim.properties.end() || !first->first.starts_with(kPrimvars)) return;
    std::map<std::string, size_t, std::less<>> all;
    if (prim.constant_primvars != nullptr) all = *prim.constant_primvars;
    bool differs = false;
    for (const auto& [name, property] : prim.properties) {
      if (!name.starts_with(kPrimvars) || name.ends_with(kIndicesSuffix) || !property.has_value) continue;
      if (property.interpolation.empty() || property.interpolation == "constant")
        all[name] = index;
      else if (all.erase(name) == 0)  // a primvar of another interpolation ends the inheritance
        continue;
      differs = true;
    }
    if (differs)
      prim.constant_primvars =
          std::make_shared<const std::map<std::string, size_t, std::less<>>>(std::move(all));
  }
  static void addTo(std::vector<std::string>& all, const std::vector<std::string>& more) {
    for (const std::string& one : more)
      if (all.size() < kMaxListedNames && !holds(all, one))
        all.push_back(one);
      else if (all.size() == kMaxListedNames && !holds(all, one))
        all.emplace_back("...");
  }
  void report() {
    if (!sublayers_.empty())
      stage_.report.addOmission(fmt::format("sublayers ({})", fmt::join(sublayers_, ", ")));
    if (!references_.empty())
      stage_.report.addOmission(fmt::format("references ({})", fmt::join(references_, ", ")));
    if (missing_ > 0)
      stage_.report.warnings.push_back(
          fmt::format("{} of xformOpOrder without a value: no transform is applied for {} ({})",
                      missing_ == 1 ? "1 operation" : fmt::format("{} operations", missing_),
                      missing_ == 1 ? "it" : "them", first_missing_));
  }

  UsdaText& text_;
  std::string_view wanted_;
  const std::vector<std::string>& wanted_properties_;
  UsdaStage stage_;
  std::vector<PrimSpecs> specs_;  // per prim of the stage
  std::map<std::pair<size_t, std::string>, size_t> children_;
  std::vector<OpenBlock> open_;
  size_t blocks_ = 0;
  std::vector<std::string> sublayers_, references_;
  size_t missing_ = 0;
  std::string first_missing_;
};

}  // namespace

const UsdaProperty* UsdaPrim::find(std::string_view property) const {
  const auto found = properties.find(property);
  return found == properties.end() ? nullptr : &found->second;
}
std::string UsdaPrim::token(std::string_view property, std::string_view otherwise) const {
  const UsdaProperty* found = find(property);
  return std::string(found != nullptr && !found->strings.empty() ? found->strings[0] : otherwise);
}

std::string UsdaStage::pathOf(size_t prim) const {
  constexpr size_t kMax = 200;
  std::string path;
  for (; prim != UsdaPrim::kNoParent && path.size() < kMax; prim = prims[prim].parent)
    path.insert(0, fmt::format("/{}", printableName(prims[prim].name)));
  if (prim == UsdaPrim::kNoParent) return path;
  size_t top = prim;
  while (prims[top].parent != UsdaPrim::kNoParent) top = prims[top].parent;
  return fmt::format("/{}/...{}", printableName(prims[top].name), path);
}

size_t usdaNumbersOf(std::string_view type) {
  if (type.starts_with("quat")) return 4;
  if (!type.empty() && std::string_view("fdh").find(type.back()) != std::string_view::npos)
    type.remove_suffix(1);  // "texCoord2f"
  if (type.size() < 2 || type.back() < '2' || type.back() > '4') return 1;
  const char before = type[type.size() - 2];
  if (before >= '0' && before <= '9') return 1;  // "int64"
  const auto count = static_cast<size_t>(type.back() - '0');
  return type.starts_with("matrix") ? count * count : count;
}

UsdaStage readUsdaStage(UsdaText& text, std::string_view wanted, const std::vector<std::string>& properties) {
  return StageReader(text, wanted, properties).read();
}

}  // namespace strandcast
