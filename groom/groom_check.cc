#include "groom/groom_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/quantile.h"
#include "core/strand_model.h"
#include "io/axes_and_units.h"

namespace strandcast {

const char* nameOf(CheckSeverity severity) {
  constexpr const char* kNames[] = {"ok", "warning", "fault"};
  return kNames[static_cast<size_t>(severity)];
}

const char* verdictOf(CheckSeverity worst) {
  constexpr const char* kVerdicts[] = {"ready", "ready with warnings", "not ready"};
  return kVerdicts[static_cast<size_t>(worst)];
}

void CheckReport::add(CheckReport other) {
  std::move(other.results.begin(), other.results.end(), std::back_inserter(results));
  marks.insert(marks.end(), other.marks.begin(), other.marks.end());
}

CheckSeverity CheckReport::worst() const {
  CheckSeverity worst = CheckSeverity::kOk;
  for (const CheckResult& result : results) worst = std::max(worst, result.severity);
  return worst;
}

size_t CheckReport::count(CheckSeverity severity) const {
  return static_cast<size_t>(std::count_if(results.begin(), results.end(), [&](const CheckResult& result) {
    return result.severity == severity;
  }));
}

const CheckResult* CheckReport::find(const std::string& key) const {
  const auto found = std::find_if(results.begin(), results.end(),
                                  [&](const CheckResult& result) { return result.key == key; });
  return found == results.end() ? nullptr : &*found;
}

std::string strandPlace(const StrandSet& strands, size_t strand, std::span<const std::string> part_names) {
  if (strands.parts.empty() || strands.parts[strand] >= part_names.size())
    return fmt::format("strand {}", strand);
  const uint16_t part = strands.parts[strand];
  const auto before =
      std::count(strands.parts.begin(), strands.parts.begin() + static_cast<std::ptrdiff_t>(strand), part);
  return fmt::format("strand {} of {}", before, part_names[part]);
}

namespace {

constexpr double kManyMerged = 0.01, kManyDropped = 0.01, kManyUneven = 0.05;  // shares that give a warning
constexpr size_t kMaxShapeMarks = 20000;

double shareOf(size_t part, size_t whole) {
  return static_cast<double>(part) / static_cast<double>(std::max<size_t>(whole, 1));
}

bool isFinite(std::span<const Vec3> points) {
  return std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); });
}

/// A row about strands or vertices of which there should be none. `bad`: severity where there are some.
CheckResult countRow(const std::string& key, const std::string& noun, size_t count, CheckSeverity bad,
                     const std::string& unit, const std::string& where, const std::string& remedy) {
  const bool has = count > 0;
  return {has ? bad : CheckSeverity::kOk,
          key,
          fmt::format("{} {}", has ? std::to_string(count) : "no", noun),
          static_cast<double>(count),
          unit,
          has ? where : "",
          has && bad != CheckSeverity::kOk ? remedy : ""};
}

/// Counts strands with a fault and remembers the first.
struct StrandCount {
  size_t strands = 0, first = 0;
  void add(size_t strand) {
    if (strands++ == 0) first = strand;
  }
};

void checkSizes(const StrandSet& strands, const Groom& cleaned, CheckReport& out) {
  Box box;
  std::vector<double> lengths;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const std::span<const Vec3> points = strands.strand(s);
    if (points.empty() || !isFinite(points)) continue;
    for (const Vec3& p : points) box.extend(Eigen::Vector3f(p));
    if (points.size() > 1) lengths.push_back(static_cast<double>(arcLength(points)));
  }
  const float unit = cleaned.report.unit_meters > 0 ? cleaned.report.unit_meters : 1;
  const Eigen::Vector3f size = box.isEmpty() ? Eigen::Vector3f(0, 0, 0) : Eigen::Vector3f(box.sizes());
  const float longest = size.maxCoeff();
  const std::string likelier = longest > 0 ? likelierUnits(longest / unit, unit) : "";
  const std::string remedy =
      "give the unit of the file (--unit-meters)" + (likelier.empty() ? "" : ": " + likelier);
  const bool odd = isUnlikelySize(longest);
  out.add({odd ? CheckSeverity::kFault : CheckSeverity::kOk, "groom_size",
           fmt::format("groom of {} strands, {} vertices: {:.3g} x {:.3g} x {:.3g} m with a unit of {:g} m",
                       strands.strands(), strands.vertices(), size.x(), size.y(), size.z(), unit),
           static_cast<double>(longest), "m", "", odd ? remedy : ""});
  const double median = quantileOf(lengths, 0.5);
  const auto [least, most] = std::minmax_element(lengths.begin(), lengths.end());
  const auto too_long = static_cast<size_t>(std::count_if(lengths.begin(), lengths.end(), [](double length) {
    return length > static_cast<double>(kLongestHair);
  }));
  const bool is_no_hair =
      median < static_cast<double>(kShortestHair) || median > static_cast<double>(kLongestHair);
  out.add({is_no_hair     ? CheckSeverity::kFault
           : too_long > 0 ? CheckSeverity::kWarning
                          : CheckSeverity::kOk,
           "hair_length",
           fmt::format("hair {:.4g} to {:.4g} m long, median {:.4g} m{}", lengths.empty() ? 0 : *least,
                       lengths.empty() ? 0 : *most, median,
                       too_long > 0 ? fmt::format("; {} strands above {:g} m", too_long, kLongestHair) : ""),
           median, "m", "", is_no_hair || too_long > 0 ? remedy : ""});
}

void checkVertices(const StrandSet& strands, std::span<const std::string> names, CheckReport& out) {
  StrandCount not_finite, single, zero;
  size_t vertices_not_finite = 0, zero_edges = 0;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const std::span<const Vec3> points = strands.strand(s);
    const auto bad = static_cast<size_t>(
        std::count_if(points.begin(), points.end(), [](const Vec3& p) { return !p.allFinite(); }));
    vertices_not_finite += bad;
    if (bad > 0) not_finite.add(s);
    if (points.size() < kMinVerticesPerStrand) single.add(s);
    size_t zeros = 0;
    for (size_t i = 1; i < points.size(); ++i) zeros += points[i] == points[i - 1];
    zero_edges += zeros;
    if (zeros > 0) zero.add(s);
  }
  const auto at = [&](const StrandCount& count) {
    return count.strands > 0 ? strandPlace(strands, count.first, names) : std::string();
  };
  out.add(countRow("not_finite", "vertices that are not finite", vertices_not_finite, CheckSeverity::kFault,
                   "vertices", at(not_finite), "export the hair again; remove the strands that are broken"));
  out.add(countRow("single_vertex", "strands of one vertex", single.strands, CheckSeverity::kWarning,
                   "strands", at(single), "they are left out: delete them before the export"));
  out.add(countRow("zero_edges", "edges without length", zero_edges, CheckSeverity::kWarning, "edges",
                   at(zero), "their vertices are merged: remove doubled points before the export"));
}

void checkCleaning(const Groom& groom, CheckReport& out) {
  const GroomReport& report = groom.report;
  const auto many = [](bool is_many) { return is_many ? CheckSeverity::kWarning : CheckSeverity::kOk; };
  out.add(countRow("dropped_strands", "strands left out: too short to simulate", report.dropped_short,
                   many(shareOf(report.dropped_short, report.strands_read) > kManyDropped), "strands", "",
                   "see whether the export cut them: they are shorter than 1 % of the median"));
  out.add(countRow("merged_vertices", "vertices merged into a neighbour that was too near",
                   report.duplicate_vertices,
                   many(shareOf(report.duplicate_vertices,
                                groom.strands.vertices() + report.duplicate_vertices) > kManyMerged),
                   "vertices", "", "space the points of a strand evenly before the export"));
  out.add(countRow("resampled_strands",
                   fmt::format("strands of more than {} vertices, resampled", kMaxVerticesPerStrand),
                   report.resampled, CheckSeverity::kWarning, "strands", "",
                   "export fewer points per strand, or look at the picture: corners are cut"));
  out.add(countRow("reversed_strands", "strands reversed: their tip was at the skin", report.reversed,
                   CheckSeverity::kWarning, "strands", "", "export strands from root to tip"));
  if (report.both_ends_pinned > 0)
    out.add(countRow("pinned_tips", "strands pinned at both ends", report.both_ends_pinned,
                     CheckSeverity::kOk, "strands", "", ""));
  for (const std::string& part : report.left_out)
    out.add({CheckSeverity::kOk, "left_out", "read without " + part, 1, ""});
  for (const std::string& warning : report.warnings)
    out.add({CheckSeverity::kWarning, "reader", warning, 1, "", "", ""});
}

/// Pairs of strands whose vertices all coincide. Strands are sorted by a weighted sum of the coordinates of
/// root, middle and tip: duplicates are neighbours in it, and few others are.
void checkDuplicates(const StrandSet& strands, std::span<const std::string> names, CheckReport& out) {
  const Eigen::Vector3d weights[] = {{0.571, 0.633, 0.523}, {0.317, 0.739, 0.595}, {0.811, 0.271, 0.518}};
  std::vector<std::pair<double, size_t>> order;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const std::span<const Vec3> points = strands.strand(s);
    if (points.empty() || !isFinite(points)) continue;
    double key = 0;
    const Vec3* const chosen[] = {&points.front(), &points[points.size() / 2], &points.back()};
    for (size_t i = 0; i < std::size(weights); ++i) key += weights[i].dot(chosen[i]->cast<double>());
    order.emplace_back(key, s);
  }
  std::sort(order.begin(), order.end());
  const double reach = 3.0 * static_cast<double>(kSameStrand);
  const auto isSame = [&](size_t a, size_t b) {
    const std::span<const Vec3> p = strands.strand(a), q = strands.strand(b);
    return p.size() == q.size() &&
           std::equal(p.begin(), p.end(), q.begin(),
                      [](const Vec3& x, const Vec3& y) { return (x - y).norm() <= kSameStrand; });
  };
  std::vector<bool> is_copy(strands.strands(), false);
  size_t copies = 0, first = 0, of = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    if (is_copy[order[i].second]) continue;
    for (size_t j = i + 1; j < order.size() && order[j].first - order[i].first <= reach; ++j) {
      const size_t a = order[i].second, b = order[j].second;
      if (is_copy[b] || !isSame(a, b)) continue;
      is_copy[b] = true;
      if (copies++ == 0) std::tie(of, first) = std::minmax(a, b);
    }
  }
  out.add(countRow(
      "duplicate_strands", "strands that lie on another one", copies, CheckSeverity::kWarning, "strands",
      copies > 0
          ? fmt::format("{} on {}", strandPlace(strands, first, names), strandPlace(strands, of, names))
          : "",
      "delete the copies: each costs a step and is drawn twice"));
}

void checkEdges(const StrandSet& strands, std::span<const std::string> names, CheckReport& out) {
  size_t folds = 0, folded = 0, sharpest_strand = 0, uneven = 0, worst_strand = 0;
  double sharpest = 0, worst = 0;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const std::span<const Vec3> points = strands.strand(s);
    float shortest = std::numeric_limits<float>::max(), longest = 0;
    size_t of_strand = 0;
    for (size_t i = 1; i < points.size(); ++i) {
      const Vec3 edge = points[i] - points[i - 1];
      shortest = std::min(shortest, edge.norm());
      longest = std::max(longest, edge.norm());
      if (i + 1 == points.size()) continue;
      const Vec3 next = points[i + 1] - points[i];
      const double degrees =
          static_cast<double>(std::atan2(edge.cross(next).norm(), edge.dot(next))) * 180 / std::numbers::pi;
      if (!(degrees > static_cast<double>(kFoldDegrees))) continue;
      ++of_strand;
      if (out.marks.size() < kMaxShapeMarks) out.marks.push_back({CheckMark::Kind::kShape, points[i]});
      if (degrees > sharpest) {
        sharpest = degrees;
        sharpest_strand = s;
      }
    }
    folds += of_strand;
    folded += of_strand > 0;
    const double ratio = shortest > 0 && longest > 0 ? static_cast<double>(longest / shortest) : 0;
    uneven += ratio > static_cast<double>(kUnevenEdges);
    if (ratio > worst) {
      worst = ratio;
      worst_strand = s;
    }
  }
  out.add(countRow("folds",
                   folds > 0
                       ? fmt::format("folds of more than {:g} degrees, in {} strands, up to {:.0f} degrees",
                                     kFoldDegrees, folded, sharpest)
                       : fmt::format("folds of more than {:g} degrees", kFoldDegrees),
                   folds, CheckSeverity::kWarning, "vertices",
                   folds > 0 ? strandPlace(strands, sharpest_strand, names) : "",
                   "give curls more points per turn, or smooth the strand: a fold may never come to rest"));
  const bool many = shareOf(uneven, strands.strands()) > kManyUneven;
  out.add(countRow(
      "uneven_edges",
      uneven > 0 ? fmt::format("strands with an edge over {:g} times their shortest, up to {:.0f} times",
                               kUnevenEdges, worst)
                 : fmt::format("strands with an edge over {:g} times their shortest", kUnevenEdges),
      uneven, many ? CheckSeverity::kWarning : CheckSeverity::kOk, "strands",
      uneven > 0 ? strandPlace(strands, worst_strand, names) : "",
      "resample (--vertices): long edges bend less than their neighbours"));
}

}  // namespace

CheckReport checkGroom(const StrandSet& as_read, const Groom& cleaned,
                       std::span<const std::string> part_names) {
  CheckReport out;
  checkSizes(as_read, cleaned, out);
  checkVertices(as_read, part_names, out);
  checkCleaning(cleaned, out);
  checkDuplicates(as_read, part_names, out);
  checkEdges(cleaned.strands, part_names, out);
  return out;
}

}  // namespace strandcast
