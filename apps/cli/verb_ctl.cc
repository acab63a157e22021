#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "apps/cli/verbs.h"
#include "core/error.h"
#include "core/name_lookup.h"
#include "options/console.h"
#include "options/number_range.h"
#include "options/settings.h"
#include "service/colliders.h"
#include "service/commands.h"
#include "service/controls.h"
#include "service/network.h"
#include "transport/chunks.h"
#include "transport/metrics.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct CtlOptions {
  Settings network;
  bool json = false;
  double timeout = 10;  // s
  std::string name, shape;
  std::vector<double> values;
  std::vector<std::string> words;   ///< after a collider's shape: numbers, or a file
  std::vector<double> at;           ///< position of a collider from a file
  float unit_meters = 0, cell = 0;  ///< of a collider from a file
  bool follows_head = false;
  double friction = static_cast<double>(ContactPrimitive().friction);
  double seconds = kRampSeconds;
  std::vector<double> direction;
  std::map<std::string, double> numbers;  ///< values of windSourceNumbers() that were given
};

/// Accepts any finite number. CLI11 alone takes an empty text for 0.
CLI::Validator finiteNumber() { return inRange({}); }

/// Omits the minimum count of a positional's numbers, which CLI11 prints as if it were the only one.
class PlainUsage final : public CLI::Formatter {
 public:
  std::string make_option_usage(const CLI::Option* option) const override {
    const std::string name = make_option_name(option, true);
    return option->get_required() ? name : "[" + name + "]";
  }
};

/// Polls until `ready` returns true; false on timeout. Throws Interrupted.
bool waitUntil(double seconds, const std::function<bool()>& ready) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!ready()) {
    if (g_interrupted) throw Interrupted();
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

/// The warning where the daemon's status says that the parameter set by the command has no effect; else
/// empty.
std::string unusedNoteOf(const Command& command, const std::optional<Status>& status) {
  if (command.kind != CommandKind::kSetParameter || !status) return {};
  for (const auto& [name, values] : entriesOf(status->parameters, kUnusedEntry)) {
    if (name != command.name) continue;
    const std::string need = conditionOf(name);
    return fmt::format("parameter '{}' is set, but has no effect with the present values of the others{}",
                       name, need.empty() ? "" : ": " + need);
  }
  return {};
}

int sendCommand(const CtlOptions& o, CommandKind kind, const std::string& name,
                const std::vector<double>& values) {
  const std::unique_ptr<Subscriber> subscriber = joinForCommands(o.network);
  Command command;
  command.groom_id = o.network.groom_id;
  command.id = newSession();
  command.kind = kind;
  command.name = name;
  command.values = values;
  AnswerWait wait(o.timeout, kind == CommandKind::kStep ? kMaxRequestedSteps : 0);
  const std::optional<std::string> refusal = ask(*subscriber, command, [&] {
    if (g_interrupted) throw Interrupted();
    return wait.isOver(subscriber->status());
  });
  if (!refusal)
    throw Error("the daemon did not answer",
                fmt::format("groom {} on {}", o.network.groom_id, networkName(o.network)),
                kind == CommandKind::kAddColliderFile
                    ? "a large mesh takes long, so the collider may still be added: see `strandcast ctl "
                      "collider list`, or wait longer with --timeout"
                    : "see `strandcast ctl list`");
  if (!refusal->empty()) throw Error("the daemon refused", *refusal, "");
  nlohmann::json answer = {{"command", command.id}, {"accepted", true}};
  if (const std::string doubt = unusedNoteOf(command, subscriber->status()); !doubt.empty()) {
    spdlog::warn("{}", doubt);
    answer["warning"] = doubt;
  }
  if (o.json) fmt::print("{}\n", jsonText(answer));
  return 0;
}

/// Checks the number of values for parameters that this program knows; the daemon may know others.
int setParameter(const CtlOptions& o) {
  for (const ParameterInfo& info : parameterList())
    if (info.name == o.name && o.values.size() != static_cast<size_t>(info.components))
      throw Error(fmt::format("parameter '{}' takes {} value{}, not {}", info.name, info.components,
                              info.components == 1 ? "" : "s", o.values.size()),
                  "strandcast ctl set", fmt::format("{}: {}", info.help, info.range));
  return sendCommand(o, CommandKind::kSetParameter, o.name, o.values);
}

double bytesPerVertex(const Status& s) {
  return s.vertices > 0 ? static_cast<double>(s.encoding.frame_bytes) / static_cast<double>(s.vertices) : 0;
}

/// The shortest text of a value that arrived as a float.
std::string numberText(double value) { return fmt::format("{}", static_cast<float>(value)); }

nlohmann::json parametersJson(const Status& s) {
  nlohmann::json all = nlohmann::json::object();
  for (const auto& [name, values] : entriesOf(s.parameters, "")) {
    nlohmann::json numbers = nlohmann::json::array();
    for (const double value : values) numbers.push_back(nlohmann::json::parse(numberText(value)));
    all[name] = values.size() == 1 ? numbers[0] : numbers;
  }
  return all;
}

nlohmann::json toJson(const Status& s) {
  return {{"groom_id", s.groom_id},
          {"session", fmt::format("{:016x}", s.session)},
          {"groom", s.groom_name},
          {"backend", s.backend},
          {"device", s.device},
          {"strands", s.strands},
          {"vertices", s.vertices},
          {"frames", s.frames},
          {"simulation_time", s.simulation_time},
          {"step_ms_median", s.step_ms_median},
          {"step_ms_p95", s.step_ms_p95},
          {"mean_stretch", s.mean_stretch},
          {"max_stretch", s.max_stretch},
          {"max_penetration_m", s.max_penetration},
          {"non_finite", s.non_finite},
          {"strands_reset", s.strands_reset},
          {"readers", s.readers},
          {"codec", s.encoding.codec},
          {"codec_max_error_mm", 1e3 * s.encoding.max_error},
          {"codec_worst_error_mm", 1e3 * s.encoding.worst_error},
          {"bytes_per_frame", s.encoding.frame_bytes},
          {"bytes_per_vertex", bytesPerVertex(s)},
          {"strands_sent_finer", s.encoding.strands_sent_finer},
          {"last_command_error", s.last_command_error},
          {"metrics", namedValues(s.metrics)},
          {"parameters", parametersJson(s)}};
}

int list(const CtlOptions& o) {
  const std::unique_ptr<Subscriber> subscriber = joinForCommands(o.network);
  waitUntil(std::min(o.timeout, 1.5), [] { return false; });  // every daemon publishes a status twice a
                                                              // second
  const std::vector<Status> all = subscriber->allStatuses();
  if (o.json) {
    nlohmann::json out = nlohmann::json::array();
    for (const Status& s : all) out.push_back(toJson(s));
    fmt::print("{}\n", jsonText({{"daemons", out}}));
    return 0;
  }
  if (all.empty()) fmt::print("no daemon on {}\n", networkName(o.network));
  for (const Status& s : all) {
    if (s.strands == 0) {
      fmt::print("  groom {:<4} is starting\n", s.groom_id);
      continue;
    }
    fmt::print("  groom {:<4} {:<16} {:<10} {} strands, {} vertices, step {:.2f} ms, {} readers\n",
               s.groom_id, s.groom_name, s.backend, s.strands, s.vertices, s.step_ms_median, s.readers);
  }
  return 0;
}

/// The newest status of the casting daemon.
Status statusOf(const CtlOptions& o, const Subscriber& subscriber) {
  std::optional<Status> status;
  // A starting daemon publishes statuses before its hair is loaded.
  const auto casts = [&] { return (status = subscriber.status()).has_value() && status->strands > 0; };
  if (!waitUntil(o.timeout, casts))
    throw Error(status ? "the daemon is still starting" : "no daemon",
                fmt::format("groom {} on {}", o.network.groom_id, networkName(o.network)),
                "see `strandcast ctl list`");
  return *status;
}

int printStatus(const CtlOptions& o) {
  const Status status = statusOf(o, *joinForCommands(o.network));
  nlohmann::json object = toJson(status);
  if (o.json) {
    fmt::print("{}\n", jsonText(object));
    return 0;
  }
  object.erase("parameters");
  object.erase("metrics");
  for (const auto& [key, value] : object.items())
    fmt::print("  {:<20} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
  fmt::print("  parameters\n");
  for (const auto& [name, values] : entriesOf(status.parameters, "")) {
    std::string text;
    for (const double value : values) text += ' ' + numberText(value);
    for (const ParameterInfo& info : parameterList())
      if (info.name == name && !info.unit.empty()) text += ' ' + info.unit;
    fmt::print("    {:<18}{}\n", name, text);
  }
  return 0;
}

std::vector<double> poseValues(const std::vector<double>& v) {
  const auto radians = [&](size_t i) { return v.size() > i ? v[i] * kPi / 180 : 0.0; };
  const Eigen::Quaterniond turn = Eigen::AngleAxisd(radians(3), Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(radians(4), Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(radians(5), Eigen::Vector3d::UnitZ());
  return {v[0], v[1], v[2], turn.x(), turn.y(), turn.z(), turn.w()};
}

struct ShapeForm {
  PrimitiveKind kind;
  const char* name;
  size_t numbers;
  const char* help;
};
constexpr ShapeForm kShapes[] = {
    {PrimitiveKind::kSphere, "sphere", 4, "X Y Z RADIUS"},
    {PrimitiveKind::kCapsule, "capsule", 7, "X Y Z to X Y Z, RADIUS"},
    {PrimitiveKind::kPlane, "plane", 6, "X Y Z, normal X Y Z"},
    {PrimitiveKind::kTaperedCapsule, "tapered_capsule", 8, "X Y Z to X Y Z, RADIUS RADIUS"},
    {PrimitiveKind::kEllipsoid, "ellipsoid", 6, "X Y Z, half axes X Y Z"},
    {PrimitiveKind::kBox, "box", 6, "X Y Z, half edges X Y Z"}};

const char* fileKindName(PrimitiveKind kind) { return kind == PrimitiveKind::kConvex ? "convex" : "mesh"; }

/// Throws Error on an unknown shape.
const ShapeForm& shapeNamed(std::string kind) {
  std::replace(kind.begin(), kind.end(), '-', '_');
  std::vector<std::string> names;
  for (const ShapeForm& known : kShapes) {
    if (kind == known.name) return known;
    names.emplace_back(known.name);
  }
  for (const PrimitiveKind file : {PrimitiveKind::kField, PrimitiveKind::kConvex})
    names.emplace_back(fileKindName(file));
  const std::string near = didYouMean(kind, names);
  throw Error("unknown shape '" + kind + "'", "strandcast ctl collider add",
              fmt::format("{}choose one of {}", near.empty() ? "" : near + " ", fmt::join(names, ", ")));
}

/// The values of kAddCollider. A free collider has the pose, and its shape is at its origin; one that follows
/// the head has the pose in its shape.
std::vector<double> colliderValues(const ShapeForm& form, const std::vector<double>& v, bool follows_head,
                                   double friction) {
  if (v.size() != form.numbers)
    throw Error(fmt::format("a {} takes {} numbers, not {}", form.name, form.numbers, v.size()),
                "strandcast ctl collider add", form.help);
  const auto vec = [&](size_t i) {
    return Vec3(static_cast<float>(v[i]), static_cast<float>(v[i + 1]), static_cast<float>(v[i + 2]));
  };
  ContactPrimitive shape;
  shape.kind = form.kind;
  shape.friction = static_cast<float>(friction);
  const Vec3 at = vec(0), own = follows_head ? at : Vec3(Vec3::Zero());
  shape.a = own;
  const auto number = [&](size_t i) { return static_cast<float>(v[i]); };
  switch (form.kind) {
    case PrimitiveKind::kSphere:
      shape.radius = number(3);
      break;
    case PrimitiveKind::kCapsule:
    case PrimitiveKind::kTaperedCapsule:
      shape.b = vec(3) - at + own;
      shape.radius = number(6);
      shape.radius_b = number(v.size() - 1);
      break;
    case PrimitiveKind::kPlane:
      shape.b = vec(3).normalized();
      break;
    default:
      shape.extent = vec(3);
  }
  checkPrimitive(shape, "strandcast ctl collider add");
  std::vector<double> values = {static_cast<double>(form.kind), follows_head ? 1.0 : 0.0};
  for (int c = 0; c < 3; ++c) values.push_back(static_cast<double>(follows_head ? 0.0f : at[c]));
  for (const double component : {0.0, 0.0, 0.0, 1.0}) values.push_back(component);
  shapeNumbers(shape, [&](float n) { values.push_back(static_cast<double>(n)); });
  return values;
}

std::string kindName(PrimitiveKind kind) {
  for (const ShapeForm& form : kShapes)
    if (form.kind == kind) return form.name;
  return fileKindName(kind);
}

nlohmann::json toJson(const Vec3& v) {
  nlohmann::json out = nlohmann::json::array();
  for (int c = 0; c < 3; ++c) out.push_back(nlohmann::json::parse(numberText(static_cast<double>(v[c]))));
  return out;
}

std::string vectorText(const Vec3& v) { return fmt::format("{:.4g} {:.4g} {:.4g}", v.x(), v.y(), v.z()); }

/// A summary of a collider's shapes: "sphere", "3 sphere, 1 box".
std::string shapesText(const Collider& collider) {
  std::map<std::string, size_t> counts;
  for (const ContactPrimitive& shape : collider.shapes) ++counts[kindName(shape.kind)];
  std::string text;
  for (const auto& [kind, count] : counts)
    text +=
        (text.empty() ? "" : ", ") + (collider.shapes.size() > 1 ? fmt::format("{} {}", count, kind) : kind);
  return text;
}

/// m, position of the first shape; of a field, its displacement from where it was baked.
Vec3 placeOf(const Collider& collider, const Pose& pose) {
  const ContactPrimitive& shape = collider.shapes[0];
  return shape.kind == PrimitiveKind::kField ? pose.position : pose.apply(shape.a);
}

int listColliders(const CtlOptions& o) {
  const std::unique_ptr<Subscriber> subscriber = subscribe(o.network);
  const Status status = statusOf(o, *subscriber);
  std::shared_ptr<const ColliderSet> set;
  std::shared_ptr<const GuideFrame> frame;
  const auto complete = [&] {
    set = subscriber->colliders();
    frame = subscriber->frame();
    return set && frame && set->session == frame->session;
  };
  if (!waitUntil(o.timeout, complete))
    throw Error("the daemon's colliders were not received",
                fmt::format("groom {} on {}", o.network.groom_id, networkName(o.network)),
                "does it publish frames?");
  std::map<uint32_t, std::string> names;
  for (const auto& [name, ids] : entriesOf(status.parameters, kColliderEntry))
    for (const Collider& collider : set->colliders)
      if (collider.id >= ids[0] && collider.id < ids[0] + (ids.size() > 1 ? ids[1] : 1))
        names[collider.id] = name;
  nlohmann::json all = nlohmann::json::array();
  for (const Collider& collider : set->colliders) {
    const bool is_named = names.contains(collider.id);
    nlohmann::json object = {{"id", collider.id}, {"follows_head", collider.follows_head}};
    object["name"] = is_named ? nlohmann::json(names[collider.id]) : nlohmann::json();
    for (const ContactPrimitive& shape : collider.shapes) object["shapes"].push_back(kindName(shape.kind));
    std::string where =
        "follows the head, at " + vectorText(collider.shapes[0].a) + " in the head's rest pose";
    for (const PlacedCollider& placed : frame->colliders) {
      if (placed.id != collider.id) continue;
      const Vec3 place = placeOf(collider, placed.pose);
      object["position"] = toJson(place);
      where = "at " + vectorText(place);
    }
    if (!o.json)
      fmt::print("  {:<5} {:<16} {:<24} {}\n", collider.id, is_named ? names[collider.id] : "-",
                 shapesText(collider), where);
    all.push_back(std::move(object));
  }
  if (o.json) fmt::print("{}\n", jsonText({{"colliders", all}}));
  if (!o.json && all.empty()) fmt::print("no colliders\n");
  return 0;
}

/// The command for a collider from a file; empty for other kinds.
std::optional<Command> fileColliderOf(const CtlOptions& o) {
  ColliderFile collider;
  if (o.shape == fileKindName(PrimitiveKind::kConvex))
    collider.kind = PrimitiveKind::kConvex;
  else if (o.shape != fileKindName(PrimitiveKind::kField))
    return std::nullopt;
  if (o.words.size() != 1)
    throw Error("a " + o.shape + " takes the name of one file", "strandcast ctl collider add",
                "give its name in the daemon's --collider-folder; its place follows --at");
  collider.name = o.name;
  collider.file = o.words.front();
  collider.follows_head = o.follows_head;
  if (!o.at.empty()) collider.pose = commandedPose(poseValues(o.at), 0, "strandcast ctl collider add");
  collider.friction = static_cast<float>(o.friction);
  collider.unit_meters = o.unit_meters;
  collider.cell = o.cell;
  const Command command = colliderFileCommand(collider);
  colliderFileOf(command, "strandcast ctl collider add");  // validated before it is sent
  return command;
}

std::vector<double> numbersOf(const std::vector<std::string>& words) {
  std::vector<double> numbers;
  for (const std::string& word : words)
    numbers.push_back(numberIn(word, {}, "strandcast ctl collider add", "see --help"));
  return numbers;
}

int addCollider(const CtlOptions& o) {
  if (const std::optional<Command> command = fileColliderOf(o))
    return sendCommand(o, command->kind, command->name, command->values);
  if (!o.at.empty() || o.unit_meters > 0 || o.cell > 0)
    throw Error("--at, --unit-meters and --cell apply only to a mesh or a convex body",
                "strandcast ctl collider add", "the numbers of a shape give its place and size in metres");
  const ShapeForm& form = shapeNamed(o.shape);
  return sendCommand(o, CommandKind::kAddCollider, o.name,
                     colliderValues(form, numbersOf(o.words), o.follows_head, o.friction));
}

void addColliderVerbs(CLI::App& app, const std::shared_ptr<CtlOptions>& o, const std::shared_ptr<Verb>& run) {
  app.require_subcommand(1);
  std::string shapes;
  for (const ShapeForm& form : kShapes) shapes += fmt::format("\n  {:<16} {}", form.name, form.help);
  CLI::App* add = app.add_subcommand("add", "add a body that hair collides with, until the daemon ends");
  add->add_option("NAME", o->name, "unique name")->required();
  add->add_option("SHAPE", o->shape, "kind of shape")->required();
  shapes += "\n  mesh, convex     FILE: any mesh, or a closed convex one, of the daemon's --collider-folder";
  add->add_option("VALUE", o->words, "numbers of the shape, m, in the world:" + shapes)
      ->expected(1, 8)
      ->option_text("4 to 8 NUMBERS, or FILE REQUIRED")
      ->required();
  add->add_option("--at", o->at,
                  "place, m, and rotation, degrees, of a mesh or a convex body; default: as in its file")
      ->expected(3, 6)
      ->option_text("X Y Z [YAW [PITCH [ROLL]]]")
      ->check(finiteNumber());
  add->add_option(
         "--unit-meters", o->unit_meters,
         "metres per unit of FILE; default: 1 for glTF; the unit of the daemon's groom files for .obj")
      ->check(finiteRange(1e-6, 1000.0));
  add->add_option("--cell", o->cell,
                  "edge of a cell of a mesh's distance field, m; default: that of the daemon's body")
      ->check(finiteRange(1e-6, 1e3));
  add->add_flag("--head", o->follows_head, "it follows the head; its place is given in the head's rest pose");
  add->add_option("--friction", o->friction, "Coulomb coefficient")
      ->check(finiteRange(0.0, 10.0))
      ->capture_default_str();
  add->callback([o, run] { *run = [o] { return addCollider(*o); }; });
  CLI::App* move = app.add_subcommand("move", "move a collider to a pose, smoothly");
  move->add_option("NAME", o->name, "name of a collider that was added or that the configuration file names")
      ->required();
  move->add_option("X Y Z [YAW [PITCH [ROLL]]]", o->values, "m, degrees")
      ->expected(3, 6)
      ->option_text("3 to 6 NUMBERS REQUIRED")
      ->required()
      ->check(finiteNumber());
  move->add_option("--seconds", o->seconds, "duration of the move, s")
      ->check(finiteRange(0.0, kLongestWay))
      ->capture_default_str();
  move->callback([o, run] {
    *run = [o] {
      std::vector<double> values = poseValues(o->values);
      values.push_back(o->seconds);
      return sendCommand(*o, CommandKind::kMoveCollider, o->name, values);
    };
  });
  app.add_subcommand("list", "list all colliders by the names that commands and the configuration file give")
      ->callback([o, run] { *run = [o] { return listColliders(*o); }; });
  CLI::App* remove =
      app.add_subcommand("remove", "remove a collider that was added or that the configuration file names");
  remove
      ->add_option("NAME", o->name, "name of a collider that was added or that the configuration file names")
      ->required();
  remove->callback(
      [o, run] { *run = [o] { return sendCommand(*o, CommandKind::kRemoveCollider, o->name, {}); }; });
}

/// Reads the given options of a source into `source` and returns which parts were given.
WindSourceParts takeFanOptions(const CtlOptions& o, WindSource& source) {
  WindSourceParts parts = 0;
  const auto vector = [&](const std::vector<double>& from, WindSourceParts part, Vec3& to) {
    if (from.empty()) return;
    to = Vec3(Eigen::Vector3d(from[0], from[1], from[2]).cast<float>());
    parts |= part;
  };
  vector(o.values, kSourcePosition, source.position);
  vector(o.direction, kSourceDirection, source.direction);
  for (const WindSourceNumber& number : windSourceNumbers()) {
    const auto given = o.numbers.find(number.name);
    if (given == o.numbers.end()) continue;
    source.*number.into = static_cast<float>(given->second * number.scale);
    parts |= number.part;
  }
  checkWindSource(source, "strandcast ctl fan");
  return parts;
}

/// `defaults`: default values to show in the help; null for none.
void addFanOptions(CLI::App& app, const std::shared_ptr<CtlOptions>& o, const WindSource* defaults) {
  const auto ends = [](const std::string& value) { return value.empty() ? value : ", default " + value; };
  app.add_option("--direction", o->direction,
                 "direction of the wind" + ends(defaults != nullptr ? "0 0 1" : ""))
      ->expected(3)
      ->option_text("X Y Z")
      ->check(finiteNumber());
  for (const WindSourceNumber& number : windSourceNumbers()) {
    const std::string standard =
        defaults == nullptr
            ? ""
            : fmt::format("{:.3g}", static_cast<double>(defaults->*number.into) / number.scale);
    app.add_option_function<double>(
           fmt::format("--{}", number.name), [o, name = number.name](double v) { o->numbers[name] = v; },
           fmt::format("{} in {}{}", number.help, number.unit, ends(standard)))
        ->check(finiteRange(number.low, number.high));
  }
}

int listFans(const CtlOptions& o) {
  const Status status = statusOf(o, *joinForCommands(o.network));
  nlohmann::json all = nlohmann::json::array();
  for (const auto& [name, values] : entriesOf(status.parameters, kWindSourceEntry)) {
    const WindSource source = windSourceOf(values, "fan " + name + " as reported by the daemon");
    const std::string kind = windSourceKindName(source.kind);
    nlohmann::json object = {{"name", name}, {"kind", kind}};
    object["position"] = toJson(source.position);
    object["direction"] = toJson(source.direction);
    std::string line = fmt::format("  {:<16} {:<8} at {}  along {} ", name, kind, vectorText(source.position),
                                   vectorText(source.direction));
    for (const WindSourceNumber& number : windSourceNumbers()) {
      const double value = static_cast<double>(source.*number.into) / number.scale;
      object[number.name] = nlohmann::json::parse(numberText(value));
      line += fmt::format(" {} {:.4g} {}", number.name, value, number.unit);
    }
    if (!o.json) fmt::print("{}\n", line);
    all.push_back(std::move(object));
  }
  if (o.json) fmt::print("{}\n", jsonText({{"fans", all}}));
  if (!o.json && all.empty()) fmt::print("no sources of wind\n");
  return 0;
}

void addFanVerbs(CLI::App& app, const std::shared_ptr<CtlOptions>& o, const std::shared_ptr<Verb>& run) {
  app.require_subcommand(1);
  static const WindSource kDefault;
  const auto place = [&](CLI::App& sub) {
    return sub.add_option("X Y Z", o->values, "place, m, in the world")->expected(3)->check(finiteNumber());
  };
  CLI::App* add = app.add_subcommand("add", "add a source of wind, until the daemon ends");
  add->add_option("NAME", o->name, "unique name, without spaces")->required();
  add->add_option("KIND", o->shape,
                  "cone (a fan), turbine, or sphere, which blows outwards in all directions (inwards if "
                  "speed is negative)")
      ->required();
  place(*add)->required();
  addFanOptions(*add, o, &kDefault);
  add->callback([o, run] {
    *run = [o] {
      WindSource source;
      source.kind = windSourceKind(o->shape, "strandcast ctl fan add");
      const WindSourceParts given = takeFanOptions(*o, source);
      if (const std::string unused = unusedParts(source.kind, given); !unused.empty())
        spdlog::warn("{} is not used: a {} has none", unused, o->shape);
      return sendCommand(*o, CommandKind::kAddWindSource, o->name, windSourceValues(source));
    };
  });
  CLI::App* move =
      app.add_subcommand("move", "change the given values of a source smoothly; the others stay");
  move->add_option("NAME", o->name,
                   "name of a source that was added, or of a [[wind]] table (wind1, wind2 ... if the table "
                   "has no name)")
      ->required();
  place(*move);
  addFanOptions(*move, o, nullptr);
  move->add_option("--seconds", o->seconds, "duration of the move, s")
      ->check(finiteRange(0.0, kLongestWay))
      ->capture_default_str();
  move->callback([o, run] {
    *run = [o] {
      WindSource to;
      const WindSourceParts parts = takeFanOptions(*o, to);
      if (parts == 0)
        throw Error("no value of the source is given", "strandcast ctl fan move " + o->name,
                    "give X Y Z, --direction, --speed or another value");
      return sendCommand(*o, CommandKind::kMoveWindSource, o->name, windMoveValues(to, parts, o->seconds));
    };
  });
  app.add_subcommand("list", "list all sources with their present values")->callback([o, run] {
    *run = [o] { return listFans(*o); };
  });
  CLI::App* remove = app.add_subcommand("remove", "remove a source of wind");
  remove->add_option("NAME", o->name, "name of the source, as in move")->required();
  remove->callback(
      [o, run] { *run = [o] { return sendCommand(*o, CommandKind::kRemoveWindSource, o->name, {}); }; });
}

}  // namespace

Verb addCtl(CLI::App& app) {
  const auto o = std::make_shared<CtlOptions>();
  const auto run = std::make_shared<Verb>();
  app.require_subcommand(1);
  app.fallthrough();
  const auto formatter = std::make_shared<PlainUsage>();
  formatter->column_width(app.get_formatter()->get_column_width());
  app.formatter(formatter);
  addNetworkOptions(app, o->network);
  app.add_option("--timeout", o->timeout, "seconds to wait for the daemon; for steps, since the last step")
      ->check(finiteRange(0.1, 3600.0))
      ->capture_default_str();
  app.add_flag("--json", o->json, "print one JSON object");
  app.footer(
      "Every command waits until the daemon has carried it out.\n"
      "Examples:\n"
      "  strandcast ctl wind 3 0 0\n"
      "  strandcast ctl set air_drag 2\n"
      "  strandcast ctl head 0 0 0 30         turn the head 30 degrees to its left\n"
      "  strandcast ctl motion nod+turn\n"
      "  strandcast ctl collider add ball sphere 0 0.1 0.3 0.05\n"
      "  strandcast ctl collider move ball 0 0.1 0 --seconds 2\n"
      "  strandcast ctl collider add chair mesh chair.glb --at 0 -1.2 -0.3 90\n"
      "  strandcast ctl fan add spot cone 0 0.2 0.6 --direction 0 0 -1 --speed 4\n"
      "  strandcast ctl fan move spot 0.3 0.2 0.6 --speed 8 --seconds 2\n"
      "  strandcast ctl pull 0 0.1 0.1 0.03 0 0.2 0.2 20\n"
      "  strandcast ctl step 3");
  const auto verb = [&](const char* name, const char* help, Verb body) {
    CLI::App* sub = app.add_subcommand(name, help);
    sub->callback([run, body = std::move(body)] { *run = body; });
    return sub;
  };
  verb("list", "list the daemons of the domain", [o] { return list(*o); });
  verb("status", "print the daemon's state and the values of its parameters",
       [o] { return printStatus(*o); });
  verb("wind", "set the velocity of the air, m/s",
       [o] { return sendCommand(*o, CommandKind::kSetParameter, "wind", o->values); })
      ->add_option("XYZ", o->values, "velocity, m/s")
      ->expected(3)
      ->required()
      ->check(finiteNumber());
  CLI::App* set =
      verb("set", "set a parameter (names: strandcastd --help)", [o] { return setParameter(*o); });
  set->add_option("NAME", o->name, "parameter")->required();
  set->add_option("VALUE", o->values, "value, or 3 components")
      ->expected(1, 3)
      ->option_text("1 or 3 NUMBERS REQUIRED")
      ->required()
      ->check(finiteNumber());
  verb("head", "move the head to a pose",
       [o] { return sendCommand(*o, CommandKind::kHeadPose, "", poseValues(o->values)); })
      ->add_option("X Y Z [YAW [PITCH [ROLL]]]", o->values, "offset from rest in m, angles in degrees")
      ->expected(3, 6)
      ->option_text("3 to 6 NUMBERS REQUIRED")
      ->required()
      ->check(finiteNumber());
  verb("motion", "start a motion of the head",
       [o] { return sendCommand(*o, CommandKind::kHeadMotion, o->name, {}); })
      ->add_option("NAME", o->name, "still, nod, shake, turn, joined by +")
      ->required();
  addColliderVerbs(
      *app.add_subcommand("collider", "add, move, remove and list bodies that hair collides with"), o, run);
  addFanVerbs(*app.add_subcommand("fan", "add, move, remove and list sources of wind"), o, run);
  verb("reset",
       "reset the hair to its rest shape: pulls end and measurements restart; head, bodies, wind and "
       "parameters stay",
       [o] { return sendCommand(*o, CommandKind::kReset, "", {}); });
  verb("pause", "pause the simulation; the daemon keeps sending frames",
       [o] { return sendCommand(*o, CommandKind::kPause, "", {1}); });
  verb("go", "resume the simulation", [o] { return sendCommand(*o, CommandKind::kPause, "", {0}); });
  verb("step", "take single steps of a paused simulation",
       [o] { return sendCommand(*o, CommandKind::kStep, "", o->values); })
      ->add_option("STEPS", o->values, "1 to 1000")
      ->expected(1)
      ->required()
      ->transform(wholeRange(1, kMaxRequestedSteps));
  verb("pull", "pull the hair around a point for a second; without numbers, release it",
       [o] {
         if (!o->values.empty() && o->values.size() != 8)
           throw Error(fmt::format("a pull takes 8 numbers, not {}", o->values.size()), "strandcast ctl pull",
                       "X Y Z RADIUS TOX TOY TOZ RATE, or none to release");
         return sendCommand(*o, CommandKind::kPull, "", o->values);
       })
      ->add_option("X Y Z RADIUS TOX TOY TOZ RATE", o->values,
                   "grab point, m; radius, m; target, m; rate, 1/s")
      ->expected(0, 8)
      ->option_text("8 NUMBERS or none")
      ->check(finiteNumber());
  verb("stop", "end the daemon", [o] { return sendCommand(*o, CommandKind::kShutdown, "", {}); });
  return [run, o, &app] {
    checkNetworkOptions(app, o->network);
    return (*run)();
  };
}

}  // namespace strandcast
