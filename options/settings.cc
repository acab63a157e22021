#include "options/settings.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include <map>
#include <set>

#include "core/error.h"
#include "options/number_range.h"
#include "transport/dds.h"
#include "transport/lcm.h"

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
      "encoding of guides on the network (default " + std::string(nameOf(CodecOptions().codec)) + "):";
  for (const CodecInfo& info : codecList()) text += fmt::format("\n  {}: {}", info.name, info.help);
  return text + "\nEach chunk names its codec to readers; `strandcast ctl status` shows bytes per frame.";
}

/// Splits at every `at`; keeps an empty last part: "1," gives "1" and "".
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
    values.push_back(numberIn(part, {}, "--set " + text, "e.g. --set wind=3,0,0"));
  return {text.substr(0, equals), values};
}

/// Throws Error where two --set give a parameter different values.
void refuseSetTwice(const std::vector<std::pair<std::string, std::vector<double>>>& before,
                    const std::pair<std::string, std::vector<double>>& now, const std::string& text) {
  for (const auto& [name, values] : before)
    if (name == now.first && values != now.second)
      throw Error(fmt::format("'{}' is set twice, to different values", name), "--set " + text,
                  "leave one of them out");
}

/// Options and their keys in configuration files.
constexpr std::pair<const char*, const char*> kOptionKeys[] = {
    {"--scene", "scene"},
    {"--groom", "groom.files"},
    {"--hair-files", "groom.hair_files"},
    {"--guides", "groom.guides"},
    {"--body", "body.file"},
    {"--body-contact", "body.contact"},
    {"--body-clip", "body.clip"},
    {"--body-joint", "body.joint"},
    {"--body-roots", "body.roots"},
    {"--body-targets", "body.targets"},
    {"--body-cell", "body.cell"},
    {"--unit-meters", "groom.unit_meters"},
    {"--up", "groom.up"},
    {"--body-unit-meters", "body.unit_meters"},
    {"--body-up", "body.up"},
    {"--clip-unit-meters", "body.clip_unit_meters"},
    {"--motion", "motion"},
    {"--strands", "groom.strands"},
    {"--vertices", "groom.vertices"},
    {"--length", "groom.length"},
    {"--seed", "seed"},
    {"--backend", "daemon.backend"},
    {"--sag-free", "daemon.sag_free"},
    {"--threads", "daemon.threads"},
    {"--solver", "daemon.solver"},
    {"--rate", "daemon.rate"},
    {"--duration", "daemon.duration"},
    {"--collider-folder", "daemon.collider_folder"},
    {"--pose-delay-max", "daemon.pose_delay_max"},
    {"--pose-extrapolate", "daemon.pose_extrapolate"},
    {"--transport", "transport.kind"},
    {"--profile", "transport.profile"},
    {"--keys", "transport.keys"},
    {"--peers", "transport.peers"},
    {"--discovery-server", "transport.discovery_server"},
    {"--lcm-url", "transport.lcm_url"},
    {"--domain", "transport.domain"},
    {"--groom-id", "transport.groom_id"},
    {"--codec", "transport.codec"},
    {"--codec-error", "transport.codec_error_mm"},
    {"--hair-error", "transport.hair_error_mm"},
    {"--zstd", "transport.zstd"},
    {"--key-interval", "transport.key_interval"}};

bool isGivenTo(const CLI::App& app, const char* option) {
  const CLI::Option* known = app.get_option_no_throw(option);
  return known != nullptr && known->count() > 0;
}

std::string materialHelp() {
  std::string text =
      "material of the hair of a part, PART:NAME=VALUE,NAME=VALUE; may be repeated. PART: stem of a groom "
      "file, number of a part, or all. A curve is one factor, or knots PLACE:FACTOR joined by / from root "
      "(0) to tip (1), e.g. all:radius=5e-5,radius_curve=0:1/1:0.4. Names:";
  for (const MaterialSettingInfo& info : materialSettingList())
    text += fmt::format("\n  {} {}({}{}): {}", info.name, info.unit.empty() ? "" : "[" + info.unit + "] ",
                        info.curve ? "curve, " : "", info.range, info.help);
  return text;
}

MaterialRule parseMaterial(const std::string& text) {
  const std::string example = "e.g. --material all:radius=5e-5,radius_curve=0:1/1:0.4";
  MaterialRule rule;
  rule.where = "--material " + text;
  rule.is_option = true;
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
      for (const std::string& part : split(knot, ':'))
        values.push_back(numberIn(part, {}, rule.where, example));
    rule.settings.push_back({assignment.substr(0, equals), values, rule.where});
  }
  checkRule(rule);
  return rule;
}

}  // namespace

std::string configKeyOf(const std::string& option) {
  for (const auto& [known, key] : kOptionKeys)
    if (known == option) return key;
  return {};
}

UpAxis upAxisOf(const std::string& name, const std::string& where) {
  if (name == "auto" || name.empty()) return UpAxis::kAuto;
  if (name == "x") return UpAxis::kX;
  if (name == "y") return UpAxis::kY;
  if (name == "z") return UpAxis::kZ;
  throw Error("unknown axis '" + name + "'", where, "choose one of auto, x, y, z");
}

GuideChoice guideChoiceOf(const std::string& text, const std::string& where) {
  constexpr const char* kRemedy = "give all, a share of the strands such as 5%, or a groom file";
  GuideChoice choice;
  if (text.empty()) throw Error("the guides have no name", where, kRemedy);
  if (text == "all") {
    choice.all = true;
  } else if (text.back() == '%') {
    choice.share = numberIn(text.substr(0, text.size() - 1), {}, where, kRemedy) / 100;
    if (!(choice.share > 0 && choice.share < 1))
      throw Error("a share of guides is not above 0 and below 100 %", where, kRemedy);
  } else {
    choice.file = text;
    if (!choice.file.has_extension()) throw Error("'" + text + "' names no guides", where, kRemedy);
  }
  return choice;
}

BodyContact bodyContactOf(const std::string& name, const std::string& where) {
  if (name == "field") return BodyContact::kField;
  if (name == "spheres") return BodyContact::kSpheres;
  throw Error("unknown contact '" + name + "'", where, "choose one of field, spheres");
}

BodyRoots bodyRootsOf(const std::string& name, const std::string& where) {
  if (name == "skin") return BodyRoots::kSkin;
  if (name == "joint") return BodyRoots::kJoint;
  throw Error("unknown value of --body-roots: '" + name + "'", where, "choose one of skin, joint");
}

BodyTargets bodyTargetsOf(const std::string& name, const std::string& where) {
  if (name == "clip") return BodyTargets::kClip;
  if (name == "all") return BodyTargets::kAll;
  throw Error("unknown value of --body-targets: '" + name + "'", where, "choose one of clip, all");
}

void addNetworkOptions(CLI::App& app, Settings& settings) {
  app.add_option("--transport", settings.transport,
                 "transport of frames. dds: repairs losses and discovers the other programs; lcm: UDP "
                 "multicast without repair or security; readers conceal losses")
      ->check(CLI::IsMember({"dds", "lcm"}))
      ->capture_default_str();
  std::string profiles = "DDS profile of what this program sends and receives:";
  std::vector<std::string> names;
  for (const DdsProfileInfo& info : ddsProfileList()) {
    profiles += fmt::format("\n  {}: {}", info.name, info.help);
    names.emplace_back(info.name);
  }
  app.add_option("--profile", settings.profile, profiles)->check(CLI::IsMember(names))->capture_default_str();
  app.add_option("--keys", settings.keys,
                 "with --profile secure: folder of this program's keys and permissions, e.g. KEYS/daemon or "
                 "KEYS/renderer of `strandcast keys KEYS`");
  app.add_option("--peers", settings.peers,
                 "addresses of machines where discovery looks for programs without multicast, separated by "
                 "commas (DDS)")
      ->delimiter(',');
  app.add_option("--discovery-server", settings.discovery_server,
                 "ADDRESS:PORT of a discovery server instead of multicast (DDS); `fastdds discovery -i 0 -l "
                 "ADDRESS -p PORT` runs one");
  app.add_option("--lcm-url", settings.lcm_url,
                 "with --transport lcm: udpm://ADDRESS:PORT?ttl=N or file:///PATH?mode=w (mode=r replays "
                 "it); ttl=1 reaches the local network. Default: this machine only, port 7667 + domain");
  app.add_option("--domain", settings.domain, "programs on different domains do not see each other")
      ->transform(wholeRange(0, 232))
      ->capture_default_str();
  app.add_option("--groom-id", settings.groom_id,
                 "number of the groom on the network; one daemon publishes each")
      ->transform(wholeRange(1, 4294967295.0))
      ->capture_default_str();
}

void checkNetworkOptions(const CLI::App& app, Settings& settings) {
  for (const auto& [option, key] : kOptionKeys)
    if (std::string(key).starts_with("transport.") && isGivenTo(app, option)) settings.given[key] = option;
  checkUnusedNetworkSettings(settings);
}

SettingsOptions::SettingsOptions(CLI::App& app, SettingsUse use) : app_(app), use_(use) {
  auto* scene = app.add_option_group("Scene", "hair, body and motion");
  scene_ = scene;
  scene->add_option(
      "--config", config_,
      "TOML file with settings of scene, simulation and network (docs/reference.md); options override it");
  scene->add_option("--scene", given_.scene.name, sceneHelp());
  scene->add_option("--groom", groom_, "groom files (.tfx, .hair, .obj, .usda), separated by commas")
      ->delimiter(',');
  scene
      ->add_option("--hair-files", hairs_,
                   "files of hairs that follow the strands of --groom, which are their guides, separated by "
                   "commas. As many files as of the groom have its parts, in order")
      ->delimiter(',');
  scene->add_option(
      "--guides", guides_,
      "strands that are simulated; the groom's other strands follow them. A share of the groom such as 5%, a "
      "groom file, or all. Default: those that the groom's files mark as guides, or else all");
  scene->add_option(
      "--body", given_.scene.body,
      "body mesh (.obj, .gltf, .glb; 20 million vertices at most) that the hair grows on and collides with");
  scene
      ->add_option("--body-contact", body_contact_,
                   "contact with the body: its baked distance field (default; kept in the cache), or spheres "
                   "fitted into it (fast, coarse)")
      ->check(CLI::IsMember({"field", "spheres"}));
  scene->add_option(use == SettingsUse::kCheck ? "--body-clip,--clip" : "--body-clip", body_clip_,
                    "clip that moves a glTF body with a skin or morph targets: the name of one of its "
                    "animations, or a .bvh file whose joints have the same names");
  scene->add_option("--body-joint", body_joint_,
                    "joint of a skinned body that carries the hair and that --motion turns; default: the "
                    "first with 'head' in its name. Without --body-clip the other joints stand still");
  scene
      ->add_option("--body-roots", body_roots_,
                   "what roots on a skinned body follow: skin, the surface under each root (default), or "
                   "joint, --body-joint for all roots")
      ->check(CLI::IsMember({"skin", "joint"}));
  scene
      ->add_option("--body-targets", body_targets_,
                   "morph targets that a skinned body has: clip, those that --body-clip plays (default), or "
                   "all, which live poses can weigh too; contact parts over them follow")
      ->check(CLI::IsMember({"clip", "all"}));
  scene
      ->add_option("--body-cell", given_.scene.body_cell,
                   "edge of a cell of the distance field, m; see `strandcast bake`")
      ->check(finiteRange(1e-6, 1e3));
  scene
      ->add_option(
          "--unit-meters", given_.scene.units.unit_meters,
          "metres per unit of groom files and of an .obj body; default: as the files say, else guessed")
      ->check(finiteRange(1e-6, 1000.0));
  scene->add_option("--up", up_, "up axis of groom files and of an .obj body")
      ->check(CLI::IsMember({"auto", "x", "y", "z"}));
  scene
      ->add_option(
          "--body-unit-meters", given_.scene.body_units.unit_meters,
          "metres per unit of the body file; default: 1 for glTF, which is in metres; the groom's for .obj")
      ->check(finiteRange(1e-6, 1000.0));
  scene->add_option("--body-up", body_up_, "up axis of the body file; default: y for glTF; --up for .obj")
      ->check(CLI::IsMember({"auto", "x", "y", "z"}));
  scene
      ->add_option("--clip-unit-meters", given_.scene.clip_unit_meters,
                   "metres per unit of .bvh clips of --body-clip and --motion; default: the scale that "
                   "matches bone lengths of the same names, or that makes the skeleton as tall as a person")
      ->check(finiteRange(1e-6, 1000.0));
  scene->add_option("--motion", given_.scene.motion,
                    "head motion: still, nod, shake, turn, joined by +, or a .bvh clip");
  scene
      ->add_option("--strands", given_.scene.strands,
                   "number of guides: grown (procedural) or chosen evenly (files)")
      ->transform(wholeRange(1, 1000000));
  scene->add_option("--vertices", given_.scene.vertices, "vertices per strand, grown or resampled")
      ->transform(wholeRange(2, 128));
  scene->add_option("--length", given_.scene.length, "length of procedural hair, m")
      ->check(finiteRange(0.01, 2.0));
  scene->add_option("--seed", given_.scene.seed, "seed of all random numbers")
      ->transform(wholeRange(0, kLargestSeed))
      ->capture_default_str();

  scene->add_option("--material", material_, materialHelp());

  auto* simulation = app.add_option_group("Simulation", "solver, backend and rate");
  simulation_ = simulation;
  simulation
      ->add_option("--backend", given_.backend,
                   "auto, gpu, simd or reference; see `strandcast info --backends`")
      ->check(CLI::IsMember({"auto", "gpu", "simd", "reference"}))
      ->capture_default_str();
  simulation
      ->add_flag("--sag-free,!--no-sag-free", sag_free_,
                 "make the groomed shape the rest shape under gravity (default); off: hair sags from it")
      ->multi_option_policy(CLI::MultiOptionPolicy::Throw);
  simulation->add_option("--threads", given_.threads, "threads of the simd backend and of encoding; 0 = all")
      ->transform(wholeRange(0, 1024));
  simulation->add_option("--set", set_, parameterHelp());
  if (use == SettingsUse::kCompare) return;
  simulation
      ->add_option(
          "--solver", solver_,
          "rod: inextensible elastic rods (default); gauss_seidel: position-based constraints, iterated")
      ->check(CLI::IsMember({"rod", "gauss_seidel"}));
  simulation->add_option("--rate", given_.rate, "frames per second")
      ->check(finiteRange(1.0, 1000.0))
      ->capture_default_str();
  if (use != SettingsUse::kCheck) {
    simulation
        ->add_option("--duration", given_.duration, "seconds of wall time to run; 0 = until interrupted")
        ->check(finiteRange(0.0, 1e9));
    addNetworkOptions(app, given_);
  }
  if (use == SettingsUse::kServe) {
    app.add_option(
        "--collider-folder", given_.collider_folder,
        "folder with meshes (.obj, .gltf, .glb) that `strandcast ctl collider add NAME mesh FILE` and `... "
        "convex FILE` may name, from any machine that may command. Without it commands may not open files");
    app.add_option(
           "--pose-delay-max", given_.poses.delay_max,
           "longest time, s, for which steps wait for late poses of a program that moves the character")
        ->check(finiteRange(0.0, 0.4))
        ->capture_default_str();
    app.add_option("--pose-extrapolate", given_.poses.extrapolate,
                   "time, s, within which such a motion comes to rest where poses stay away")
        ->check(finiteRange(0.0, 1.0))
        ->capture_default_str();
  }
  app.add_option("--codec", codec_, codecHelp())->check(CLI::IsMember(codecNames()));
  app.add_option("--codec-error", codec_error_mm_,
                 "largest distance, mm, of a received guide vertex from the simulated one (default 0.01)")
      ->check(finiteRange(0.001, 1.0));
  app.add_option("--hair-error", hair_error_mm_,
                 "largest distance, mm, at rest of a received vertex of hairs that follow guides (default "
                 "0.03)")
      ->check(finiteRange(0.01, 1.0));
  app.add_flag(
      "--zstd", given_.codec.zstd,
      "compress delta16, oct12 and oct16 with zstd: up to 7 % fewer bytes for twice the encoder's time");
  app.add_option("--key-interval", given_.codec.key_interval,
                 "frames between key frames of the temporal codec: a reader that joins, or loses a frame, "
                 "waits up to that long")
      ->transform(wholeRange(1, kMaxKeyInterval))
      ->capture_default_str();
}

bool SettingsOptions::namesScene() const {
  return app_.count("--scene") + app_.count("--groom") + app_.count("--body") + app_.count("--config") > 0;
}

void SettingsOptions::refuseWithoutScene() const {
  if (namesScene()) return;
  for (const CLI::App* const group : {scene_, simulation_})
    for (const CLI::Option* const option : group->get_options())
      if (option->count() > 0 && option->get_name() != "--threads")  // encoding uses threads, too
        throw Error("this option belongs to the daemon that simulates", option->get_name(),
                    "leave it out, or name a --scene to simulate here");
}

void SettingsOptions::warnOfUnusedNetwork() const {
  if (!namesScene()) return;
  for (const char* option :
       {"--transport", "--profile", "--keys", "--peers", "--discovery-server", "--lcm-url", "--domain"})
    if (isGiven(option))
      spdlog::warn("{} is not used: the scene is simulated in this process, without a network", option);
}

void SettingsOptions::nameFiles(const std::vector<std::string>& groom, const std::string& body,
                                const std::string& clip) {
  const std::pair<const char*, std::vector<std::string>> named[] = {
      {"--groom", groom},
      {"--body", body.empty() ? std::vector<std::string>() : std::vector<std::string>{body}},
      {"--body-clip", clip.empty() ? std::vector<std::string>() : std::vector<std::string>{clip}}};
  for (const auto& [option, files] : named)
    if (!files.empty() && app_.get_option(option)->count() > 0)
      throw Error("files are named by arguments and by an option", option, "leave one of them out");
  for (const auto& [option, files] : named) {
    if (files.empty()) continue;
    app_.get_option(option)->add_result(files);
    app_.get_option(option)->run_callback();
  }
}

void SettingsOptions::check(Settings& settings) const {
  for (std::string& line : checkUnusedSettings(settings, use_ == SettingsUse::kCompare))
    settings.warnings.push_back(std::move(line));
}

Settings SettingsOptions::resolve() const {
  Settings config;
  if (!config_.empty()) readConfig(config_, config);
  Settings settings = over(std::move(config));
  check(settings);
  for (const std::string& note : settings.notes) spdlog::info("{}", note);
  for (const std::string& warning : settings.warnings) spdlog::warn("{}", warning);
  return settings;
}

std::vector<CharacterSettings> SettingsOptions::resolveCharacters(const std::string& config_text) const {
  std::vector<CharacterSettings> characters = readCharactersText(config_text, config_.string());
  if (!characters.empty() && isGiven("--groom-id"))
    throw Error("each character has its own groom_id", "--groom-id",
                "leave it out, or change it in " + config_.string());
  for (CharacterSettings& character : characters)
    forCharacter(character, [&] { character.settings = over(std::move(character.settings)); });
  std::map<std::string, std::string> log_writers;  // by URL
  for (const CharacterSettings& character : characters) {
    const Settings& settings = character.settings;
    if (settings.transport != "lcm" || !isLcmLog(settings.lcm_url)) continue;
    const auto [other, is_new] = log_writers.emplace(settings.lcm_url, character.label());
    if (!is_new)
      throw Error(fmt::format("characters {} and {} write one LCM log", other->second, character.label()),
                  settings.lcm_url, "give each its own lcm_url");
  }
  return characters;
}

std::vector<CharacterSettings> SettingsOptions::resolveCharacters() const {
  if (config_.empty()) return {};
  std::vector<CharacterSettings> characters = resolveCharacters(configText(config_));
  for (CharacterSettings& character : characters) forCharacter(character, [&] { check(character.settings); });
  std::set<std::string> told;  // lines about what characters share come once
  for (const CharacterSettings& character : characters) {
    for (const std::string& note : character.settings.notes)
      if (told.insert(note).second) spdlog::info("{}", note);
    for (const std::string& warning : character.settings.warnings)
      if (told.insert(warning).second) spdlog::warn("{}", warning);
  }
  return characters;
}

Settings SettingsOptions::resolve(const std::string& config_text) const {
  Settings config;
  if (!config_.empty()) readConfigText(config_text, config_.string(), config);
  return over(std::move(config));
}

void SettingsOptions::refuseEmptyNames() const {
  const struct {
    const char* option;
    bool is_empty;
    const char *reason, *remedy;
  } options[] = {
      {"--config", config_.empty(), "the configuration file has no name", "name a TOML file"},
      {"--collider-folder", given_.collider_folder.empty(), "the folder of colliders has no name",
       "name a folder of meshes"},
      {"--motion", given_.scene.motion.empty(), "the motion has no name", "e.g. --motion shake"},
  };
  for (const auto& [option, is_empty, reason, remedy] : options)
    if (is_empty && isGiven(option)) throw Error(reason, option, remedy);
}

void SettingsOptions::recordOrigins(Settings& out) const {
  const struct {
    const char* option;
    std::vector<const char*> replaced;
  } replacing[] = {{"--scene",
                    {"groom.files", "groom.hair_files", "groom.guides", "groom.unit_meters", "groom.up",
                     "body.file", "body.contact", "body.cell", "body.fitted_spheres", "body.clip",
                     "body.joint", "body.roots", "body.targets", "body.unit_meters", "body.up"}},
                   {"--groom", {"scene", "groom.length"}},
                   {"--transport", {"transport.peers", "transport.discovery_server", "transport.lcm_url"}}};
  for (const auto& [option, replaced] : replacing)
    for (const char* key : replaced) {
      const auto of_file = out.given.find(key);
      if (!isGiven(option) || of_file == out.given.end()) continue;
      out.notes.push_back(fmt::format("{}, {} is overridden by {}", of_file->second, key, option));
      out.given.erase(of_file);
    }
  for (const auto& [option, key] : kOptionKeys)
    if (isGiven(option)) out.given[key] = option;
}

bool SettingsOptions::isGiven(const char* option) const { return isGivenTo(app_, option); }

Settings SettingsOptions::over(Settings out) const {
  auto lay = [&](const char* option, auto& to, const auto& from) {
    if (isGiven(option)) to = from;
  };
  if (app_.count("--scene") > 0 && app_.count("--groom") > 0)
    throw Error("a procedural scene and a groom cannot be simulated together", "--scene and --groom",
                "leave one of them out");
  if (app_.count("--scene") > 0) {  // replaces the file's groom and its settings
    out.scene.name = given_.scene.name;
    out.scene.groom.clear();
    out.scene.hairs.clear();
    out.scene.guides = {};
    out.scene.body.clear();
    out.scene.body_units = {};
    if (!isBvh(out.scene.motion)) out.scene.clip_unit_meters = 0;
    out.scene.skinned.reset();
  }
  if (app_.count("--groom") > 0) {  // replaces the file's scene
    out.scene.groom.assign(groom_.begin(), groom_.end());
    out.scene.length = 0;
  }
  if (app_.count("--hair-files") > 0) out.scene.hairs.assign(hairs_.begin(), hairs_.end());
  if (app_.count("--guides") > 0) out.scene.guides = guideChoiceOf(guides_);
  if (isGiven("--transport")) {  // replaces the file's addresses
    out.peers.clear();
    out.discovery_server.clear();
    out.lcm_url.clear();
  }
  lay("--body", out.scene.body, given_.scene.body);
  if (!body_contact_.empty()) out.scene.body_contact = bodyContactOf(body_contact_);
  if (!body_clip_.empty() || !body_joint_.empty() || !body_roots_.empty() || !body_targets_.empty()) {
    if (!out.scene.skinned) out.scene.skinned.emplace();
    if (!body_clip_.empty()) out.scene.skinned->clip = body_clip_;
    if (!body_joint_.empty()) out.scene.skinned->joint = body_joint_;
    if (!body_roots_.empty()) out.scene.skinned->roots = bodyRootsOf(body_roots_);
    if (!body_targets_.empty()) out.scene.skinned->targets = bodyTargetsOf(body_targets_);
  }
  lay("--body-cell", out.scene.body_cell, given_.scene.body_cell);
  lay("--unit-meters", out.scene.units.unit_meters, given_.scene.units.unit_meters);
  if (app_.count("--up") > 0) out.scene.units.up = upAxisOf(up_);
  lay("--body-unit-meters", out.scene.body_units.unit_meters, given_.scene.body_units.unit_meters);
  if (app_.count("--body-up") > 0) out.scene.body_units.up = upAxisOf(body_up_, "--body-up");
  lay("--clip-unit-meters", out.scene.clip_unit_meters, given_.scene.clip_unit_meters);
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
  lay("--pose-delay-max", out.poses.delay_max, given_.poses.delay_max);
  lay("--pose-extrapolate", out.poses.extrapolate, given_.poses.extrapolate);
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
  lay("--hair-error", out.codec.hair_error, static_cast<float>(hair_error_mm_ * 1e-3));
  lay("--zstd", out.codec.zstd, given_.codec.zstd);
  lay("--key-interval", out.codec.key_interval, given_.codec.key_interval);
  out.codec.threads = out.threads;
  refuseEmptyNames();
  recordOrigins(out);
  for (const std::string& text : material_) {
    out.scene.materials.push_back(parseMaterial(text));
    for (const MaterialRule::Setting& setting : out.scene.materials.back().settings)
      out.given["material." + setting.name] = "--material " + text;
  }
  const size_t of_file = out.parameters.size();
  for (const std::string& text : set_) {
    const auto assignment = parseAssignment(text);
    refuseSetTwice({out.parameters.begin() + static_cast<ptrdiff_t>(of_file), out.parameters.end()},
                   assignment, text);
    Parameters check;
    setParameter(check, assignment.first, assignment.second, "--set " + text);
    out.given["parameters." + assignment.first] = "--set " + text;
    out.parameters.push_back(assignment);
  }
  out.scene.hair_radius_is_set = std::any_of(out.parameters.begin(), out.parameters.end(),
                                             [](const auto& set) { return set.first == "hair_radius"; });
  return out;
}

}  // namespace strandcast
