#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/cli/verbs.h"
#include "groom/groom.h"
#include "groom/groom_operations.h"
#include "io/file_bytes.h"
#include "options/number_range.h"
#include "options/settings.h"

namespace strandcast {
namespace {

struct ConvertOptions {
  std::string in, out, up = "auto";
  float unit_meters = 0;
  int vertices = 0;
  bool clean = false;
};

/// Removes coincident vertices that resampling produced, except for .tfx, whose strands all have one vertex
/// count.
void cleanAgain(StrandSet& strands, const std::string& out) {
  Groom groom;
  groom.strands = strands;
  cleanStrands(groom);
  const size_t merged = groom.report.duplicate_vertices, dropped = groom.report.dropped_short;
  const bool keeps_all = lowerExtension(out) == ".tfx";
  if (merged + dropped > 0)
    spdlog::warn("{}: {} vertices at the position of a neighbour and {} strands too short to simulate are {}",
                 out, merged, dropped,
                 keeps_all ? "kept, because .tfx has one vertex count for all strands" : "left out");
  if (!keeps_all) strands = std::move(groom.strands);
}

int convert(const ConvertOptions& o) {
  StrandSet strands;
  std::vector<StrandGroup> groups;
  UpAxis up = UpAxis::kY;
  float unit_meters = 1;
  FileReport report;
  if (o.clean || o.unit_meters > 0 || o.up != "auto") {
    GroomReadOptions read;
    read.unit_meters = o.unit_meters;
    read.up = upAxisOf(o.up);
    read.keep_pins = true;
    Groom groom = loadGroom({o.in}, read);
    for (const std::string& line : groom.report.lines()) spdlog::warn("{}: {}", o.out, line);
    for (const std::string& line : groom.report.warnings) spdlog::warn("{}", line);
    strands = std::move(groom.strands);
    groups = std::move(groom.groups);
  } else {
    RawGroom raw = readRawGroom(o.in);
    strands = std::move(raw.strands);
    groups = std::move(raw.groups);
    up = raw.native_up;
    unit_meters = raw.unit_meters;
    report = std::move(raw.report);
    if (const std::string doubt = defaultUnitWarning(raw); !doubt.empty()) report.warnings.push_back(doubt);
  }
  if (o.vertices > 0) {
    strands = resample(strands, o.vertices);
    cleanAgain(strands, o.out);
  }
  writeGroom(o.out, strands, up, unit_meters, groups);
  if (unit_meters == 0 && lowerExtension(o.out) == ".usda")
    spdlog::warn("{}: {} does not give its unit; readers assume centimetres; give --unit-meters", o.out,
                 o.in);
  const std::vector<std::string> left_out = omissionsOf(o.out, strands);
  if (!left_out.empty())
    spdlog::warn("{}: this format has no {}; {} has", o.out, fmt::join(left_out, " and no "), o.in);
  if (!report.left_out.empty())
    spdlog::warn("{}: without the {} of {}", o.out, fmt::join(report.left_out, ", "), o.in);
  for (const std::string& line : report.warnings) spdlog::warn("{}: {}", o.in, line);
  fmt::print("{}: {} strands, {} vertices\n", o.out, strands.strands(), strands.vertices());
  return 0;
}

}  // namespace

Verb addConvert(CLI::App& app) {
  const auto o = std::make_shared<ConvertOptions>();
  app.footer(
      "Positions are copied bit for bit unless --clean, --unit-meters, --up or --vertices changes them. "
      "Between .hair (Z up) and the other formats (Y up) they are rotated. .tfx keeps pins and UVs, .hair "
      "radii, .usda UVs, radii, guide marks, ids, groups and colours; a warning names what is left out.\n"
      "Example: strandcast convert bob.tfx bob.hair");
  app.add_option("IN", o->in, "groom to read: .tfx (3 and 4), .hair, .obj polylines, .usda curves")
      ->required();
  app.add_option("OUT", o->out, "groom to write: .tfx (4), .hair or .usda, by extension")->required();
  app.add_flag("--clean", o->clean, "convert to metres, drop degenerate strands, merge duplicate vertices");
  app.add_option("--unit-meters", o->unit_meters, "metres per unit of IN (implies --clean)")
      ->check(finiteRange(1e-6, 1000.0));
  app.add_option("--up", o->up, "up axis of IN (implies --clean)")
      ->check(CLI::IsMember({"auto", "x", "y", "z"}));
  app.add_option("--vertices", o->vertices, "resample every strand to this many vertices, equally spaced")
      ->transform(wholeRange(2, 128));
  return [o] { return convert(*o); };
}

}  // namespace strandcast
