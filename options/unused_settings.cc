#include "options/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "core/error.h"
#include "transport/dds.h"

namespace strandcast {
namespace {

enum class Severity {
  kRefused,
  kWarned,     ///< warns that the setting is not used
  kPartlyUsed  ///< warns that the setting is used in part
};

// A row of a table: `key`, as in configuration files, has no effect where `is_unused`. `cause`: the key of
// the setting that makes it void; empty where a missing setting does.
struct UnusedSetting {
  const char *key, *cause;
  bool (*is_unused)(const Settings&);
  const char *reason, *remedy;
  Severity severity;
};

bool hasFiles(const Settings& s) { return !s.scene.groom.empty(); }
bool hasHairs(const Settings& s) { return !s.scene.hairs.empty(); }
bool hasBody(const Settings& s) { return !s.scene.body.empty(); }
bool hasNoBodyFile(const Settings& s) { return !hasBody(s); }
bool hasNoBody(const Settings& s) { return hasFiles(s) && !hasBody(s); }
bool isGrown(const Settings& s) { return !hasFiles(s); }
/// Whether there are meshes besides the body, from the scene or from commands.
bool hasMeshes(const Settings& s) {
  return !s.collider_folder.empty() || std::any_of(s.scene.primitives.begin(), s.scene.primitives.end(),
                                                   [](const auto& p) { return !p.file.empty(); });
}
bool isGrownAlone(const Settings& s) { return isGrown(s) && !hasMeshes(s); }
bool hasSpheres(const Settings& s) { return s.scene.body_contact == BodyContact::kSpheres; }
bool isRod(const Settings& s) { return s.solver == SolverKind::kRod; }
bool isGaussSeidel(const Settings& s) { return !isRod(s); }
bool isLcm(const Settings& s) { return s.transport == "lcm"; }
bool isDds(const Settings& s) { return !isLcm(s); }
bool isSecure(const Settings& s) { return ddsProfileNamed(s.profile, "--profile") == DdsProfile::kSecure; }

Parameters parametersOf(const Settings& s) {
  Parameters parameters;
  for (const auto& [name, values] : s.parameters) setParameter(parameters, name, values, "parameters");
  return parameters;
}

constexpr Severity kRefused = Severity::kRefused, kWarned = Severity::kWarned,
                   kPartlyUsed = Severity::kPartlyUsed;

// clang-format off
constexpr UnusedSetting kSceneRules[] = {
    {"scene", "groom.files", hasFiles,
     "a procedural scene and a groom cannot be simulated together", "leave one of them out", kRefused},
    {"groom.length", "groom.files", hasFiles,
     "hair of groom files has its own length", "leave length out (--length): it is for procedural scenes", kRefused},
    {"seed", "groom.files", hasFiles,
     "groom files use no random numbers", "leave the seed out", kWarned},
    {"groom.hair_files", "scene", isGrown,
     "a procedural scene has no hairs that follow guides", "leave it out, or give a --groom", kRefused},
    {"groom.guides", "scene", isGrown,
     "a procedural scene has no hairs that follow guides", "leave it out, or give a --groom", kRefused},
    {"groom.guides", "groom.hair_files", hasHairs,
     "where hairs have files of their own, all strands of the groom are guides", "leave one of them out", kRefused},
    {"groom.strands", "groom.guides", [](const Settings& s) { return s.scene.guides.share > 0; },
     "the share gives the number of guides", "leave one of them out", kRefused},
    {"groom.unit_meters", "scene", isGrownAlone,
     "procedural hair is in metres", "leave it out, or give a --groom", kRefused},
    {"groom.up", "scene", isGrownAlone,
     "procedural hair has Y up", "leave it out, or give a --groom", kRefused},
    {"body.unit_meters", "", hasNoBodyFile, "there is no body file", "leave it out, or give a --body", kRefused},
    {"body.up", "", hasNoBodyFile, "there is no body file", "leave it out, or give a --body", kRefused},
    {"body.contact", "", hasNoBody, "there is no body", "give a --body", kRefused},
    {"body.cell", "", [](const Settings& s) { return hasNoBody(s) && !hasMeshes(s); },
     "there is no body", "give a --body", kRefused},
    {"body.fitted_spheres", "", hasNoBody, "there is no body", "give a --body", kRefused},
    {"body.friction", "", hasNoBody, "there is no body", "give a --body", kRefused},
    {"body.cell", "body.contact", [](const Settings& s) { return hasSpheres(s) && !hasMeshes(s); },
     "spheres have no cells", "leave it out, or --body-contact field", kRefused},
    {"body.fitted_spheres", "body.contact", [](const Settings& s) { return hasBody(s) && !hasSpheres(s); },
     "the body collides through its distance field", "leave it out, or --body-contact spheres", kWarned},
    {"body.contact", "scene", isGrown, "the procedural body consists of shapes", "leave it out", kWarned},
    {"body.cell", "scene", isGrownAlone, "the procedural body consists of shapes", "leave it out", kWarned},
    {"body.fitted_spheres", "scene", isGrown, "the procedural body consists of shapes", "leave it out", kWarned},
};

constexpr UnusedSetting kSolverRules[] = {
    {"material.tether", "daemon.solver", isRod,
     "the rod is inextensible", "leave it out, or --solver gauss_seidel", kWarned},
    {"daemon.sag_free", "daemon.solver", isGaussSeidel,
     "only the rod is made sag-free", "leave it out, or --solver rod", kWarned},
    {"material.youngs_modulus", "daemon.solver", isGaussSeidel,
     "gauss_seidel has no elasticity", "leave it out, or --solver rod", kWarned},
    {"material.poisson_ratio", "daemon.solver", isGaussSeidel,
     "gauss_seidel has no elasticity", "leave it out, or --solver rod", kWarned},
    {"material.shear_modulus", "daemon.solver", isGaussSeidel,
     "gauss_seidel has no elasticity", "leave it out, or --solver rod", kWarned},
    {"material.stiffness_curve", "daemon.solver", isGaussSeidel,
     "gauss_seidel has no elasticity", "leave it out, or --solver rod", kWarned},
    {"material.damping_scale", "daemon.solver", isGaussSeidel,
     "gauss_seidel has no internal damping", "leave it out, or --solver rod", kWarned},
    {"material.damping_curve", "daemon.solver", isGaussSeidel,
     "gauss_seidel has no internal damping", "leave it out, or --solver rod", kWarned},
};

constexpr UnusedSetting kNetworkRules[] = {
    {"transport.lcm_url", "transport.kind", isDds, "DDS has no URL", "add --transport lcm", kRefused},
    {"transport.domain", "transport.lcm_url", [](const Settings& s) { return isLcm(s) && !s.lcm_url.empty(); },
     "the LCM URL gives the port", "leave the domain out, or the URL", kRefused},
    {"transport.profile", "transport.kind", isLcm,
     "profiles belong to DDS: LCM has no security and no repair", "use --transport dds", kRefused},
    {"transport.keys", "transport.kind", isLcm, "LCM has no security", "use --transport dds", kRefused},
    {"transport.peers", "transport.kind", isLcm,
     "LCM has no discovery", "name the destination with --lcm-url, or use --transport dds", kRefused},
    {"transport.discovery_server", "transport.kind", isLcm,
     "LCM has no discovery", "name the destination with --lcm-url, or use --transport dds", kRefused},
    {"claim", "transport.kind", isLcm, "daemons cannot share a groom over LCM", "use --transport dds", kRefused},
    {"transport.keys", "transport.profile", [](const Settings& s) { return !isSecure(s); },
     "only the profile secure uses keys", "give --profile secure too", kRefused},
};

constexpr UnusedSetting kCodecRules[] = {
    {"transport.codec_error_mm", "transport.codec", [](const Settings& s) { return s.codec.codec == Codec::kFloat32; },
     "float32 has no error", "leave the error out, or choose another codec", kRefused},
    {"transport.hair_error_mm", "groom.guides", [](const Settings& s) { return s.scene.groom.empty() || s.scene.guides.all; },
     "all strands are simulated: no hairs follow guides", "leave it out, or name a groom with --guides 5%", kRefused},
    {"transport.zstd", "transport.codec",
     [](const Settings& s) {
       return s.codec.codec != Codec::kDelta16 && s.codec.codec != Codec::kOctahedral12 && s.codec.codec != Codec::kOctahedral16;
     },
     "zstd is for delta16, oct12 and oct16", "leave it out, or choose one of them", kRefused},
    {"transport.key_interval", "transport.codec", [](const Settings& s) { return s.codec.codec != Codec::kTemporal; },
     "only the temporal codec has key frames", "leave it out, or --codec temporal", kRefused},
    {"daemon.rate", "parameters.time_step",
     [](const Settings& s) { return s.rate * static_cast<double>(parametersOf(s).time_step) > 1 + 1e-6; },
     "the frame rate is above the step rate: some frames are published twice",
     "give a lower rate, or a shorter time step (--set time_step)", kPartlyUsed},
};

// Parameters that others make void: solver parameters first, then air and hair on grids (docs/air.md).
struct UnusedParameter {
  const char* name;
  bool (*is_unused)(const Parameters&);
  const char* needs;
};
using P = Parameters;
bool isOfRod(const P& p) { return p.solver == SolverKind::kRod; }
bool hasNoDrag(const P& p) { return p.air_drag == 0; }
bool hasNoWindGrid(const P& p) { return p.wind_grid == 0; }
bool hasNoGrid(const P& p) { return p.wind_grid == 0 && p.volume_stiffness == 0 && p.hair_friction == 0; }
bool isStill(const P& p) { return p.wind.isZero(); }
constexpr const char *kNeedsGaussSeidel = "only --solver gauss_seidel uses it", *kNeedsDrag = "it needs air_drag above 0",
                     *kNeedsWindGrid = "it needs wind_grid=1", *kNeedsWind = "it needs a wind that is not zero",
                     *kNeedsVolume = "it needs volume_stiffness above 0";
constexpr UnusedParameter kParameterRules[] = {
    {"iterations", isOfRod, kNeedsGaussSeidel},
    {"shape_rate", isOfRod, kNeedsGaussSeidel},
    {"shape_rate_tip", isOfRod, kNeedsGaussSeidel},
    {"damping_time", [](const P& p) { return !isOfRod(p); }, "only --solver rod uses it"},
    {"wind", hasNoDrag, kNeedsDrag},
    {"air_drag_along", hasNoDrag, kNeedsDrag},
    {"grid_cells", hasNoGrid, "it needs wind_grid=1, or volume_stiffness or hair_friction above 0"},
    {"mac_cormack", hasNoWindGrid, kNeedsWindGrid},
    {"air_viscosity", hasNoWindGrid, kNeedsWindGrid},
    {"hairs_per_strand", hasNoWindGrid, kNeedsWindGrid},
    {"gust", isStill, kNeedsWind},
    {"turbulence", isStill, kNeedsWind},
    {"gust_period", [](const P& p) { return p.gust == 0; }, "it needs a gust above 0"},
    {"turbulence_length", [](const P& p) { return p.turbulence == 0; }, "it needs turbulence above 0"},
    {"wind_seed", [](const P& p) { return p.gust == 0 && p.turbulence == 0; }, "it needs gust or turbulence above 0"},
    {"volume_hold", [](const P& p) { return p.volume_stiffness == 0; }, kNeedsVolume},
    {"volume_target", [](const P& p) { return p.volume_stiffness == 0; }, kNeedsVolume},
};
// clang-format on

bool isOption(const std::string& place) { return place.starts_with("--"); }

std::string nameOf(const char* key, const std::string& place) {
  return isOption(place) ? place : fmt::format("{}, {}", place, key);
}

void check(std::span<const UnusedSetting> rules, const Settings& s, std::vector<std::string>& told) {
  for (const UnusedSetting& rule : rules) {
    const auto given = s.given.find(rule.key);
    if (given == s.given.end() || !rule.is_unused(s)) continue;
    const auto cause = s.given.find(rule.cause);
    const bool gives_way = !isOption(given->second) && cause != s.given.end() && isOption(cause->second);
    const Error refusal(rule.reason, nameOf(rule.key, given->second), rule.remedy);
    if (rule.severity == kRefused && !gives_way) throw refusal;
    const std::string line =
        rule.severity == Severity::kPartlyUsed
            ? refusal.what()
            : fmt::format("{} is not used: {}", nameOf(rule.key, given->second), rule.reason);
    if (std::find(told.begin(), told.end(), line) == told.end()) told.push_back(line);
  }
}

void checkParameters(const Settings& s, bool any_solver, std::vector<std::string>& told) {
  Parameters parameters = parametersOf(s);
  parameters.solver = s.solver;
  const Parameters standard;
  for (const UnusedParameter& rule : kParameterRules) {
    const auto given = s.given.find(std::string("parameters.") + rule.name);
    const bool is_of_solver = rule.needs == kNeedsGaussSeidel || std::string(rule.name) == "damping_time";
    if (given == s.given.end() || !rule.is_unused(parameters) || (any_solver && is_of_solver)) continue;
    // Presets and the viewer name every parameter, so a default value does not count as given.
    if (parameter(parameters, rule.name) == parameter(standard, rule.name)) continue;
    told.push_back(
        fmt::format("{} is not used: {}", nameOf(given->first.c_str(), given->second), rule.needs));
  }
}

}  // namespace

std::vector<std::string> checkUnusedSettings(const Settings& settings, bool any_solver) {
  std::vector<std::string> told;
  check(kSceneRules, settings, told);
  check(kNetworkRules, settings, told);
  check(kCodecRules, settings, told);
  if (!any_solver) check(kSolverRules, settings, told);
  checkParameters(settings, any_solver, told);
  return told;
}

void checkUnusedNetworkSettings(const Settings& settings) {
  std::vector<std::string> told;
  check(kNetworkRules, settings, told);
}

std::string conditionOf(const std::string& name) {
  for (const UnusedParameter& rule : kParameterRules)
    if (rule.name == name) return rule.needs;
  return {};
}

std::string unmetConditionOf(const Parameters& parameters, const std::string& name) {
  for (const UnusedParameter& rule : kParameterRules)
    if (rule.name == name && rule.is_unused(parameters)) return rule.needs;
  return {};
}

}  // namespace strandcast
