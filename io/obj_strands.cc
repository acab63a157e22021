// Strands from the polylines (`l`) of a Wavefront OBJ text.
#include "io/obj_strands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <utility>

#include "io/groom_file.h"
#include "io/obj_lines.h"
#include "io/strand_edit.h"

namespace strandcast {
namespace {

using Edge = std::array<uint32_t, 2>;
constexpr uint32_t kNoEdge = std::numeric_limits<uint32_t>::max();

/// Maximal sequences of consecutive polylines that each continue the previous one, as one polyline each.
struct Runs {
  Polylines lines;
  std::vector<bool> is_of_edges;  ///< whether all polylines of the run have two corners
};

Runs runsOf(const Polylines& read) {
  Runs runs;
  for (size_t p = 0; p < read.size(); ++p) {
    const std::span<const uint32_t> line = read.at(p);
    const bool goes_on = p > 0 && read.at(p - 1).back() == line.front();
    if (p > 0 && !goes_on) runs.lines.end();
    if (!goes_on) runs.is_of_edges.push_back(true);
    if (line.size() != 2) runs.is_of_edges.back() = false;
    runs.lines.corners.insert(runs.lines.corners.end(), line.begin() + (goes_on ? 1 : 0), line.end());
  }
  if (read.size() > 0) runs.lines.end();
  return runs;
}

bool isRing(std::span<const uint32_t> run) { return run.size() > 3 && run.front() == run.back(); }

/// Rotates a ring to begin at its lowest vertex and to go on to the lower of that vertex's neighbours.
void openAtLowest(std::span<uint32_t> ring) {
  const std::span<uint32_t> once = ring.first(ring.size() - 1);
  std::rotate(once.begin(), std::min_element(once.begin(), once.end()), once.end());
  if (once[1] > once.back()) std::reverse(once.begin() + 1, once.end());
  ring.back() = ring.front();
}

/// Whether the runs of edges appear to be written strand after strand from the root on: no tip is in another
/// run, and no run of a single edge touches another run. Roots may be shared.
bool isInOrder(const Runs& runs, size_t vertices) {
  std::vector<uint8_t> uses(vertices, 0);  // 2: two or more
  for (size_t r = 0; r < runs.lines.size(); ++r)
    if (runs.is_of_edges[r])
      for (const uint32_t v : runs.lines.at(r)) uses[v] = static_cast<uint8_t>(std::min(uses[v] + 1, 2));
  for (size_t r = 0; r < runs.lines.size(); ++r) {
    if (!runs.is_of_edges[r]) continue;
    const std::span<const uint32_t> run = runs.lines.at(r);
    if (!isRing(run) && (uses[run.back()] > 1 || (run.size() == 2 && uses[run.front()] > 1))) return false;
  }
  return true;
}

/// Edges of a file with, per vertex, the edges that meet there.
class EdgeGraph {
 public:
  EdgeGraph(const Runs& runs, size_t vertices, FileReport& report) : first_(vertices + 1, 0) {
    collect(runs, report);
    for (const Edge& edge : edges_)
      for (const uint32_t v : edge) ++first_[v + 1];
    for (size_t v = 0; v < vertices; ++v) first_[v + 1] += first_[v];
    meeting_.resize(2 * edges_.size());
    std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
    for (uint32_t e = 0; e < edges_.size(); ++e)
      for (const uint32_t v : edges_[e]) meeting_[next[v]++] = e;
    is_used_.resize(edges_.size(), false);
  }

  size_t edges() const { return edges_.size(); }
  bool isUsed(uint32_t edge) const { return is_used_[edge]; }
  size_t runOf(uint32_t edge) const { return run_[edge]; }
  size_t forks() const {
    size_t count = 0;
    for (uint32_t v = 0; v + 1 < first_.size(); ++v) count += degree(v) > 2 ? 1 : 0;
    return count;
  }

  /// The strand that contains an unused edge, from its root on. Marks its edges as used.
  std::vector<uint32_t> strandOf(uint32_t edge, bool& is_ring) {
    const uint32_t middle = edges_[edge][1];
    std::vector<uint32_t> strand = walk(middle, edge);
    is_ring = strand.back() == middle && degree(middle) == 2;
    if (is_ring) {
      openAtLowest(strand);
      return strand;
    }
    std::reverse(strand.begin(), strand.end());
    const uint32_t onward = degree(middle) == 2 ? unusedAt(middle) : kNoEdge;
    if (onward != kNoEdge) {
      const std::vector<uint32_t> rest = walk(middle, onward);
      strand.insert(strand.end(), rest.begin() + 1, rest.end());
    }
    if (strand.back() < strand.front()) std::reverse(strand.begin(), strand.end());
    return strand;
  }

 private:
  size_t degree(uint32_t v) const { return first_[v + 1] - first_[v]; }

  /// Collects the edges of all runs of edges, without repeats.
  void collect(const Runs& runs, FileReport& report) {
    size_t points = 0;
    std::vector<std::pair<Edge, uint32_t>> sorted;
    for (size_t r = 0; r < runs.lines.size(); ++r) {
      if (!runs.is_of_edges[r]) continue;
      const std::span<const uint32_t> run = runs.lines.at(r);
      for (size_t i = 1; i < run.size(); ++i) {
        if (run[i] == run[i - 1]) {
          ++points;
          continue;
        }
        const auto [low, high] = std::minmax(run[i - 1], run[i]);
        sorted.push_back({{low, high}, static_cast<uint32_t>(edges_.size())});
        edges_.push_back({run[i - 1], run[i]});
        run_.push_back(r);
      }
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<bool> is_again(edges_.size(), false);
    for (size_t i = 1; i < sorted.size(); ++i)
      if (sorted[i].first == sorted[i - 1].first) is_again[sorted[i].second] = true;
    size_t kept = 0;
    for (size_t e = 0; e < edges_.size(); ++e) {
      if (is_again[e]) continue;
      edges_[kept] = edges_[e];
      run_[kept++] = run_[e];
    }
    const size_t again = edges_.size() - kept;
    edges_.resize(kept);
    run_.resize(kept);
    if (points > 0)
      report.addOmission(fmt::format("{} edge{} from a vertex to itself", points, points == 1 ? "" : "s"));
    if (again > 0) report.addOmission(fmt::format("{} edge{} written again", again, again == 1 ? "" : "s"));
  }

  /// Vertices from `from` along `edge` up to an end or a fork, or around a ring back to `from`.
  std::vector<uint32_t> walk(uint32_t from, uint32_t edge) {
    std::vector<uint32_t> out{from};
    for (uint32_t e = edge; e != kNoEdge;) {
      is_used_[e] = true;
      const uint32_t v = edges_[e][0] == out.back() ? edges_[e][1] : edges_[e][0];
      out.push_back(v);
      e = degree(v) == 2 ? unusedAt(v) : kNoEdge;
    }
    return out;
  }
  uint32_t unusedAt(uint32_t v) const {
    for (uint32_t i = first_[v]; i < first_[v + 1]; ++i)
      if (!is_used_[meeting_[i]]) return meeting_[i];
    return kNoEdge;
  }

  std::vector<Edge> edges_;
  std::vector<size_t> run_;        ///< per edge
  std::vector<uint32_t> first_;    ///< per vertex, and one more: offsets into meeting_
  std::vector<uint32_t> meeting_;  ///< edges that meet at each vertex
  std::vector<bool> is_used_;
};

void reportForks(size_t forks, size_t rings, FileReport& report) {
  if (forks > 0)
    report.warnings.push_back(fmt::format("at {} vert{} more than two edges meet: the strands end there",
                                          forks, forks == 1 ? "ex" : "ices"));
  if (rings > 0)
    report.warnings.push_back(
        fmt::format("{} opened at the lowest vertex index",
                    rings == 1 ? "1 ring of edges is" : fmt::format("{} rings of edges are", rings)));
}

/// Whether a run passes a vertex twice, other than as its two ends. `last_run`: per vertex.
bool crossesItself(std::span<const uint32_t> run, uint32_t number, std::vector<uint32_t>& last_run) {
  bool crosses = false;
  const size_t count = run.size() - (isRing(run) ? 1 : 0);
  for (size_t i = 0; i < count; ++i) {
    if (i > 0 && run[i] == run[i - 1]) continue;
    crosses |= last_run[run[i]] == number;
    last_run[run[i]] = number;
  }
  return crosses;
}

/// Returns runs that already are strands as written; only rings of edges are opened at their lowest vertex.
Polylines writtenStrands(Runs runs, size_t vertices, FileReport& report) {
  std::vector<uint32_t> last_run(vertices, std::numeric_limits<uint32_t>::max());
  size_t rings = 0, crossing = 0;
  for (size_t r = 0; r < runs.lines.size(); ++r) {
    if (!runs.is_of_edges[r]) continue;
    const std::span<uint32_t> run =
        std::span(runs.lines.corners).subspan(runs.lines.offsets[r], runs.lines.at(r).size());
    if (crossesItself(run, static_cast<uint32_t>(r), last_run)) {
      ++crossing;
    } else if (isRing(run)) {
      openAtLowest(run);
      ++rings;
    }
  }
  reportForks(0, rings, report);
  if (crossing > 0)
    report.warnings.push_back(fmt::format(
        "{} through a vertex again, and stay{} as written",
        crossing == 1 ? "1 strand of edges goes" : fmt::format("{} strands of edges go", crossing),
        crossing == 1 ? "s" : ""));
  return std::move(runs.lines);
}

void reportClosed(const Runs& runs, FileReport& report) {
  size_t closed = 0;
  for (size_t r = 0; r < runs.lines.size(); ++r)
    closed += !runs.is_of_edges[r] && isRing(runs.lines.at(r)) ? 1 : 0;
  if (closed > 0)
    report.warnings.push_back(
        closed == 1 ? "1 polyline is closed: its root and its tip are one vertex"
                    : fmt::format("{} polylines are closed: root and tip of each are one vertex", closed));
}

}  // namespace

Polylines joinedPolylines(const Polylines& read, size_t vertices, FileReport& report) {
  Runs runs = runsOf(read);
  reportClosed(runs, report);
  if (isInOrder(runs, vertices)) return writtenStrands(std::move(runs), vertices, report);
  EdgeGraph graph(runs, vertices, report);
  Polylines out;
  size_t rings = 0;
  const auto add = [&](std::span<const uint32_t> strand) {
    out.corners.insert(out.corners.end(), strand.begin(), strand.end());
    out.end();
  };
  uint32_t edge = 0;
  for (size_t r = 0; r < runs.lines.size(); ++r) {
    if (!runs.is_of_edges[r]) {
      add(runs.lines.at(r));
      continue;
    }
    for (; edge < graph.edges() && graph.runOf(edge) == r; ++edge) {
      if (graph.isUsed(edge)) continue;
      bool is_ring = false;
      add(graph.strandOf(edge, is_ring));
      rings += is_ring ? 1 : 0;
    }
  }
  reportForks(graph.forks(), rings, report);
  return out;
}

namespace {

struct ObjPolylines {
  std::vector<Vec3> vertices;
  Polylines lines, edge_faces;           ///< `l` statements, and `f` statements of two corners
  std::vector<size_t> line_of, edge_of;  ///< line of the file, 1-based, per polyline
  size_t faces = 0, points = 0, free_forms = 0, empty = 0;
  bool has_colours = false;
};

void addPolyline(const ObjLines& lines, size_t vertices, Polylines& to, std::vector<size_t>& line_of) {
  const auto& words = lines.words();
  for (size_t i = 1; i < words.size(); ++i) to.corners.push_back(lines.vertexIndex(words[i], vertices));
  to.end();
  line_of.push_back(lines.line());
}

ObjPolylines readPolylines(ObjLines& lines) {
  static const std::set<std::string_view> kFreeForms{"curv", "curv2", "surf"};
  ObjPolylines found;
  while (lines.next()) {
    const auto& words = lines.words();
    const std::string keyword = lines.keyword();
    if (keyword == "v") {
      found.vertices.push_back(lines.position());
      found.has_colours |= words.size() >= 7;
    } else if (keyword == "l") {
      if (words.size() > 1)
        addPolyline(lines, found.vertices.size(), found.lines, found.line_of);
      else
        ++found.empty;
    } else if (keyword == "f" && words.size() == 3) {
      addPolyline(lines, found.vertices.size(), found.edge_faces, found.edge_of);
    } else if (keyword == "f" || keyword == "fo") {
      ++found.faces;
    } else if (keyword == "p") {
      ++found.points;
    } else if (kFreeForms.contains(keyword)) {
      ++found.free_forms;
    }
  }
  return found;
}

/// Uses faces of two corners as edges of strands where the file has no polylines.
void collectEdgeFaces(ObjPolylines& found, FileReport& report) {
  if (found.edge_faces.size() == 0) return;
  if (found.lines.size() > 0) {
    addOmissionCount(report, found.edge_faces.size(), "face", " of two corners");
    return;
  }
  report.warnings.push_back(
      fmt::format("{} faces (f) of two corners are read as edges of strands", found.edge_faces.size()));
  found.lines = std::move(found.edge_faces);
  found.line_of = std::move(found.edge_of);
}

[[noreturn]] void refuseWithoutPolylines(const ObjLines& lines, const ObjPolylines& found) {
  if (found.free_forms > 0)
    lines.fail("the file has no polylines (l) but free-form shapes (curv, curv2, surf), which are not read",
               1, "convert the curves to polylines and export these");
  lines.fail(
      "the file has no polylines (l)", 1,
      found.faces > 0 ? "export the hair as polylines, not as a mesh" : "export the hair as polylines");
}

StrandSet strandsOf(const ObjPolylines& found, const Polylines& joined) {
  StrandSet strands;
  strands.positions.reserve(joined.corners.size());
  for (size_t s = 0; s < joined.size(); ++s) {
    for (const uint32_t v : joined.at(s)) strands.positions.push_back(found.vertices[v]);
    strands.offsets.push_back(static_cast<uint32_t>(strands.positions.size()));
  }
  return strands;
}

}  // namespace

RawGroom readObjStrands(std::span<const std::byte> bytes, const std::string& name) {
  ObjLines lines(bytes, name);
  if (bytes.empty()) lines.fail("the file is empty", 1);
  RawGroom groom;
  groom.format = "obj";
  groom.native_up = UpAxis::kY;
  ObjPolylines found = readPolylines(lines);
  collectEdgeFaces(found, groom.report);
  if (found.lines.size() == 0) refuseWithoutPolylines(lines, found);
  if (found.lines.corners.size() > std::numeric_limits<uint32_t>::max())
    lines.fail("the file has more than 4294967295 strand vertices", found.line_of.back(), "split the file");
  for (size_t l = 0; l < found.lines.size(); ++l)
    for (const uint32_t corner : found.lines.at(l))
      lines.checkIndex(corner, found.vertices.size(), found.line_of[l]);
  const Polylines joined = joinedPolylines(found.lines, found.vertices.size(), groom.report);
  if (joined.size() == 0)
    lines.fail("every polyline (l) goes from a vertex to itself", found.line_of.front(),
               "export the hair as polylines");
  groom.strands = strandsOf(found, joined);
  removeNonFinite(groom.strands, groom.report, lines.where(found.line_of.front()));
  addOmissionCount(groom.report, found.empty, "polyline", " without vertices");
  addOmissionCount(groom.report, found.faces, "face", " (f)");
  addOmissionCount(groom.report, found.points, "statement", " of points (p)");
  addOmissionCount(groom.report, found.free_forms, "free-form shape", " (curv, curv2, surf)");
  addOmissionCount(groom.report, lines.unknown(), "statement", " that the format does not have");
  if (found.has_colours) groom.report.addOmission("vertex colours");
  return groom;
}

}  // namespace strandcast
