#pragma once
#include <cstdint>
#include <filesystem>
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

/// A seed at most: beyond it a number of a TOML file is no longer whole.
constexpr double kLargestSeed = 1e15;

/// All that a daemon (or a viewer with the simulation inside) is told, by a TOML file and by options; options
/// win.
struct Settings {
  SceneOptions scene;
  std::vector<std::pair<std::string, std::vector<double>>>
      parameters;                             ///< by name, on top of the scene's own
  std::vector<NamedWindSource> wind_sources;  ///< none of a name twice

  SolverKind solver = SolverKind::kRod;
  bool sag_free = true;  ///< the groomed shape is the shape at rest under gravity (rod only)
  std::string backend = "auto";
  int threads = 0;                ///< of the simd backend; 0 = all
  std::string transport = "dds";  ///< "dds" or "lcm"
  std::string lcm_url;            ///< empty: lcmUrl(domain)
  int domain = 0;                 ///< 0 to 232; of DDS, or the port of LCM
  uint32_t groom_id = 1;
  std::string profile = "reliable-lan";  ///< of ddsProfileList()
  std::vector<std::string> peers;        ///< IPv4 addresses; DDS
  std::string discovery_server;          ///< "ADDRESS:PORT"; DDS
  std::filesystem::path keys;            ///< of the profile "secure"
  std::optional<uint32_t> claim;         ///< strength among daemons that share the groom (DDS)
  CodecOptions codec;                    ///< of the frames that are cast
  double rate = 60;                      ///< frames published per second
  double duration = 0;                   ///< s; 0 = until interrupted
  /// Absolute; commands may name files in it. Empty: commands have no file opened.
  std::filesystem::path collider_folder;

  /// Where each setting was given that was: by key of a configuration file ("groom.length", of tables that
  /// may be repeated the last; "claim"), the option or "hair.toml line 3".
  std::map<std::string, std::string> given;
  std::vector<std::string> notes;     ///< what of a file gives way to options, a line each
  std::vector<std::string> warnings;  ///< what does nothing beside other settings, likewise
};

/// What a program does with the settings: simulate at a steady rate and cast frames, the same and obey the
/// commands of others, or run the scene with several solvers for itself, with neither rate nor network.
enum class SettingsUse { kCast, kServe, kCompare };

/// Declares the options of scene and simulation on `app`, to be read into the returned holder by `resolve`.
class SettingsOptions {
 public:
  explicit SettingsOptions(CLI::App& app, SettingsUse use = SettingsUse::kCast);
  /// After parsing: reads the --config file, then lays the options given over it. What does nothing beside
  /// other settings is refused or logged (apps/void_settings.h). Throws Error (file, line, key).
  Settings resolve() const;
  /// The same with this text in place of what the --config file holds now, and of settings that ran before:
  /// none is refused or told of for what others do to it.
  Settings resolve(const std::string& config_text) const;
  /// The --config file; empty where none is given.
  const std::filesystem::path& config() const { return config_; }
  /// Whether a scene was asked for (--scene, --groom, --body or --config): then a viewer needs no daemon.
  bool namesScene() const;
  /// Throws Error where scene or simulation are told of although no scene is named: another program
  /// simulates, and it is told there.
  void refuseWithoutScene() const;
  /// Logs which options of the network do nothing where the scene is simulated in this process.
  void warnOfUnusedNetwork() const;

 private:
  Settings over(Settings config) const;
  /// Not of an option that the program does not have.
  bool isGiven(const char* option) const;
  void refuseEmptyNames() const;
  /// Into settings.given; what the file has and options replace goes.
  void noteGiven(Settings& settings) const;

  CLI::App& app_;
  const SettingsUse use_;
  const CLI::App *scene_ = nullptr, *simulation_ = nullptr;  ///< groups of its options
  std::filesystem::path config_;
  Settings given_;
  std::string up_, body_up_, solver_, codec_, body_contact_, body_clip_, body_joint_, body_roots_;
  double codec_error_mm_ = 0;
  bool sag_free_ = true;
  std::vector<std::string> groom_, material_, set_;
};

/// "auto", "x", "y" or "z"; Error otherwise, naming `where`.
UpAxis upAxisOf(const std::string& name, const std::string& where = "--up");

/// "field" or "spheres"; Error otherwise, naming `where`.
BodyContact bodyContactOf(const std::string& name, const std::string& where = "--body-contact");
/// "skin" or "joint"; Error otherwise, naming `where`.
BodyRoots bodyRootsOf(const std::string& name, const std::string& where = "--body-roots");

/// Adds --transport, --profile, --keys, --peers, --discovery-server, --lcm-url, --domain and --groom-id,
/// which every program that joins a network has.
void addNetworkOptions(CLI::App& app, Settings& settings);
/// Of a program with these options and no others, once they are parsed: which were given. Throws Error where
/// one does nothing beside the others.
void checkNetworkOptions(const CLI::App& app, Settings& settings);

/// The text of a configuration file of at most 1 MiB. Throws Error.
std::string configText(const std::filesystem::path& file);
/// Reads a configuration file over `settings`. Every unknown key is an Error that names its line and the
/// nearest known key.
void readConfig(const std::filesystem::path& file, Settings& settings);
/// The same from text; `name` appears in errors.
void readConfigText(const std::string& text, const std::string& name, Settings& settings);

}  // namespace strandcast
