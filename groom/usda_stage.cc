#include "groom/usda_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>

namespace strandcast {
namespace {

constexpr std::string_view kOrder = "xformOpOrder", kOp = "xformOp:";
constexpr std::string_view kReset = "!resetXformStack!", kInvert = "!invert!";
constexpr std::string_view kSamples = ".timeSamples", kConnections = ".connect";
constexpr size_t kDeepest = 1000;  // prims in prims

template <class List>
bool holds(const List& list, std::string_view what) {
  return std::find(list.begin(), list.end(), what) != list.end();
}

class StageReader {
 public:
  StageReader(UsdaText& text, std::string_view wanted, const std::vector<std::string>& properties)
      : text_(text), wanted_(wanted), wanted_properties_(properties) {}

  UsdaStage read() {
    if (text_.takeMark('(')) readMetadata([&](std::string_view key) { return readOfLayer(key); });
    std::vector<size_t> above;  // the prims that are open
    while (text_.kind() != UsdaText::Kind::kEnd) {
      if (text_.isMark('}')) {
        if (above.empty()) text_.fail("there is a '}' too many");
        text_.next();
        above.pop_back();
      } else if (!takeSeparator() && !readPrim(above) && !readVariants() && !takeOrder()) {
        if (above.empty()) text_.fail("there should be a prim (def, over or class)");
        readProperty(stage_.prims[above.back()]);
      }
    }
    if (!above.empty())
      text_.fail(fmt::format("the file ends within prim {:?}", stage_.prims[above.back()].name));
    place();
    return std::move(stage_);
  }

 private:
  bool takeSeparator() { return text_.takeMark(';'); }

  /// Behind its opening bracket. `read(key)` reads the value of a key, or gives false to have it skipped.
  template <class Read>
  void readMetadata(const Read& read) {
    while (!text_.takeMark(')')) {
      if (text_.kind() == UsdaText::Kind::kEnd) text_.fail("the file ends within metadata");
      if (text_.takeMark(';') || text_.takeMark(',')) continue;
      const bool is_word = text_.kind() == UsdaText::Kind::kWord;
      const std::string key(is_word ? text_.text() : std::string_view());
      text_.skipValue();  // the key, or a comment
      if (is_word && text_.takeMark('=') && !read(key)) text_.skipValue();
    }
  }
  bool readOfLayer(std::string_view key) {
    if (key == "metersPerUnit") {
      const std::vector<double> unit = text_.takeNumbers();
      if (unit.size() != 1 || !(unit[0] >= 1e-9 && unit[0] <= 1e9))
        text_.fail("metersPerUnit is out of range");
      stage_.meters_per_unit = unit[0];
      return true;
    }
    if (key == "upAxis") {
      const std::vector<std::string> up = text_.takeStrings();
      if (up.size() != 1 || (up[0] != "X" && up[0] != "Y" && up[0] != "Z"))
        text_.fail("upAxis is none of X, Y, Z");
      stage_.up = up[0][0];
      return true;
    }
    if (key == "subLayers") stage_.report.leaveOut("sublayers");
    return false;
  }

  bool readPrim(std::vector<size_t>& above) {
    const bool defined = text_.isWord("def");
    if (!defined && !text_.isWord("over") && !text_.isWord("class")) return false;
    UsdaPrim prim;
    prim.line = text_.line();
    text_.next();
    if (text_.kind() == UsdaText::Kind::kWord) {
      prim.type = text_.text();
      text_.next();
    }
    prim.name = text_.takeString();
    bool active = true;
    if (text_.takeMark('('))
      readMetadata([&](std::string_view key) {
        if (key == "active") {
          active = !(text_.isWord("false") || text_.text() == "0");
        } else if (key == "references" || key == "payload" || key == "inherits" || key == "specializes") {
          stage_.report.leaveOut("references");
        }
        return false;
      });
    text_.expectMark('{');
    if (above.size() == kDeepest)
      text_.fail(fmt::format("prims lie more than {} deep in one another", kDeepest));
    prim.is_there = defined && active && (above.empty() || stage_.prims[above.back()].is_there);
    parents_.push_back(above.empty() ? std::nullopt : std::optional(above.back()));
    above.push_back(stage_.prims.size());
    stage_.prims.push_back(std::move(prim));
    return true;
  }

  bool readVariants() {
    if (!text_.takeWord("variantSet")) return false;
    stage_.report.leaveOut("variants");
    text_.takeString();
    text_.expectMark('=');
    text_.skipValue();
    return true;
  }
  bool takeOrder() {
    if (!text_.takeWord("reorder")) return false;
    text_.skipValue();
    text_.expectMark('=');
    text_.skipValue();
    return true;
  }

  void readProperty(UsdaPrim& prim) {
    constexpr std::array<std::string_view, 8> kBefore = {"custom",  "uniform", "varying", "config",
                                                         "prepend", "append",  "delete",  "add"};
    while (text_.kind() == UsdaText::Kind::kWord && holds(kBefore, text_.text())) text_.next();
    if (text_.kind() != UsdaText::Kind::kWord) text_.fail("there should be a property");
    text_.next();  // its type, or rel
    if (text_.takeMark('[')) text_.expectMark(']');
    if (text_.kind() != UsdaText::Kind::kWord) text_.fail("there should be the name of a property");
    std::string name(text_.text());
    const size_t line = text_.line();
    text_.next();
    const bool sampled = name.ends_with(kSamples);
    if (sampled) name.resize(name.size() - kSamples.size());
    const bool kept = prim.is_there && !name.ends_with(kConnections) &&
                      (name.starts_with(kOp) || name == kOrder ||
                       (prim.type == wanted_ && holds(wanted_properties_, name)));
    UsdaProperty* property = nullptr;
    if (text_.takeMark('=')) {
      if (kept && sampled) stage_.report.leaveOut("time samples");
      if (!kept || (sampled && prim.properties.contains(name)))
        text_.skipValue();
      else
        readValue(*(property = &prim.properties[name]), line, sampled);
    }
    if (text_.takeMark('('))
      readMetadata([&](std::string_view key) {
        if (property == nullptr || key != "interpolation") return false;
        property->interpolation = text_.takeString();
        return true;
      });
  }
  void readValue(UsdaProperty& property, size_t line, bool sampled) {
    property = {};
    property.line = line;
    if (sampled) {
      text_.expectMark('{');
      if (text_.takeMark('}')) return;
      text_.skipValue();  // the time
      text_.expectMark(':');
    }
    readNumbersOrStrings(property);
    while (sampled && !text_.takeMark('}')) {
      if (text_.kind() == UsdaText::Kind::kEnd) text_.fail("the file ends within time samples");
      if (!text_.takeMark(',') && !text_.takeMark(':')) text_.skipValue();
    }
  }
  void readNumbersOrStrings(UsdaProperty& property) {
    // An array says what it is by its first member.
    UsdaText ahead = text_;
    while (ahead.isMark('[') || ahead.isMark('(')) ahead.next();
    if (ahead.kind() == UsdaText::Kind::kString)
      property.strings = text_.takeStrings();
    else
      property.numbers = text_.takeNumbers();
  }

  /// The world's places of all prims, from their operations.
  void place() {
    for (size_t i = 0; i < stage_.prims.size(); ++i) {
      UsdaPrim& prim = stage_.prims[i];
      if (parents_[i]) prim.to_world = stage_.prims[*parents_[i]].to_world;
      const auto order = prim.properties.find(std::string(kOrder));
      if (order == prim.properties.end()) continue;
      for (std::string_view op : order->second.strings) {
        if (op == kReset) {
          prim.to_world.setIdentity();
          continue;
        }
        const bool inverse = op.starts_with(kInvert);
        if (inverse) op.remove_prefix(kInvert.size());
        const auto found = prim.properties.find(std::string(op));
        if (found == prim.properties.end())
          text_.failAt(order->second.line, fmt::format("the prim has no {:?}, which its order names", op),
                       "export the file again");
        const Eigen::Affine3d own = operation(op, found->second);
        if (inverse && own.linear().determinant() == 0)
          text_.failAt(found->second.line, fmt::format("{:?} cannot be inverted", op),
                       "export the file again");
        prim.to_world = prim.to_world * (inverse ? own.inverse() : own);
      }
    }
  }
  Eigen::Affine3d operation(std::string_view op, const UsdaProperty& property) const {
    const std::vector<double>& v = property.numbers;
    std::string_view kind = op.substr(std::min(kOp.size(), op.size()));
    kind = kind.substr(0, kind.find(':'));
    const auto expect = [&](size_t count) {
      if (v.size() != count)
        text_.failAt(property.line, fmt::format("{:?} has {} numbers, it takes {}", op, v.size(), count),
                     "mend the line or export the file again");
    };
    Eigen::Affine3d out = Eigen::Affine3d::Identity();
    if (kind == "translate") {
      expect(3);
      out.translate(Eigen::Vector3d(v[0], v[1], v[2]));
    } else if (kind == "scale") {
      expect(3);
      out.scale(Eigen::Vector3d(v[0], v[1], v[2]));
    } else if (kind == "orient") {
      expect(4);
      out.rotate(Eigen::Quaterniond(v[0], v[1], v[2], v[3]).normalized());
    } else if (kind == "transform") {
      expect(16);  // points are rows there
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c) out(r, c) = v[static_cast<size_t>(4 * c + r)];
    } else if (kind.starts_with("rotate") && kind.size() > 6) {
      const std::string_view axes = kind.substr(6);
      if (axes.size() != 1 && axes.size() != 3) unknown(op, property);
      expect(axes.size());
      for (size_t i = axes.size(); i-- > 0;) {  // the first is done first
        const char axis = axes[i];
        if (axis < 'X' || axis > 'Z') unknown(op, property);
        const double degrees = v[axes.size() == 1 ? 0 : static_cast<size_t>(axis - 'X')];
        out.rotate(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d::Unit(axis - 'X')));
      }
    } else {
      unknown(op, property);
    }
    return out;
  }
  [[noreturn]] void unknown(std::string_view op, const UsdaProperty& property) const {
    text_.failAt(property.line, fmt::format("there is no transform {:?}", op), "export the file again");
  }

  UsdaText& text_;
  std::string_view wanted_;
  const std::vector<std::string>& wanted_properties_;
  UsdaStage stage_;
  std::vector<std::optional<size_t>> parents_;
};

}  // namespace

UsdaStage readUsdaStage(UsdaText& text, std::string_view wanted, const std::vector<std::string>& properties) {
  return StageReader(text, wanted, properties).read();
}

}  // namespace strandcast
