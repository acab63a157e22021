#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "air/wind_source.h"
#include "core/parameters.h"
#include "scenes/scene.h"
#include "transport/codec/codec.h"

namespace CLI {
class App;
}

namespace strandcast {

/// Largest seed: beyond it a TOML number is no longer exact as a whole number.
constexpr double kLargestSeed = 1e15;

/// How a daemon takes the poses of live sources (service/live_poses.h).
struct PoseOptions {
  double delay_max = 0.25;   ///< s, longest that steps wait for late poses, 0 to 0.4
  double extrapolate = 0.1;  ///< s for which motion goes on without poses, 0 to 1
};

/// All settings of a daemon (or of a viewer with an embedded daemon), from a TOML file and from options;
/// options win.
struct Settings {
  SceneOptions scene;
  std::vector<std::pair<std::string, std::vector<double>>> parameters;  ///< by name; override the scene's own
  std::vector<NamedWindSource> wind_sources;                            ///< names are unique

  SolverKind solver = SolverKind::kRod;
  bool sag_free = true;  ///< rest strains are changed so that the groomed shape is at rest under gravity (rod
                         ///< only)
  std::string backend = "auto";
  int threads = 0;                ///< of the simd backend; 0 = all
  std::string transport = "dds";  ///< "dds" or "lcm"
  std::string lcm_url;            ///< empty: lcmUrl(domain)
  int domain = 0;                 ///< 0 to 232; DDS domain, or offset of the LCM port
  uint32_t groom_id = 1;
  std::string profile = "reliable-lan";  ///< a name of ddsProfileList()
  std::vector<std::string> peers;        ///< IPv4 addresses; DDS
  std::string discovery_server;          ///< "ADDRESS:PORT"; DDS
  std::filesystem::path keys;            ///< of the profile "secure"
  std::optional<uint32_t> claim;         ///< ownership strength among daemons that share the groom (DDS)
  CodecOptions codec;                    ///< of the frames that are cast
  double rate = 60;                      ///< frames published per second
  double duration = 0;                   ///< s; 0 = until interrupted
  PoseOptions poses;
  /// Absolute; commands may name files in it. Empty: commands may open no file.
  std::filesystem::path collider_folder;

  /// Origin of each setting that was given: an option or "hair.toml line 3", by the key of a configuration
  /// file ("groom.length", "claim"). For tables that may be repeated, the last one counts.
  std::map<std::string, std::string> given;
  std::vector<std::string> notes;     ///< settings of the file that options override, a line each
  std::vector<std::string> warnings;  ///< settings without effect beside others, a line each
};

/// One of several characters of a daemon: a table [[character]] of its configuration.
struct CharacterSettings {
  Settings settings;
  std::string name;              ///< unique; may be empty
  double budget_ms = 0;          ///< of the machine's time, a frame (RateBudget); 0 = its equal share
  std::filesystem::path record;  ///< its recording; empty: none

  /// What messages call it: its name, else "groom 3".
  std::string label() const { return name.empty() ? "groom " + std::to_string(settings.groom_id) : name; }
};

/// How a program uses the settings. kCast: simulates at a steady rate and publishes frames. kServe: also
/// executes commands of others. kCompare: runs the scene with several solvers, with neither rate nor network.
/// kCheck: as kCast, for a short run without network; --clip also means --body-clip.
enum class SettingsUse { kCast, kServe, kCompare, kCheck };

/// Declares the options of scene and simulation on `app`; resolve() reads them.
class SettingsOptions {
 public:
  explicit SettingsOptions(CLI::App& app, SettingsUse use = SettingsUse::kCast);
  /// After parsing: reads the --config file, then applies the options over it. Settings without effect beside
  /// others are refused or logged (options/settings.h). Throws Error (file, line, key).
  Settings resolve() const;
  /// The same with this text in place of the --config file, for settings that have run before: settings
  /// without effect are neither refused nor logged.
  Settings resolve(const std::string& config_text) const;
  /// The characters of a --config file with tables [[character]], each with the options over its settings;
  /// else empty. resolve() refuses such a file. Checks settings and throws Error as resolve(); one about a
  /// single character names it.
  std::vector<CharacterSettings> resolveCharacters() const;
  /// The same with this text in place of the file, and without the checks.
  std::vector<CharacterSettings> resolveCharacters(const std::string& config_text) const;
  /// Files that are named as arguments count as --groom, --body and --body-clip; an empty name is none. Call
  /// after parsing and before resolve(). Throws Error where an option names a file, too.
  void nameFiles(const std::vector<std::string>& groom, const std::string& body, const std::string& clip);
  /// The --config file; empty where none was given.
  const std::filesystem::path& config() const { return config_; }
  /// Whether a scene was asked for (--scene, --groom, --body or --config): then a viewer needs no daemon.
  bool namesScene() const;
  /// Throws Error where options of scene or simulation are given without a scene: another program simulates
  /// then, and those options belong to it.
  void refuseWithoutScene() const;
  /// Logs which network options have no effect because the scene is simulated in this process.
  void warnOfUnusedNetwork() const;

 private:
  Settings over(Settings config) const;
  /// Throws Error on settings that are refused; appends warnings of those without effect.
  void check(Settings& settings) const;
  /// False for an option that the program does not have.
  bool isGiven(const char* option) const;
  void refuseEmptyNames() const;
  /// Records the options in settings.given; entries of the file that options override are removed.
  void recordOrigins(Settings& settings) const;

  CLI::App& app_;
  const SettingsUse use_;
  const CLI::App *scene_ = nullptr, *simulation_ = nullptr;  ///< option groups
  std::filesystem::path config_;
  Settings given_;
  std::string guides_;
  std::string up_, body_up_, solver_, codec_, body_contact_, body_clip_, body_joint_, body_roots_,
      body_targets_;
  double codec_error_mm_ = 0, hair_error_mm_ = 0;
  bool sag_free_ = true;
  std::vector<std::string> groom_, hairs_, material_, set_;
};

/// "auto", "x", "y" or "z"; Error otherwise, naming `where`.
UpAxis upAxisOf(const std::string& name, const std::string& where = "--up");

/// "all", a share of the groom's strands as "5%", or else a file. Throws Error, naming `where`, on an empty
/// text and on a share that is not above 0 and below 100 %.
GuideChoice guideChoiceOf(const std::string& text, const std::string& where = "--guides");

/// "field" or "spheres"; Error otherwise, naming `where`.
BodyContact bodyContactOf(const std::string& name, const std::string& where = "--body-contact");
/// "skin" or "joint"; Error otherwise, naming `where`.
BodyRoots bodyRootsOf(const std::string& name, const std::string& where = "--body-roots");
/// "clip" or "all"; Error otherwise, naming `where`.
BodyTargets bodyTargetsOf(const std::string& name, const std::string& where = "--body-targets");

/// Adds the options of every program that joins a network: --transport, --profile, --keys, --peers,
/// --discovery-server, --lcm-url, --domain and --groom-id.
void addNetworkOptions(CLI::App& app, Settings& settings);
/// For a program with only these options, after parsing: records which were given. Throws Error where one has
/// no effect beside the others.
void checkNetworkOptions(const CLI::App& app, Settings& settings);

/// Reads a configuration file of at most 1 MiB as text. Throws Error.
std::string configText(const std::filesystem::path& file);
/// Reads a configuration file over `settings`. Every unknown key is an Error that names its line and the
/// nearest known key.
void readConfig(const std::filesystem::path& file, Settings& settings);
/// The same from text; `name` appears in errors.
void readConfigText(const std::string& text, const std::string& name, Settings& settings);

/// The characters of a configuration file's text, each with the file's other settings and its own over them;
/// empty where the file has no table [[character]]. Lists and repeated tables of a character replace the
/// file's. Throws Error, as readConfigText(), and where characters share a groom id, a name or a recording.
std::vector<CharacterSettings> readCharactersText(const std::string& text, const std::string& name);
/// Calls `work`; an Error that it throws then names the character.
void forCharacter(const CharacterSettings& character, const std::function<void()>& work);

/// Checks for settings that others make void, by the tables in unused_settings.cc. A setting is reported at
/// its origin, an option or a file: see Settings::given. A refused setting of a file gives way where an
/// option makes it void, and is then reported as a note.
///
/// Throws Error for the first refused setting, naming its origin and the remedy. Returns a line for each of
/// the others. `any_solver`: skips the rules about one solver, because the program runs several.
std::vector<std::string> checkUnusedSettings(const Settings& settings, bool any_solver = false);

/// The network rules alone, for programs with only the options of addNetworkOptions().
void checkUnusedNetworkSettings(const Settings& settings);

/// The key of the configuration file that means the same as an option: "groom.files" of "--groom". Empty
/// where there is none.
std::string configKeyOf(const std::string& option);

/// The condition under which a parameter has an effect, "it needs wind_grid=1"; empty where it always has.
std::string conditionOf(const std::string& name);
/// That condition where it is not met by `parameters`; empty otherwise.
std::string unmetConditionOf(const Parameters& parameters, const std::string& name);

}  // namespace strandcast
