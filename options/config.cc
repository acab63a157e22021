#include <fmt/format.h>
#include <strings.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

#include "options/number_range.h"
#include "options/settings.h"
#include "options/toml.h"
#include "core/error.h"
#include "io/file_bytes.h"
#include "transport/chunks.h"
#include "transport/dds.h"

namespace strandcast {
namespace {

constexpr std::string_view kCharacterPath = "character.";

/// One table of a configuration file. Hands out its values, checks their types, and finally reports every key
/// that was not read.
class Section {
 public:
  /// `given`: as Settings::given.
  Section(const toml::table& table, std::string path, const std::string& file,
          std::map<std::string, std::string>& given)
      : table_(table), path_(std::move(path)), file_(file), given_(given) {}

  void number(const char* key, double low, double high, const std::function<void(double)>& set) {
    read(key, [&](const toml::node& node) {
      set(numberIn(node, key, {low, high}));
    });
  }
  void wholeNumber(const char* key, double low, double high, const std::function<void(double)>& set) {
    read(key, [&](const toml::node& node) { set(numberIn(node, key, {low, high, true})); });
  }
  void text(const char* key, const std::function<void(const std::string&)>& set) {
    read(key, [&](const toml::node& node) {
      const std::optional<std::string> value = node.value_exact<std::string>();
      if (!value) fail(node, key, "give a text in quotes");
      set(*value);
    });
  }
  void flag(const char* key, const std::function<void(bool)>& set) {
    read(key, [&](const toml::node& node) {
      const std::optional<bool> value = node.value_exact<bool>();
      if (!value) fail(node, key, "give true or false");
      set(*value);
    });
  }
  void numbers(const char* key, size_t count, const std::function<void(const std::vector<double>&)>& set) {
    read(key, [&](const toml::node& node) { set(components(node, key, count)); });
  }
  void texts(const char* key, const std::function<void(const std::string&)>& add) {
    read(key, [&](const toml::node& node) {
      if (const auto one = node.value_exact<std::string>()) return add(*one);
      const toml::array* array = node.as_array();
      if (array == nullptr) fail(node, key, "give a text or a list of texts");
      if (array->empty()) fail(node, key, "name at least one, or leave it out");
      for (const toml::node& element : *array) {
        const auto value = element.value_exact<std::string>();
        if (!value) fail(element, key, "give texts in quotes");
        add(*value);
      }
    });
  }
  /// Reads names or whole numbers, one or a list of them.
  void names(const char* key,
             const std::function<void(const std::string& name, const std::string& where)>& add) {
    read(key, [&](const toml::node& node) {
      auto one = [&](const toml::node& element) {
        if (const auto name = element.value_exact<std::string>()) return add(*name, place(node));
        const auto number = element.value_exact<int64_t>();
        if (!number) fail(element, key, "give a name in quotes or a number, or a list of them");
        add(std::to_string(*number), place(node));
      };
      const toml::array* array = node.as_array();
      if (array == nullptr) return one(node);
      if (array->empty()) fail(node, key, "name at least one, or leave it out for all");
      for (const toml::node& element : *array) one(element);
    });
  }
  void section(const char* key, const std::function<void(Section&)>& body) {
    read(key, [&](const toml::node& node) {
      if (!node.is_table()) fail(node, key, fmt::format("write it as a table: [{}]", key));
      Section inner(*node.as_table(), path_ + key + ".", file_, given_);
      body(inner);
      inner.refuseRest();
    });
  }
  void sections(const char* key, const std::function<void(Section&)>& body) {
    read(key, [&](const toml::node& node) {
      const toml::array* array = node.as_array();
      if (array == nullptr) fail(node, key, fmt::format("write it as tables: [[{}{}]]", path_, key));
      for (const toml::node& element : *array) {
        if (!element.is_table()) fail(element, key, fmt::format("write it as tables: [[{}{}]]", path_, key));
        Section inner(*element.as_table(), path_ + key + ".", file_, given_);
        body(inner);
        inner.refuseRest();
      }
    });
  }
  /// Passes every key that was not read to `set` with its components. `pairs`: also accepts [[0, 1], [1,
  /// 0.4]], as 0, 1, 1, 0.4.
  void remaining(bool pairs, const std::function<void(const std::string&, const std::vector<double>&,
                                                      const std::string& where)>& set) {
    for (const auto& [key, node] : table_)
      if (!known_.contains(std::string(key.str()))) {
        known_.insert(std::string(key.str()));
        given_[givenKey(std::string(key.str()))] = place(node);
        set(std::string(key.str()), components(node, std::string(key.str()), 0, pairs), place(node));
      }
  }
  void refuseRest() const {
    for (const auto& [key, node] : table_) {
      if (known_.contains(std::string(key.str()))) continue;
      std::string names;
      for (const std::string& name : known_) names += (names.empty() ? "" : ", ") + name;
      throw Error(fmt::format("unknown key '{}{}'", path_, key.str()), place(node), "known here: " + names);
    }
  }
  [[noreturn]] void fail(const toml::node& node, const std::string& key, const std::string& remedy) const {
    throw Error(fmt::format("'{}{}' has a wrong value", path_, key), place(node), remedy);
  }
  bool has(const char* key) const { return table_.contains(key); }
  /// The key belongs to another reader of the table.
  void leave(const char* key) { known_.insert(key); }
  std::string place(const toml::node& node) const {
    return fmt::format("{} line {}", file_, node.source().begin.line);
  }
  std::string place() const { return place(table_); }
  std::string place(const char* key) const {
    const toml::node* node = table_.get(key);
    return node != nullptr ? place(*node) : file_;
  }

 private:
  void read(const char* key, const std::function<void(const toml::node&)>& body) {
    known_.insert(key);
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    given_[givenKey(key)] = place(*node);
    body(*node);
  }
  /// The key in Settings::given. Those of a character are those of the file.
  std::string givenKey(const std::string& key) const {
    return (path_.starts_with(kCharacterPath) ? path_.substr(kCharacterPath.size()) : path_) + key;
  }
  double numberIn(const toml::node& node, const std::string& key, const NumberRange& range = {}) const {
    const std::optional<double> value = node.value<double>();
    if (value && range.contains(*value)) return *value;
    std::ostringstream text;
    node.visit([&](const auto& any) { text << any; });
    std::string given = text.str();
    if (given.size() > 40 || given.find('\n') != std::string::npos) given = "the value";
    throw Error(fmt::format("'{}{}': {} is not {}", path_, key, given, range.text()), place(node), "");
  }
  std::vector<double> components(const toml::node& node, const std::string& key, size_t count,
                                 bool pairs = false) const {
    std::vector<double> values;
    if (node.is_number()) {
      values.push_back(numberIn(node, key));
    } else if (const toml::array* array = node.as_array()) {
      for (const toml::node& element : *array) {
        const toml::array* pair = pairs ? element.as_array() : nullptr;
        if (pair != nullptr && pair->size() == 2) {
          for (const toml::node& half : *pair) values.push_back(numberIn(half, key));
        } else {
          values.push_back(numberIn(element, key));
        }
      }
    } else {
      fail(node, key, "give a number or a list of numbers");
    }
    if (count > 0 && values.size() != count) fail(node, key, fmt::format("give {} numbers", count));
    return values;
  }

  const toml::table& table_;
  std::string path_;
  const std::string& file_;
  std::map<std::string, std::string>& given_;
  std::set<std::string> known_;
};

using PathOf = std::function<std::filesystem::path(const std::string&)>;

void readUnits(Section& section, GroomReadOptions& into) {
  section.number("unit_meters", 1e-6, 1000, [&](double v) { into.unit_meters = static_cast<float>(v); });
  section.text("up", [&](const std::string& v) { into.up = upAxisOf(v, section.place("up")); });
}

/// Reads the name by which commands address a body.
void readBodyName(Section& section, std::string& into) {
  section.text("name", [&](const std::string& v) {
    if (v.empty() || !isSoundName(v))
      throw Error("a body's name is not valid", section.place("name"),
                  fmt::format("give 1 to {} bytes without control characters", kMaxTextBytes));
    into = v;
  });
}

/// Warns of shape keys that the primitive's kind does not use.
void warnOfUnusedShapeKeys(const Section& section, PrimitiveKind kind, std::vector<std::string>& warnings) {
  using K = PrimitiveKind;
  const struct {
    const char* key;
    std::initializer_list<PrimitiveKind> kinds;  // kinds that use the key
  } keys[] = {{"b", {K::kCapsule, K::kTaperedCapsule, K::kPlane}},
              {"radius", {K::kSphere, K::kCapsule, K::kTaperedCapsule}},
              {"radius_b", {K::kTaperedCapsule}},
              {"extent", {K::kEllipsoid, K::kBox}},
              {"rotation", {K::kEllipsoid, K::kBox, K::kConvex, K::kField}}};
  for (const auto& [key, kinds] : keys)
    if (section.has(key) && std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
      warnings.push_back(fmt::format("{}, body.primitives.{} is not used: a primitive of this kind has none",
                                     section.place(key), key));
}

ScenePrimitive readPrimitive(Section& section, const PathOf& path, std::vector<std::string>& warnings) {
  ScenePrimitive primitive;
  ContactPrimitive& out = primitive.shape;
  auto vector = [](const std::vector<double>& v) {
    return Vec3(Eigen::Vector3d(v[0], v[1], v[2]).cast<float>());
  };
  section.text("kind", [&](const std::string& kind) {
    if (kind == "sphere")
      out.kind = PrimitiveKind::kSphere;
    else if (kind == "capsule")
      out.kind = PrimitiveKind::kCapsule;
    else if (kind == "plane")
      out.kind = PrimitiveKind::kPlane;
    else if (kind == "tapered_capsule" || kind == "tapered-capsule")
      out.kind = PrimitiveKind::kTaperedCapsule;
    else if (kind == "ellipsoid")
      out.kind = PrimitiveKind::kEllipsoid;
    else if (kind == "box")
      out.kind = PrimitiveKind::kBox;
    else if (kind == "convex")
      out.kind = PrimitiveKind::kConvex;
    else if (kind == "mesh")
      out.kind = PrimitiveKind::kField;
    else
      throw Error("unknown primitive '" + kind + "'", section.place("kind"),
                  "choose one of sphere, capsule, tapered_capsule, ellipsoid, box, plane, convex, mesh");
  });
  section.numbers("a", 3, [&](const std::vector<double>& v) { out.a = vector(v); });
  section.numbers("b", 3, [&](const std::vector<double>& v) { out.b = vector(v); });
  section.number("radius", 0, 10, [&](double v) { out.radius = static_cast<float>(v); });
  section.number("radius_b", 0, 10, [&](double v) { out.radius_b = static_cast<float>(v); });
  section.numbers("extent", 3, [&](const std::vector<double>& v) { out.extent = vector(v); });
  section.numbers("rotation", 4, [&](const std::vector<double>& v) {
    out.rotation = Quat(Eigen::Quaterniond(v[3], v[0], v[1], v[2]).cast<float>());
    if (!(out.rotation.norm() > 0))
      throw Error("a rotation is zero", section.place("rotation"), "give a quaternion, x y z w");
    out.rotation.normalize();
  });
  section.number("friction", 0, 10, [&](double v) { out.friction = static_cast<float>(v); });
  if (out.kind == PrimitiveKind::kPlane) {
    if (!(out.b.norm() > 0))
      throw Error("a plane's normal b is zero", section.place("b"), "give a direction");
    out.b.normalize();
  }
  bool is_told_to_follow = false;
  section.flag("follows_head", [&](bool v) {
    primitive.follows_head = v;
    is_told_to_follow = true;
  });
  section.text("joint", [&](const std::string& v) {
    if (v.empty()) throw Error("a joint has no name", section.place("joint"), "name one, or leave it out");
    if (is_told_to_follow)
      throw Error("a primitive with a joint always follows that joint", section.place("follows_head"),
                  "leave out follows_head or joint");
    primitive.joint = v;
  });
  readBodyName(section, primitive.name);
  section.text("file", [&](const std::string& v) {
    if (!v.empty()) primitive.file = path(v);
  });
  readUnits(section, primitive.units);
  section.number("cell", 1e-6, 1e3, [&](double v) { primitive.cell = static_cast<float>(v); });
  primitive.where = section.place();
  warnOfUnusedShapeKeys(section, out.kind, warnings);
  const bool is_mesh = out.kind == PrimitiveKind::kField;
  const bool has_file = is_mesh || out.kind == PrimitiveKind::kConvex;
  if (primitive.cell > 0 && !is_mesh)
    throw Error("only a mesh has cells", section.place("cell"), "leave cell out, or kind = \"mesh\"");
  if (!primitive.file.empty() && !has_file)
    throw Error("a primitive of this kind is not read from a file", section.place("file"),
                "leave file out, or kind = \"convex\" or \"mesh\"");
  if (!has_file && (primitive.units.unit_meters > 0 || primitive.units.up != UpAxis::kAuto))
    throw Error("a primitive of this kind is in metres with Y up", primitive.where,
                "leave unit_meters and up out, or kind = \"convex\" or \"mesh\"");
  if (primitive.file.empty() && has_file)
    throw Error("a convex body or a mesh has no file", primitive.where, "name one: file = \"chair.obj\"");
  if (!has_file) checkPrimitive(out, primitive.where);
  return primitive;
}

MaterialRule readMaterial(Section& section) {
  MaterialRule rule;
  for (const char* key : {"part", "parts"})
    section.names(key, [&](const std::string& name, const std::string& where) {
      rule.parts.push_back(name);
      rule.where = where;
    });
  section.remaining(
      true, [&](const std::string& name, const std::vector<double>& values, const std::string& where) {
        rule.settings.push_back({name, values, where});
      });
  checkRule(rule);
  return rule;
}

PinRule readPin(Section& section) {
  PinRule rule;
  for (const char* key : {"part", "parts"})
    section.names(key, [&](const std::string& name, const std::string&) { rule.parts.push_back(name); });
  section.text("bone", [&](const std::string& v) { rule.bone = v; });
  section.number("from", 0, 1, [&](double v) { rule.from = static_cast<float>(v); });
  section.number("to", 0, 1, [&](double v) { rule.to = static_cast<float>(v); });
  rule.where = section.place();
  if (rule.bone != "head" && strcasecmp(rule.bone.c_str(), "head") == 0)
    throw Error("a pin's bone is '" + rule.bone + "'", rule.where,
                "did you mean 'head'? Other bones do not move");
  if (rule.from > rule.to)
    throw Error("a pin's 'from' is greater than its 'to'", rule.where, "give them in order");
  return rule;
}

/// Appends a source. A source without a name is named by its number.
void readWindSource(Section& section, std::vector<NamedWindSource>& sources,
                    std::vector<std::string>& warnings) {
  WindSource out;
  std::string name = fmt::format("wind{}", sources.size() + 1);
  auto vector = [&](const char* key, Vec3& to) {
    section.numbers(key, 3, [&](const std::vector<double>& v) {
      to = Vec3(Eigen::Vector3d(v[0], v[1], v[2]).cast<float>());
    });
  };
  section.text("name", [&](const std::string& v) {
    checkWindSourceName(v, section.place("name"));
    name = v;
  });
  section.text("kind",
               [&](const std::string& kind) { out.kind = windSourceKind(kind, section.place("kind")); });
  vector("position", out.position);
  vector("direction", out.direction);
  for (const WindSourceNumber& number : windSourceNumbers())
    section.number(number.name, number.low, number.high,
                   [&](double v) { out.*number.into = static_cast<float>(v * number.scale); });
  checkWindSource(out, section.place());
  WindSourceParts given = section.has("direction") ? kSourceDirection : 0;
  for (const WindSourceNumber& number : windSourceNumbers())
    if (section.has(number.name)) given |= number.part;
  if (const std::string unused = unusedParts(out.kind, given); !unused.empty())
    warnings.push_back(fmt::format("{}, wind: {} is not used: a {} has none", section.place(), unused,
                                   windSourceKindName(out.kind)));
  for (const NamedWindSource& other : sources)
    if (other.name == name)
      throw Error("two sources of wind are called '" + name + "'", section.place(),
                  "give each a unique name");
  sources.push_back({std::move(name), out});
}

/// Reads settings over `s`. Lists and repeated tables replace those of before.
void readSections(Section& root, const std::filesystem::path& folder, Settings& s) {
  auto path = [&](const std::string& text) { return folder / text; };  // relative to the configuration file
  root.text("scene", [&](const std::string& v) { s.scene.name = v; });
  root.text("motion", [&](const std::string& v) {
    if (v.empty()) throw Error("the motion has no name", root.place("motion"), "e.g. motion = \"shake\"");
    s.scene.motion = lowerExtension(v) == ".bvh" ? path(v).string() : v;
  });
  root.wholeNumber("seed", 0, kLargestSeed, [&](double v) { s.scene.seed = static_cast<uint64_t>(v); });
  root.section("groom", [&](Section& groom) {
    if (groom.has("files")) s.scene.groom.clear();
    groom.texts("files", [&](const std::string& v) { s.scene.groom.push_back(path(v)); });
    if (groom.has("hair_files")) s.scene.hairs.clear();
    groom.texts("hair_files", [&](const std::string& v) { s.scene.hairs.push_back(path(v)); });
    groom.text("guides", [&](const std::string& v) {
      s.scene.guides = guideChoiceOf(v, groom.place("guides"));
      if (!s.scene.guides.file.empty()) s.scene.guides.file = path(v);
    });
    readUnits(groom, s.scene.units);
    groom.wholeNumber("strands", 1, 1e6, [&](double v) { s.scene.strands = static_cast<int>(v); });
    groom.wholeNumber("vertices", 2, 128, [&](double v) { s.scene.vertices = static_cast<int>(v); });
    groom.number("length", 0.01, 2, [&](double v) { s.scene.length = static_cast<float>(v); });
  });
  root.section("body", [&](Section& body) {
    body.text("file", [&](const std::string& v) { s.scene.body = path(v); });
    readBodyName(body, s.scene.body_name);
    body.text("contact",
              [&](const std::string& v) { s.scene.body_contact = bodyContactOf(v, body.place("contact")); });
    const auto skinned = [&]() -> SkinnedMotion& {
      return s.scene.skinned ? *s.scene.skinned : s.scene.skinned.emplace();
    };
    readUnits(body, s.scene.body_units);
    body.number("clip_unit_meters", 1e-6, 1000,
                [&](double v) { s.scene.clip_unit_meters = static_cast<float>(v); });
    body.text("clip", [&](const std::string& v) {
      skinned().clip = lowerExtension(v) == ".bvh" ? path(v).string() : v;
    });
    body.text("joint", [&](const std::string& v) { skinned().joint = v; });
    body.text("roots", [&](const std::string& v) { skinned().roots = bodyRootsOf(v, body.place("roots")); });
    body.text("targets",
              [&](const std::string& v) { skinned().targets = bodyTargetsOf(v, body.place("targets")); });
    body.number("cell", 1e-6, 1e3, [&](double v) { s.scene.body_cell = static_cast<float>(v); });
    body.wholeNumber("fitted_spheres", 0, 64,
                     [&](double v) { s.scene.body_primitives = static_cast<int>(v); });
    body.number("friction", 0, 10, [&](double v) { s.scene.body_friction = static_cast<float>(v); });
    if (body.has("primitives")) s.scene.primitives.clear();
    body.sections("primitives", [&](Section& primitive) {
      s.scene.primitives.push_back(readPrimitive(primitive, path, s.warnings));
    });
  });
  if (root.has("material")) s.scene.materials.clear();
  if (root.has("pin")) s.scene.pins.clear();
  if (root.has("wind")) s.wind_sources.clear();
  root.sections("material", [&](Section& material) { s.scene.materials.push_back(readMaterial(material)); });
  root.sections("pin", [&](Section& pin) { s.scene.pins.push_back(readPin(pin)); });
  root.sections("wind", [&](Section& wind) { readWindSource(wind, s.wind_sources, s.warnings); });
  root.section("daemon", [&](Section& daemon) {
    daemon.text("backend", [&](const std::string& v) { s.backend = v; });
    daemon.text("solver", [&](const std::string& v) { s.solver = solverKind(v); });
    daemon.flag("sag_free", [&](bool v) { s.sag_free = v; });
    daemon.wholeNumber("threads", 0, 1024, [&](double v) { s.threads = static_cast<int>(v); });
    daemon.number("rate", 1, 1000, [&](double v) { s.rate = v; });
    daemon.number("duration", 0, 1e9, [&](double v) { s.duration = v; });
    daemon.number("pose_delay_max", 0, 0.4, [&](double v) { s.poses.delay_max = v; });
    daemon.number("pose_extrapolate", 0, 1, [&](double v) { s.poses.extrapolate = v; });
    daemon.text("collider_folder", [&](const std::string& v) {
      if (v.empty())
        throw Error("the folder of colliders has no name", daemon.place("collider_folder"),
                    "name a folder of meshes, or leave it out");
      s.collider_folder = path(v);
    });
  });
  root.section("transport", [&](Section& transport) {
    transport.text("kind", [&](const std::string& v) {
      if (v != "dds" && v != "lcm")
        throw Error("unknown transport '" + v + "'", transport.place("kind"), "choose dds or lcm");
      s.transport = v;
    });
    transport.text("profile", [&](const std::string& v) {
      ddsProfileNamed(v, transport.place("profile"));
      s.profile = v;
    });
    transport.text("keys", [&](const std::string& v) { s.keys = path(v); });
    if (transport.has("peers")) s.peers.clear();
    transport.texts("peers", [&](const std::string& v) { s.peers.push_back(v); });
    transport.text("discovery_server", [&](const std::string& v) { s.discovery_server = v; });
    transport.text("lcm_url", [&](const std::string& v) { s.lcm_url = v; });
    transport.wholeNumber("domain", 0, 232, [&](double v) { s.domain = static_cast<int>(v); });
    transport.wholeNumber("groom_id", 1, 4294967295.0,
                          [&](double v) { s.groom_id = static_cast<uint32_t>(v); });
    transport.text("codec",
                   [&](const std::string& v) { s.codec.codec = codecNamed(v, transport.place("codec")); });
    transport.number("codec_error_mm", 0.001, 1,
                     [&](double v) { s.codec.max_error = static_cast<float>(v * 1e-3); });
    transport.number("hair_error_mm", 0.01, 1,
                     [&](double v) { s.codec.hair_error = static_cast<float>(v * 1e-3); });
    transport.flag("zstd", [&](bool v) { s.codec.zstd = v; });
    transport.wholeNumber("key_interval", 1, kMaxKeyInterval,
                          [&](double v) { s.codec.key_interval = static_cast<uint32_t>(v); });
  });
  root.section("parameters", [&](Section& parameters) {
    parameters.remaining(
        false, [&](const std::string& name, const std::vector<double>& value, const std::string& where) {
          Parameters check;
          setParameter(check, name, value, where);
          s.parameters.emplace_back(name, value);
        });
  });
}

/// Throws Error where a file with characters gives the groom id elsewhere than beside a character's name.
void refuseOtherGroomId(const toml::table& table, const Section& section) {
  const toml::node_view id = table["transport"]["groom_id"];
  if (id)
    throw Error("each character has its own groom_id", section.place(*id.node()),
                "leave it out here, and write groom_id = N in the [[character]] table itself");
}

/// Reads the character's own keys: all but its settings.
void readCharacterKeys(Section& section, const std::filesystem::path& folder, CharacterSettings& out) {
  section.wholeNumber("groom_id", 1, 4294967295.0,
                      [&](double v) { out.settings.groom_id = static_cast<uint32_t>(v); });
  if (!section.has("groom_id"))
    throw Error("a character has no groom_id", section.place(), "give each its own, e.g. groom_id = 2");
  section.text("name", [&](const std::string& v) {
    if (v.empty() || !isSoundName(v))
      throw Error("a character's name is not valid", section.place("name"),
                  fmt::format("give 1 to {} bytes without control characters", kMaxTextBytes));
    out.name = v;
  });
  section.number("budget_ms", 0.01, 1e4, [&](double v) { out.budget_ms = v; });
  section.text("record", [&](const std::string& v) {
    if (v.empty())
      throw Error("the recording has no name", section.place("record"),
                  "name a file, e.g. record = \"ada.rec\", or leave it out");
    out.record = folder / v;
  });
}

/// Throws Error where the newest of the characters has what must be another's alone.
void refuseShared(const std::vector<CharacterSettings>& characters) {
  const CharacterSettings& newest = characters.back();
  const auto place = [&](const char* key) { return newest.settings.given.at(key); };
  const auto isOf = [&](const CharacterSettings& other, const std::filesystem::path& file) {
    return std::filesystem::absolute(other.record).lexically_normal() ==
           std::filesystem::absolute(file).lexically_normal();
  };
  for (const CharacterSettings& other : characters) {
    if (&other == &newest) break;
    if (other.settings.groom_id == newest.settings.groom_id)
      throw Error(fmt::format("two characters have the groom_id {}", newest.settings.groom_id),
                  place("groom_id"), "give each its own");
    if (!newest.name.empty() && other.name == newest.name)
      throw Error("two characters are called '" + newest.name + "'", place("name"),
                  "give each a unique name");
    if (!newest.record.empty() && !other.record.empty() && isOf(other, newest.record))
      throw Error("two characters record to one file", place("record"), "give each its own");
  }
}

}  // namespace

void forCharacter(const CharacterSettings& character, const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    throw Error("character " + character.label(), error.what(), "");
  }
}

std::vector<CharacterSettings> readCharactersText(const std::string& text, const std::string& name) {
  const toml::table table = parsedToml(text, name);
  const std::filesystem::path folder = std::filesystem::path(name).parent_path();
  std::vector<CharacterSettings> characters;
  const toml::node* const node = table.get("character");
  if (node == nullptr) return characters;
  std::map<std::string, std::string> given;
  const Section file(table, "", name, given);
  const toml::array* const array = node->as_array();
  if (array == nullptr || array->empty())
    file.fail(*node, "character", "write it as tables: [[character]]");
  refuseOtherGroomId(table, file);
  for (const toml::node& element : *array) {
    if (!element.is_table()) file.fail(element, "character", "write it as tables: [[character]]");
    CharacterSettings& character = characters.emplace_back();
    Section shared(table, "", name, character.settings.given);
    shared.leave("character");
    readSections(shared, folder, character.settings);
    shared.refuseRest();
    Section own(*element.as_table(), std::string(kCharacterPath), name, character.settings.given);
    readCharacterKeys(own, folder, character);
    refuseShared(characters);
    forCharacter(character, [&] {
      refuseOtherGroomId(*element.as_table(), own);
      readSections(own, folder, character.settings);
      own.refuseRest();
    });
  }
  return characters;
}

void readConfigText(const std::string& text, const std::string& name, Settings& settings) {
  const toml::table table = parsedToml(text, name);
  Section root(table, "", name, settings.given);
  if (root.has("character"))
    throw Error("several characters are cast by strandcastd alone", root.place("character"),
                "leave [[character]] out, or give each character a file of its own");
  readSections(root, std::filesystem::path(name).parent_path(), settings);
  root.refuseRest();
}

std::string configText(const std::filesystem::path& file) {
  constexpr uintmax_t kMaxBytes = 1 << 20;
  std::error_code failed;
  const uintmax_t bytes = std::filesystem::file_size(file, failed);
  std::ifstream stream(file, std::ios::binary);
  if (failed || !stream)
    throw Error("the settings file cannot be read", file.string(), "check its path (--config, --preset)");
  if (bytes > kMaxBytes)
    throw Error("the settings file is larger than 1 MiB", file.string(), "is it the right file?");
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

void readConfig(const std::filesystem::path& file, Settings& settings) {
  readConfigText(configText(file), file.string(), settings);
}

}  // namespace strandcast
