#include "apps/settings.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "apps/finite_range.h"
#include "core/error.h"
#include "transport/dds.h"

namespace strandcast {
namespace {

std::string parameterHelp() {
  std::string text = "set a simulation parameter, NAME=VALUE or NAME=X,Y,Z; may be repeated. Names:";
  for (const ParameterInfo& info : parameterList())
    text += fmt::format("\n  {} {}({}): {}", info.name, info.unit.empty() ? "" : "[" + info.unit + "] ",
                        info.range, info.help);
  return text;
}

std::string sceneHelp() {
  std::string text = "procedural scene:";
  for (const SceneInfo& info : sceneList()) text += fmt::format("\n  {}: {}", info.name, info.description);
  return text;
}

std::vector<std::string> codecNames() {
  std::vector<std::string> names;
  for (const CodecInfo& info : codecList()) names.emplace_back(info.name);
  return names;
}

std::string codecHelp() {
  std::string text =
      "how guides are written for the network (default " + std::string(nameOf(CodecOptions().codec)) + "):";
  for (const CodecInfo& info : codecList()) text += fmt::format("\n  {}: {}", info.name, info.help);
  return text + "\nReaders are told with each chunk; see bytes per frame in `strandcast ctl status`.";
}

double numberOf(const std::string& text, const std::string& where, const std::string& example) {
  try {
    size_t used = 0;
    const double value = std::stod(text, &used);
    if (used != text.size()) throw std::invalid_argument(text);
    return value;
  } catch (const std::exception&) {
    throw Error("'" + text + "' is not a number", where, example);
  }
}

/// Also what is behind the last `at`, where that is nothing: "1," are "1" and "".
std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  for (size_t first = 0, end = 0; end != std::string::npos; first = end + 1) {
    end = text.find(at, first);
    parts.push_back(text.substr(first, end - first));
  }
  return parts;
}

std::pair<std::string, std::vector<double>> parseAssignment(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos) throw Error("not NAME=VALUE", "--set " + text, "e.g. --set air_drag=2");
  std::vector<double> values;
  for (const std::string& part : split(text.substr(equals + 1), ','))
    values.push_back(numberOf(part, "--set " + text, "e.g. --set wind=3,0,0"));
  return {text.substr(0, equals), values};
}

std::string materialHelp() {
  std::string text =
      "what the hair of a part is made of, PART:NAME=VALUE,NAME=VALUE; may be repeated. PART: stem of a "
      "groom file, number of a part, or all. A curve is one factor or knots PLACE:FACTOR joined by / from "
      "root (0) to tip (1), e.g. all:radius=5e-5,radius_curve=0:1/1:0.4. Names:";
  for (const MaterialSettingInfo& info : materialSettingList())
    text += fmt::format("\n  {} {}({}{}): {}", info.name, info.unit.empty() ? "" : "[" + info.unit + "] ",
                        info.curve ? "curve, " : "", info.range, info.help);
  return text;
}

MaterialRule parseMaterial(const std::string& text) {
  const std::string example = "e.g. --material all:radius=5e-5,radius_curve=0:1/1:0.4";
  MaterialRule rule;
  rule.where = "--material " + text;
  const size_t colon = text.find(':');
  if (colon == 0 || colon == std::string::npos || colon + 1 == text.size())
    throw Error("not PART:NAME=VALUE", rule.where, example);
  if (text.substr(0, colon) != "all") rule.parts.push_back(text.substr(0, colon));
  for (const std::string& assignment : split(text.substr(colon + 1), ',')) {
    const size_t equals = assignment.find('=');
    if (equals == std::string::npos)
      throw Error("'" + assignment + "' is not NAME=VALUE", rule.where, example);
    std::vector<double> values;
    for (const std::string& knot : split(assignment.substr(equals + 1), '/'))
      for (const std::string& part : split(knot, ':')) values.push_back(numberOf(part, rule.where, example));
    rule.settings.push_back({assignment.substr(0, equals), values, rule.where});
  }
  checkRule(rule);
  return rule;
}

}  // namespace

UpAxis upAxisOf(const std::string& name, const std::string& where) {
  if (name == "auto" || name.empty()) return UpAxis::kAuto;
  if (name == "x") return UpAxis::kX;
  if (name == "y") return UpAxis::kY;
  if (name == "z") return UpAxis::kZ;
  throw Error("unknown axis '" + name + "'", where, "choose one of auto, x, y, z");
}

BodyContact bodyContactOf(const std::string& name, const std::string& where) {
  if (name == "field") return BodyContact::kField;
  if (name == "spheres") return BodyContact::kSpheres;
  throw Error("unknown contact '" + name + "'", where, "choose one of field, spheres");
}

BodyRoots bodyRootsOf(const std::string& name, const std::string& where) {
  if (name == "skin") return BodyRoots::kSkin;
  if (name == "joint") return BodyRoots::kJoint;
  throw Error("roots do not go with '" + name + "'", where, "choose one of skin, joint");
}

void addNetworkOptions(CLI::App& app, Settings& settings) {
  app.add_option(
         "--transport", settings.transport,
         "how frames travel. dds: repairs losses, finds the others by itself; lcm: UDP multicast without "
         "repair or security, readers conceal what is lost")
      ->check(CLI::IsMember({"dds", "lcm"}))
      ->capture_default_str();
  std::string profiles = "how DDS carries what this program sends and receives:";
  std::vector<std::string> names;
  for (const DdsProfileInfo& info : ddsProfileList()) {
    profiles += fmt::format("\n  {}: {}", info.name, info.help);
    names.emplace_back(info.name);
  }
  app.add_option("--profile", settings.profile, profiles)->check(CLI::IsMember(names))->capture_default_str();
  app.add_option(
      "--keys", settings.keys,
      "with --profile secure: folder with the keys and permissions of this program, e.g. KEYS/daemon "
      "or KEYS/renderer of `strandcast keys KEYS`");
  app.add_option(
         "--peers", settings.peers,
         "addresses of machines to look on, separated by commas, where multicast does not reach (DDS)")
      ->delimiter(',');
  app.add_option("--discovery-server", settings.discovery_server,
                 "ADDRESS:PORT of a discovery server in place of multicast (DDS); "
                 "`fastdds discovery -i 0 -l ADDRESS -p PORT` runs one");
  app.add_option("--lcm-url", settings.lcm_url,
                 "with --transport lcm: udpm://ADDRESS:PORT?ttl=N or file:///PATH?mode=w (r to replay it). "
                 "Without: this machine alone, port 7667 + domain; ttl=1 reaches the local network");
  app.add_option("--domain", settings.domain, "programs on different domains do not see each other")
      ->check(CLI::Range(0, 232))
      ->capture_default_str();
  app.add_option("--groom-id", settings.groom_id, "number of the groom on the network; one daemon each")
      ->check(CLI::Range(1u, 4294967295u))
      ->capture_default_str();
}

SettingsOptions::SettingsOptions(CLI::App& app, SettingsUse use) : app_(app) {
  auto* scene = app.add_option_group("Scene", "what is simulated");
  scene_ = scene;
  scene->add_option(
      "--config", config_,
      "TOML file with settings of scene, simulation and network (README.md); options win over it");
  scene->add_option("--scene", given_.scene.name, sceneHelp());
  scene->add_option("--groom", groom_, "groom files (.tfx, .hair, .obj, .usda), separated by commas")
      ->delimiter(',');
  scene->add_option("--body", given_.scene.body,
                    "body mesh (.obj, .gltf, .glb; 20 million vertices at most) that the hair grows on and "
                    "collides with");
  scene
      ->add_option(
          "--body-contact", body_contact_,
          "what the hair collides with: the body's baked distance field (default; kept in the cache), or "
          "spheres fitted into it (quick, coarse)")
      ->check(CLI::IsMember({"field", "spheres"}));
  scene->add_option(
      "--body-clip", body_clip_,
      "lets a glTF body with a skin or morph targets move: the name of one of its animations, or a .bvh clip "
      "whose joints have the same names");
  scene->add_option("--body-joint", body_joint_,
                    "the joint of a skinned body that the hair grows on and --motion turns; the first with "
                    "'head' in its name if not given. Without --body-clip the rest stands");
  scene
      ->add_option("--body-roots", body_roots_,
                   "what roots on a skinned body move with: the skin under each of them (default), or that "
                   "joint, all as a whole")
      ->check(CLI::IsMember({"skin", "joint"}));
  scene
      ->add_option("--body-cell", given_.scene.body_cell,
                   "edge of a cell of the distance field, m; see `strandcast bake`")
      ->check(finiteRange(1e-6, 1e3));
  scene
      ->add_option("--unit-meters", given_.scene.units.unit_meters,
                   "metres per unit of groom and body files; guessed if not given")
      ->check(finiteRange(1e-6, 1000.0));
  scene->add_option("--up", up_, "up axis of groom and body files")
      ->check(CLI::IsMember({"auto", "x", "y", "z"}));
  scene->add_option("--motion", given_.scene.motion,
                    "head motion: still, nod, shake, turn, joined by +, or a .bvh clip");
  scene->add_option("--strands", given_.scene.strands, "guides: grown (procedural) or chosen evenly (files)")
      ->check(CLI::Range(1, 1000000));
  scene->add_option("--vertices", given_.scene.vertices, "vertices per strand: grown or resampled to")
      ->check(CLI::Range(2, 128));
  scene->add_option("--length", given_.scene.length, "length of procedural hair, m")
      ->check(finiteRange(0.01, 2.0));
  scene->add_option("--seed", given_.scene.seed, "of everything random")
      ->check(CLI::Range(uint64_t{0}, static_cast<uint64_t>(kLargestSeed)))
      ->capture_default_str();

  scene->add_option("--material", material_, materialHelp());

  auto* simulation = app.add_option_group("Simulation", "how it is computed");
  simulation_ = simulation;
  simulation
      ->add_option("--backend", given_.backend,
                   "auto, gpu, simd or reference; see `strandcast info --backends`")
      ->check(CLI::IsMember({"auto", "gpu", "simd", "reference"}))
      ->capture_default_str();
  simulation->add_flag(
      "--sag-free,!--no-sag-free", sag_free_,
      "the groomed shape is the shape at rest under gravity (default), or hair as it is made that sags");
  simulation->add_option("--threads", given_.threads, "of the simd backend, and to encode; 0 = all")
      ->check(CLI::Range(0, 1024));
  simulation->add_option("--set", set_, parameterHelp());
  if (use == SettingsUse::kCompare) return;
  simulation
      ->add_option("--solver", solver_,
                   "rod: elastic rods that keep their length (default); gauss_seidel: iterated constraints")
      ->check(CLI::IsMember({"rod", "gauss_seidel"}));
  simulation->add_option("--rate", given_.rate, "frames per second")
      ->check(finiteRange(1.0, 1000.0))
      ->capture_default_str();
  simulation->add_option("--duration", given_.duration, "seconds to run, by the clock; 0 = until interrupted")
      ->check(finiteRange(0.0, 1e9));
  addNetworkOptions(app, given_);
  if (use == SettingsUse::kServe)
    app.add_option(
        "--collider-folder", given_.collider_folder,
        "folder with meshes (.obj, .gltf, .glb) that `strandcast ctl collider add NAME mesh FILE` and `... "
        "convex FILE` may name, from any machine that may command. Without it commands have no file opened");
  app.add_option("--codec", codec_, codecHelp())->check(CLI::IsMember(codecNames()));
  app.add_option("--codec-error", codec_error_mm_,
                 "mm; no guide vertex is received further from where it was (default 0.01)")
      ->check(finiteRange(0.001, 1.0));
  app.add_flag(
      "--zstd", given_.codec.zstd,
      "compress delta16, oct12 and oct16 with zstd: up to 7 % fewer bytes for twice the encoder's time");
  app.add_option("--key-interval", given_.codec.key_interval,
                 "frames from one that stands alone to the next in the temporal codec: a reader that joins "
                 "or misses one "
                 "waits that long")
      ->check(CLI::Range(1u, kMaxKeyInterval))
      ->capture_default_str();
}

bool SettingsOptions::namesScene() const {
  return app_.count("--scene") + app_.count("--groom") + app_.count("--body") + app_.count("--config") > 0;
}

void SettingsOptions::refuseWithoutScene() const {
  if (namesScene()) return;
  for (const CLI::App* const group : {scene_, simulation_})
    for (const CLI::Option* const option : group->get_options())
      if (option->count() > 0 && option->get_name() != "--threads")  // which encode, too
        throw Error("what a daemon casts is as the daemon was told", option->get_name(),
                    "leave it out, or name a --scene to simulate here");
}

Settings SettingsOptions::resolve() const {
  Settings config;
  if (!config_.empty()) readConfig(config_, config);
  return over(std::move(config));
}

Settings SettingsOptions::resolve(const std::string& config_text) const {
  Settings config;
  if (!config_.empty()) readConfigText(config_text, config_.string(), config);
  return over(std::move(config));
}

void SettingsOptions::refuseWhatIsIgnored(const Settings& out) const {
  const bool has_files = !out.scene.groom.empty(), has_body = !has_files || !out.scene.body.empty();
  const struct {
    const char* option;
    bool ignored;
    const char *reason, *remedy;
  } options[] = {
      {"--config", config_.empty(), "the configuration file has no name", "name a TOML file"},
      {"--collider-folder", given_.collider_folder.empty(), "the folder of colliders has no name",
       "name a folder of meshes"},
      {"--motion", given_.scene.motion.empty(), "the motion has no name", "e.g. --motion shake"},
      {"--unit-meters", !has_files, "procedural hair is in metres", "leave it out, or give a --groom"},
      {"--up", !has_files, "of procedural hair Y is up", "leave it out, or give a --groom"},
      {"--body-contact", !has_body, "there is no body", "give a --body"},
      {"--body-cell", !has_body, "there is no body", "give a --body"},
      {"--body-cell", out.scene.body_contact == BodyContact::kSpheres, "spheres have no cells",
       "leave it out, or --body-contact field"},
  };
  for (const auto& [option, ignored, reason, remedy] : options)
    if (ignored && isGiven(option)) throw Error(reason, option, remedy);
}

bool SettingsOptions::isGiven(const char* option) const {
  const CLI::Option* known = app_.get_option_no_throw(option);
  return known != nullptr && known->count() > 0;
}

Settings SettingsOptions::over(Settings out) const {
  auto lay = [&](const char* option, auto& to, const auto& from) {
    if (isGiven(option)) to = from;
  };
  if (app_.count("--scene") > 0 && app_.count("--groom") > 0)
    throw Error("a procedural scene and a groom are two things to simulate", "--scene and --groom",
                "leave one of them out");
  if (app_.count("--scene") > 0) {  // in place of the file's groom and what goes with it
    out.scene.name = given_.scene.name;
    out.scene.groom.clear();
    out.scene.body.clear();
    out.scene.skinned.reset();
  }
  if (app_.count("--groom") > 0) {  // in place of the file's scene
    out.scene.groom.assign(groom_.begin(), groom_.end());
    out.scene.length = 0;
  }
  if (isGiven("--transport")) {  // in place of where the file's goes
    out.peers.clear();
    out.discovery_server.clear();
    out.lcm_url.clear();
  }
  lay("--body", out.scene.body, given_.scene.body);
  if (!body_contact_.empty()) out.scene.body_contact = bodyContactOf(body_contact_);
  if (!body_clip_.empty() || !body_joint_.empty() || !body_roots_.empty()) {
    if (!out.scene.skinned) out.scene.skinned.emplace();
    if (!body_clip_.empty()) out.scene.skinned->clip = body_clip_;
    if (!body_joint_.empty()) out.scene.skinned->joint = body_joint_;
    if (!body_roots_.empty()) out.scene.skinned->roots = bodyRootsOf(body_roots_);
  }
  lay("--body-cell", out.scene.body_cell, given_.scene.body_cell);
  lay("--unit-meters", out.scene.units.unit_meters, given_.scene.units.unit_meters);
  if (app_.count("--up") > 0) out.scene.units.up = upAxisOf(up_);
  lay("--motion", out.scene.motion, given_.scene.motion);
  lay("--strands", out.scene.strands, given_.scene.strands);
  lay("--vertices", out.scene.vertices, given_.scene.vertices);
  lay("--length", out.scene.length, given_.scene.length);
  lay("--seed", out.scene.seed, given_.scene.seed);
  if (!solver_.empty()) out.solver = solverKind(solver_);
  lay("--sag-free", out.sag_free, sag_free_);
  lay("--backend", out.backend, given_.backend);
  lay("--threads", out.threads, given_.threads);
  lay("--rate", out.rate, given_.rate);
  lay("--duration", out.duration, given_.duration);
  lay("--collider-folder", out.collider_folder, given_.collider_folder);
  if (!out.collider_folder.empty()) out.collider_folder = std::filesystem::absolute(out.collider_folder);
  lay("--transport", out.transport, given_.transport);
  lay("--profile", out.profile, given_.profile);
  lay("--keys", out.keys, given_.keys);
  lay("--peers", out.peers, given_.peers);
  lay("--discovery-server", out.discovery_server, given_.discovery_server);
  lay("--lcm-url", out.lcm_url, given_.lcm_url);
  lay("--domain", out.domain, given_.domain);
  lay("--groom-id", out.groom_id, given_.groom_id);
  if (!codec_.empty()) out.codec.codec = codecNamed(codec_, "--codec");
  lay("--codec-error", out.codec.max_error, static_cast<float>(codec_error_mm_ * 1e-3));
  lay("--zstd", out.codec.zstd, given_.codec.zstd);
  lay("--key-interval", out.codec.key_interval, given_.codec.key_interval);
  out.codec.threads = out.threads;
  refuseWhatIsIgnored(out);
  for (const std::string& text : material_) out.scene.materials.push_back(parseMaterial(text));
  for (const std::string& text : set_) {
    out.parameters.push_back(parseAssignment(text));
    Parameters check;
    setParameter(check, out.parameters.back().first, out.parameters.back().second, "--set " + text);
  }
  return out;
}

}  // namespace strandcast
