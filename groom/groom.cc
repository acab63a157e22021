#include "groom/groom.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>

#include "core/error.h"
#include "groom/groom_operations.h"
#include "io/axes_and_units.h"
#include "io/strand_edit.h"

namespace strandcast {

std::vector<std::string> GroomReport::lines() const {
  std::vector<std::string> out;
  auto add = [&](size_t count, const char* what) {
    if (count > 0) out.push_back(fmt::format("{} {}", count, what));
  };
  add(dropped_short, "strands dropped: too short to simulate");
  add(duplicate_vertices, "vertices merged into their neighbours, which were too near");
  add(reversed, "strands reversed: their tip was at the scalp");
  add(both_ends_pinned, "strands are pinned at both ends");
  add(resampled, "strands resampled");
  if (!left_out.empty()) out.push_back(fmt::format("read without {}", fmt::join(left_out, ", ")));
  return out;
}

GroomSummary summarize(const StrandSet& strands) {
  GroomSummary summary;
  summary.strands = strands.strands();
  summary.vertices = strands.vertices();
  if (summary.strands == 0) return summary;
  summary.median_length = medianLength(strands);
  summary.min_vertices = std::numeric_limits<size_t>::max();
  summary.min_length = std::numeric_limits<float>::max();
  for (size_t s = 0; s < strands.strands(); ++s) {
    const size_t count = strands.verticesOf(s);
    const float length = arcLength(strands.strand(s));
    summary.min_vertices = std::min(summary.min_vertices, count);
    summary.max_vertices = std::max(summary.max_vertices, count);
    summary.min_length = std::min(summary.min_length, length);
    summary.max_length = std::max(summary.max_length, length);
    if (count < 2 || !(length > 0) || length < kShortestOfMedian * summary.median_length)
      ++summary.degenerate_strands;
  }
  for (const Vec3& point : strands.positions) summary.bounds.extend(Eigen::Vector3f(point));
  summary.guides = static_cast<size_t>(std::count(strands.is_guide.begin(), strands.is_guide.end(), 1));
  summary.ids = std::set<uint32_t>(strands.ids.begin(), strands.ids.end()).size();
  summary.groups = std::set<uint32_t>(strands.groups.begin(), strands.groups.end()).size();
  std::set<std::array<float, 3>> colours;
  for (const Vec3& colour : strands.colours) colours.insert({colour.x(), colour.y(), colour.z()});
  summary.colours = colours.size();
  return summary;
}

namespace {

/// Frees vertex 1 where only vertices 0 and 1 are pinned. TressFX pins both to hold the strand's direction at
/// the root. Here the root's frame is clamped, which holds the rest direction of the first edge, so vertex 1
/// may bend with the hair. Pins elsewhere (tips) stay, and so does a longer run of pinned vertices from the
/// root on.
void freeSecondVertices(StrandSet& strands) {
  if (strands.pinned.empty()) return;
  for (size_t s = 0; s < strands.strands(); ++s) {
    uint8_t* pinned = strands.pinned.data() + strands.offsets[s];
    if (strands.verticesOf(s) > 2 && pinned[0] && pinned[1] && !pinned[2]) pinned[1] = 0;
  }
}

/// Merges the strands of several files into one set. Attributes that only some files have would be undefined
/// for the rest: pins default to the root, guide marks to none, groups to one of the file; radii, UVs, ids
/// and colours are left out with a warning.
class GroomMerger {
 public:
  GroomMerger(Groom& groom, bool several) : groom_(groom), several_(several) {}

  void add(const RawGroom& raw, size_t file, const std::string& name) {
    const StrandSet& part = raw.strands;
    StrandSet& all = groom_.strands;
    if (all.vertices() + part.vertices() > std::numeric_limits<uint32_t>::max())
      throw Error("the groom has more than 4294967295 vertices", fmt::format("file {}", file),
                  "load fewer files");
    const auto first = static_cast<uint32_t>(all.vertices());
    for (size_t s = 1; s < part.offsets.size(); ++s) all.offsets.push_back(first + part.offsets[s]);
    all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
    any_pins_ |= !part.pinned.empty();
    appendPins(part);
    all.radii.insert(all.radii.end(), part.radii.begin(), part.radii.end());
    all.uvs.insert(all.uvs.end(), part.uvs.begin(), part.uvs.end());
    all.ids.insert(all.ids.end(), part.ids.begin(), part.ids.end());
    all.colours.insert(all.colours.end(), part.colours.begin(), part.colours.end());
    any_guides_ |= !part.is_guide.empty();
    all.is_guide.insert(all.is_guide.end(), part.is_guide.begin(), part.is_guide.end());
    all.is_guide.resize(all.strands(), 0);
    appendGroups(raw);
    all.parts.insert(all.parts.end(), part.strands(), static_cast<uint16_t>(file));
    report(raw.report, name);
  }

  void finish() {
    StrandSet& all = groom_.strands;
    if (!any_pins_) all.pinned.clear();
    if (!any_guides_) all.is_guide.clear();
    if (!any_groups_) {
      all.groups.clear();
      groom_.groups.clear();
    }
    const auto clearUnlessWhole = [&](auto& values, size_t expected, const char* what) {
      if (values.empty() || values.size() == expected) return;
      values.clear();
      groom_.report.warnings.push_back(
          fmt::format("some of the files have no {}: those of the others are left out", what));
    };
    clearUnlessWhole(all.radii, all.vertices(), "radii");
    clearUnlessWhole(all.uvs, all.strands(), "strand UVs");
    clearUnlessWhole(all.ids, all.strands(), "ids");
    clearUnlessWhole(all.colours, all.strands(), "colours");
  }

 private:
  void report(const FileReport& found, const std::string& name) {
    std::vector<std::string>& left_out = groom_.report.left_out;
    if (!several_)
      left_out = found.left_out;
    else if (!found.left_out.empty())
      left_out.push_back(fmt::format("{}: {}", name, fmt::join(found.left_out, ", ")));
    for (const std::string& warning : found.warnings)
      groom_.report.warnings.push_back(fmt::format("{}: {}", name, warning));
  }

  void appendGroups(const RawGroom& raw) {
    any_groups_ |= !raw.strands.groups.empty();
    std::vector<uint32_t>& all = groom_.strands.groups;
    const auto first = static_cast<uint32_t>(groom_.groups.size());
    for (const uint32_t group : raw.strands.groups) all.push_back(first + group);
    groom_.groups.insert(groom_.groups.end(), raw.groups.begin(), raw.groups.end());
    if (!raw.strands.groups.empty()) return;
    all.resize(all.size() + raw.strands.strands(), first);
    groom_.groups.emplace_back();
  }

  void appendPins(const StrandSet& part) {
    std::vector<uint8_t>& pins = groom_.strands.pinned;
    const size_t before = pins.size();
    pins.insert(pins.end(), part.pinned.begin(), part.pinned.end());
    if (!part.pinned.empty()) return;
    pins.resize(before + part.vertices(), 0);
    for (size_t s = 0; s < part.strands(); ++s) pins[before + part.offsets[s]] = 1;
  }

  Groom& groom_;
  bool several_;  // there is more than one file
  bool any_pins_ = false, any_guides_ = false, any_groups_ = false;
};

/// Converts the strands of a further file to the unit of the first, `said` (0 if the first states none).
void toUnit(RawGroom& raw, float said, const std::string& name) {
  if (raw.unit_meters == said) return;
  if (raw.unit_meters == 0 || said == 0)
    throw Error("only some of the files give their unit", name,
                "give one unit for all files (--unit-meters)");
  const float scale = raw.unit_meters / said;
  for (Vec3& point : raw.strands.positions) point *= scale;
  for (float& radius : raw.strands.radii) radius *= scale;
}

// `said`: metres per unit as the files state it; 0 if they state none.
void convertUnits(Groom& groom, const GroomReadOptions& options, float said, const std::string& name) {
  float unit = options.unit_meters > 0 ? options.unit_meters : said;
  if (unit == 0) {
    Box bounds;
    for (const Vec3& point : groom.strands.positions) bounds.extend(Eigen::Vector3f(point));
    unit = guessUnit(bounds);
    groom.report.is_unit_guessed = true;
    const float size = bounds.sizes().maxCoeff();
    const std::string likelier = likelierUnits(size, unit);
    groom.report.warnings.push_back(
        fmt::format("{}: the unit is guessed: {} m, which makes the groom {:.3g} m large ({:.4g} units{}); "
                    "give --unit-meters to be sure",
                    name, unit, size * unit, size, likelier.empty() ? "" : "; " + likelier));
  }
  groom.report.unit_meters = unit;
  scaleToMeters(groom.strands.positions, unit, name);
  for (float& radius : groom.strands.radii) {
    radius *= unit;
    if (!std::isfinite(radius))
      throw Error("a radius is out of range", name, "give the file's unit (--unit-meters)");
  }
}

/// Median edge length of a sample of the strands, m.
float medianEdge(const StrandSet& strands) {
  constexpr size_t kSample = 1000;
  std::vector<float> edges;
  const size_t every = std::max<size_t>(strands.strands() / kSample, 1);
  for (size_t s = 0; s < strands.strands(); s += every)
    if (strands.verticesOf(s) > 1)
      edges.push_back(arcLength(strands.strand(s)) / static_cast<float>(strands.verticesOf(s) - 1));
  if (edges.empty()) return 0;
  const auto middle = edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 2);
  std::nth_element(edges.begin(), middle, edges.end());
  return *middle;
}

/// Warns of a size or position that no hair has: a sign of a wrong unit.
void warnOfUnit(Groom& groom, const std::string& name) {
  constexpr float kMaxRounding = 0.05f;  // float rounding of positions, as a share of an edge
  Box bounds;
  for (const Vec3& point : groom.strands.positions) bounds.extend(Eigen::Vector3f(point));
  const float size = bounds.sizes().maxCoeff();
  const float unit = groom.report.unit_meters;
  if (isUnlikelySize(size)) {
    const std::string likelier = likelierUnits(size / unit, unit);
    groom.report.warnings.push_back(
        fmt::format("{}: with a unit of {:g} m the groom is {:.3g} m large: give its unit (--unit-meters){}",
                    name, unit, size, likelier.empty() ? "" : ": " + likelier));
  }
  const float farthest = std::max(bounds.min().cwiseAbs().maxCoeff(), bounds.max().cwiseAbs().maxCoeff());
  const float rounding = farthest * std::numeric_limits<float>::epsilon(), edge = medianEdge(groom.strands);
  if (rounding > kMaxRounding * edge)
    groom.report.warnings.push_back(fmt::format(
        "{}: with a unit of {:g} m the groom lies {:.3g} m from the origin, where positions are rounded to "
        "{:.2g} m and edges are {:.2g} m: give its unit (--unit-meters), or move it to the origin",
        name, unit, farthest, rounding, edge));
}

}  // namespace

Groom loadUncleanedGroom(const std::vector<std::filesystem::path>& files, const GroomReadOptions& options) {
  checkUnit(options.unit_meters);
  if (files.empty())
    throw Error("no groom file is given", "loading a groom", "name one or more files (--groom)");
  if (files.size() > std::numeric_limits<uint16_t>::max())
    throw Error(fmt::format("{} groom files are too many", files.size()), "loading a groom",
                "give at most 65535");
  Groom groom;
  GroomMerger merger(groom, files.size() > 1);
  float said = 0;
  std::set<std::filesystem::path> places;
  for (size_t f = 0; f < files.size(); ++f) {
    RawGroom raw = readRawGroom(files[f]);
    const UpAxis up = options.up == UpAxis::kAuto ? raw.native_up : options.up;
    rotateToYUp(raw.strands.positions, up);
    if (f == 0) {
      said = raw.unit_meters;
      groom.report.up = up;
    } else if (options.unit_meters == 0) {
      toUnit(raw, said, files[f].string());
    }
    if (const std::string doubt = defaultUnitWarning(raw); options.unit_meters == 0 && !doubt.empty())
      groom.report.warnings.push_back(fmt::format("{}: {}", files[f].string(), doubt));
    if (options.unit_meters > 0 && raw.unit_meters > 0 && !raw.unit_is_default &&
        !isSameUnit(options.unit_meters, raw.unit_meters))
      groom.report.warnings.push_back(
          fmt::format("{}: the file says that its unit is {:g} m, {:g} m is taken as given (--unit-meters)",
                      files[f].string(), raw.unit_meters, options.unit_meters));
    if (options.up != UpAxis::kAuto && options.up != raw.native_up && raw.format == "usda")
      groom.report.warnings.push_back(fmt::format("{}: {} is up in the file, {} is taken as given (--up)",
                                                  files[f].string(), nameOf(raw.native_up),
                                                  nameOf(options.up)));
    if (!options.keep_pins) freeSecondVertices(raw.strands);
    merger.add(raw, f, files[f].string());
    std::error_code unknown;
    const std::filesystem::path place = std::filesystem::weakly_canonical(files[f], unknown);
    if (!unknown && !places.insert(place).second)
      groom.report.warnings.push_back(
          fmt::format("{} is given more than once: its strands are duplicated", files[f].string()));
    if (f > 0) groom.name += '+';
    groom.name += files[f].stem().string();
  }
  merger.finish();
  groom.report.strands_read = groom.strands.strands();
  convertUnits(groom, options, said, files[0].string());
  return groom;
}

Groom loadGroom(const std::vector<std::filesystem::path>& files, const GroomReadOptions& options) {
  Groom groom = loadUncleanedGroom(files, options);
  cleanStrands(groom);
  if (groom.strands.strands() == 0)
    throw Error("no strand is left after cleaning, all are points", files[0].string(),
                "check the export of the hair");
  warnOfUnit(groom, files[0].string());
  return groom;
}

}  // namespace strandcast
