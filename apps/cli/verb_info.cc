#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "apps/cli/verbs.h"
#include "core/error.h"
#include "core/strand_set.h"
#include "gpu_compute/gpu_backend.h"
#include "groom/groom.h"
#include "io/axes_and_units.h"
#include "options/console.h"
#include "options/number_range.h"
#include "options/settings.h"
#include "service/scene_simulation.h"
#include "transport/codec/codec.h"
#include "transport/codec/guide_encoder.h"
#include "transport/dds.h"
#include "transport/lcm.h"

namespace strandcast {
namespace {

/// Bytes per frame of these guides at rest on the network, with the daemon's default codec. Empty where a
/// strand is too long for the network.
std::optional<uint64_t> bytesPerFrame(const StrandSet& guides) {
  for (size_t s = 0; s < guides.strands(); ++s)
    if (guides.verticesOf(s) > kMaxWireVertices) return std::nullopt;
  GuideEncoder encoder{CodecOptions()};
  encoder.setGroom(guides);
  GuideFrame frame;
  frame.frame = 1;
  frame.positions = guides.positions;
  GuideChunk chunk;
  for (uint32_t i = 0; i < encoder.runs().size(); ++i) encoder.encode(frame, i, chunk);
  return encoder.report().frame_bytes;
}

struct InfoOptions {
  std::string file, up = "auto";
  float unit_meters = 0;
  bool backends = false, json = false;
};

void printGpus(const std::vector<GpuListing>& gpus) {
  fmt::print("STRANDCAST_GPU selects one of these OpenGL devices:\n");
  for (const GpuListing& gpu : gpus)
    fmt::print("  {:<10} {}{}\n", gpu.number, gpu.device, gpu.uuid.empty() ? "" : "  GPU-" + gpu.uuid);
}

/// The known backends. Where that throws, e.g. because STRANDCAST_GPU names no device, prints the GPUs first.
std::vector<BackendInfo> backendsOr(const std::vector<GpuListing>& gpus) {
  try {
    return knownBackends();
  } catch (const Error&) {
    printGpus(gpus);
    throw;
  }
}

int printBackends(bool json) {
  nlohmann::json list = nlohmann::json::array(), devices = nlohmann::json::array();
  std::string why_no_dds, why_no_lcm;
  const bool dds = ddsAvailable(&why_no_dds), lcm = lcmAvailable(&why_no_lcm);
  const std::vector<GpuListing> gpus = gpuList();
  for (const GpuListing& gpu : gpus)
    devices.push_back({{"number", gpu.number}, {"device", gpu.device}, {"uuid", gpu.uuid}});
  for (const BackendInfo& info : backendsOr(gpus)) {
    list.push_back({{"name", info.name},
                    {"available", info.available},
                    {"score", info.score},
                    {info.available ? "device" : "reason", info.reason}});
    if (!json)
      fmt::print("  {:<10} {:<4} score {:>3}  {}\n", info.name, info.available ? "yes" : "no", info.score,
                 info.reason);
  }
  if (json) {
    fmt::print("{}\n", jsonText({{"backends", list}, {"gpus", devices}, {"dds", dds}, {"lcm", lcm}}));
    return 0;
  }
  fmt::print("  {:<10} {:<4}            {}\n", "dds", dds ? "yes" : "no", dds ? "Fast DDS" : why_no_dds);
  fmt::print("  {:<10} {:<4}            {}\n", "lcm", lcm ? "yes" : "no", lcm ? "UDP multicast" : why_no_lcm);
  if (gpus.size() > 1) printGpus(gpus);
  return 0;
}

nlohmann::json toJson(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

/// The smallest and the largest width of a groom, m; empty where it has none.
std::optional<std::pair<double, double>> widthsOf(const StrandSet& strands) {
  if (strands.radii.empty()) return std::nullopt;
  const auto [least, most] = std::minmax_element(strands.radii.begin(), strands.radii.end());
  return std::pair{2 * static_cast<double>(*least), 2 * static_cast<double>(*most)};
}

/// Counts of strands of each group, in the order of the table.
std::vector<size_t> strandsPerGroup(const RawGroom& raw) {
  std::vector<size_t> counts(raw.groups.size());
  for (const uint32_t group : raw.strands.groups) ++counts[group];
  return counts;
}

nlohmann::json groupsOf(const RawGroom& raw) {
  const std::vector<size_t> counts = strandsPerGroup(raw);
  nlohmann::json list = nlohmann::json::array();
  for (size_t g = 0; g < counts.size(); ++g)
    list.push_back({{"id", raw.groups[g].id}, {"name", raw.groups[g].name}, {"strands", counts[g]}});
  return list;
}

/// "2: 0 fringe (120 strands), 1 (80 strands)"
std::string lineOfGroups(const RawGroom& raw) {
  constexpr size_t kNamed = 5;
  const std::vector<size_t> counts = strandsPerGroup(raw);
  std::vector<std::string> groups;
  for (size_t g = 0; g < std::min(kNamed, counts.size()); ++g) {
    const std::string name = printable(raw.groups[g].name);
    groups.push_back(
        fmt::format("{}{}{} ({} strands)", raw.groups[g].id, name.empty() ? "" : " ", name, counts[g]));
  }
  if (counts.size() > kNamed) groups.emplace_back("...");
  return fmt::format("{}: {}", counts.size(), fmt::join(groups, ", "));
}

int printGroom(const InfoOptions& options) {
  const std::filesystem::path file(options.file);
  const RawGroom raw = readRawGroom(file);
  GroomReadOptions read;
  read.unit_meters = options.unit_meters;
  read.up = upAxisOf(options.up);
  const Groom groom = loadGroom({file}, read);
  // Counts are those of the file; lengths and box are in metres.
  const float unit = groom.report.unit_meters;
  StrandSet meters = raw.strands;
  rotateToYUp(meters.positions, read.up == UpAxis::kAuto ? raw.native_up : read.up);
  scaleToMeters(meters.positions, unit, options.file);
  const GroomSummary s = summarize(meters);
  const std::optional<std::pair<double, double>> widths = widthsOf(groom.strands);
  const std::optional<uint64_t> cast = bytesPerFrame(groom.strands);
  if (options.json) {
    fmt::print("{}\n", jsonText({{"file", options.file},
                                 {"format", raw.format},
                                 {"strands", s.strands},
                                 {"vertices", s.vertices},
                                 {"vertices_min", s.min_vertices},
                                 {"vertices_max", s.max_vertices},
                                 {"unit_meters", unit},
                                 {"bounds_min", toJson(s.bounds.min())},
                                 {"bounds_max", toJson(s.bounds.max())},
                                 {"length_min", s.min_length},
                                 {"length_median", s.median_length},
                                 {"length_max", s.max_length},
                                 {"degenerate_strands", s.degenerate_strands},
                                 {"width_min", widths ? nlohmann::json(widths->first) : nlohmann::json()},
                                 {"width_max", widths ? nlohmann::json(widths->second) : nlohmann::json()},
                                 {"guides", s.guides},
                                 {"ids", s.ids},
                                 {"groups", groupsOf(raw)},
                                 {"colours", s.colours},
                                 {"bytes_per_frame", cast ? nlohmann::json(*cast) : nlohmann::json()},
                                 {"left_out", groom.report.left_out},
                                 {"warnings", groom.report.warnings}}));
    return 0;
  }
  Report out;
  out.add("format", "format", raw.format);
  out.addCount("strands", "strands", s.strands);
  out.add("vertices", "vertices",
          fmt::format("{} ({} to {} per strand)", s.vertices, s.min_vertices, s.max_vertices));
  out.add("unit", "unit",
          fmt::format("{:g} m{}", unit,
                      options.unit_meters > 0 ? ""
                      : raw.unit_is_default   ? ", as its format defines"
                      : raw.unit_meters > 0   ? ", given by the file"
                                              : ", guessed"));
  const Eigen::Vector3f low = s.bounds.min(), high = s.bounds.max();
  out.add("bounds", "bounding box",
          fmt::format("{:.3f} {:.3f} {:.3f} to {:.3f} {:.3f} {:.3f} m, Y up", low.x(), low.y(), low.z(),
                      high.x(), high.y(), high.z()));
  out.add("lengths", "strand length",
          fmt::format("{:.4f} to {:.4f} m, median {:.4f} m", s.min_length, s.max_length, s.median_length));
  if (widths)
    out.add("widths", "widths",
            fmt::format("{:.4g} to {:.4g} mm; not simulated: the radius of [[material]] is",
                        1e3 * widths->first, 1e3 * widths->second));
  if (!raw.strands.is_guide.empty()) out.addCount("guides", "guides", s.guides);
  if (s.ids > 0) out.addCount("ids", "different ids", s.ids);
  if (s.groups > 0) out.add("groups", "groups", lineOfGroups(raw));
  if (s.colours > 0) out.addCount("colours", "different colours", s.colours);
  out.addCount("degenerate", "degenerate strands", s.degenerate_strands);
  if (cast)
    out.add("bytes_per_frame", "published, at rest",
            fmt::format("{} bytes per frame as {} ({:.2f} per vertex)", *cast, nameOf(CodecOptions().codec),
                        static_cast<double>(*cast) / static_cast<double>(groom.strands.vertices())));
  if (!groom.report.left_out.empty())
    out.add("left_out", "left out", fmt::format("{}", fmt::join(groom.report.left_out, ", ")));
  for (const std::string& warning : groom.report.warnings) out.add("warning", "warning", warning);
  out.print(false);
  return 0;
}

}  // namespace

Verb addInfo(CLI::App& app) {
  const auto o = std::make_shared<InfoOptions>();
  auto* file = app.add_option("FILE", o->file, "groom file: .tfx, .hair, .obj or .usda");
  auto* unit = app.add_option("--unit-meters", o->unit_meters,
                              "metres per unit of the file; default: as the file says, else guessed")
                   ->check(finiteRange(1e-6, 1000.0));
  auto* up =
      app.add_option("--up", o->up, "up axis of the file")->check(CLI::IsMember({"auto", "x", "y", "z"}));
  auto* backends = app.add_flag("--backends", o->backends,
                                "list the backends, whether each can run here or why not, and the GPUs that "
                                "STRANDCAST_GPU selects from");
  for (CLI::Option* const of_file : {file, unit, up}) backends->excludes(of_file);
  app.add_flag("--json", o->json, "print one JSON object");
  return [o] {
    if (o->backends) return printBackends(o->json);
    if (o->file.empty()) throw Error("nothing to show", "strandcast info", "give a FILE or --backends");
    return printGroom(*o);
  };
}

}  // namespace strandcast
