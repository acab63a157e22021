#include "io/polyline_join.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

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
      report.leaveOut(fmt::format("{} edge{} from a vertex to itself", points, points == 1 ? "" : "s"));
    if (again > 0) report.leaveOut(fmt::format("{} edge{} written again", again, again == 1 ? "" : "s"));
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

}  // namespace strandcast
