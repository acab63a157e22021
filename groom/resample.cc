#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/strand_model.h"
#include "groom/clean.h"

namespace strandcast {
namespace {

/// A strand and the positions of its new vertices, as arc lengths from the root in m.
class EvenCut {
 public:
  void start(const StrandSet& strands, size_t s, size_t count) {
    points_ = strands.strand(s);
    at_.assign(points_.size(), 0.0);
    for (size_t i = 1; i < points_.size(); ++i) at_[i] = at_[i - 1] + (point(i) - point(i - 1)).norm();
    places_.assign(count, 0.0);
    findPlaces();
  }
  /// Arc length of new vertex `k`, m.
  double place(size_t k) const { return places_[k]; }
  /// Arc length of vertex `vertex` of the original strand, m.
  double at(size_t vertex) const { return at_[vertex]; }
  /// Index of the new vertex at an arc length; fractional between two vertices.
  double vertexAt(double place) const {
    const auto next = std::upper_bound(places_.begin(), places_.end(), place);
    if (next == places_.begin() || !(places_.back() > 0)) return 0;
    const auto k = static_cast<size_t>(next - places_.begin()) - 1;
    if (next == places_.end()) return static_cast<double>(places_.size() - 1);
    return static_cast<double>(k) + (place - places_[k]) / (places_[k + 1] - places_[k]);
  }

  /// A point on the original strand: an edge and the fraction along it, 0 to 1.
  struct OnEdge {
    size_t edge, end;
    double part;
  };
  OnEdge onEdge(double place) const {
    const auto next = std::lower_bound(at_.begin() + 1, at_.end(), place);
    const size_t end = std::min(static_cast<size_t>(next - at_.begin()), at_.size() - 1);
    const size_t edge = end > 0 ? end - 1 : 0;
    const double length = at_[end] - at_[edge];
    return {edge, end, length > 0 ? std::clamp((place - at_[edge]) / length, 0.0, 1.0) : 0.0};
  }
  Vec3 pointAt(const OnEdge& on) const {
    const Eigen::Vector3d a = point(on.edge), b = point(on.end);
    return (a + on.part * (b - a)).cast<float>();
  }

 private:
  Eigen::Vector3d point(size_t i) const { return points_[i].cast<double>(); }

  /// Places points `chord` apart in a straight line, one after another, each at the first such point of the
  /// polyline; beyond the tip the last edge is extended. Returns how far beyond the tip the last point lies,
  /// m.
  double march(double chord) {
    size_t edge = 0;
    Eigen::Vector3d from = point(0);
    for (size_t k = 1; k < places_.size(); ++k) {
      while (edge < last_edge_ && (point(edge + 1) - from).norm() < chord) ++edge;
      const Eigen::Vector3d start = point(edge), along = (point(edge + 1) - start).normalized();
      const double nearest = along.dot(from - start),
                   aside2 = (from - start).squaredNorm() - nearest * nearest;
      const double part = nearest + std::sqrt(std::max(chord * chord - aside2, 0.0));
      from = start + part * along;
      places_[k] = at_[edge] + part;
    }
    return places_.back() - at_.back();
  }

  /// Finds the chord with which march() ends at the tip, by false position (the Illinois rule; Dowell and
  /// Jarratt 1971, "A modified regula falsi method"). Returns false where there is none, as may be in a
  /// strand that returns to itself.
  bool marchToTip() {
    constexpr int kMostMarches = 60;
    const double length = at_.back(), exact = 1e-10 * length;
    // The upper bound holds because a chord is the shortest path.
    double low = 0, high = length / static_cast<double>(places_.size() - 1);
    double below = -length, above = march(high);
    if (above <= exact) return true;
    for (int marches = 0, side = 0; marches < kMostMarches; ++marches) {
      const double chord = (low * above - high * below) / (above - below), beyond = march(chord);
      if (std::abs(beyond) <= exact) return true;
      const int now = beyond > 0 ? 1 : -1;
      (now > 0 ? high : low) = chord;
      (now > 0 ? above : below) = beyond;
      if (now == side) (now > 0 ? below : above) /= 2;
      side = now;
    }
    return false;
  }
  void findPlaces() {
    const double length = at_.back();
    last_edge_ = 0;
    for (size_t e = 0; e + 1 < at_.size(); ++e)
      if (at_[e + 1] > at_[e]) last_edge_ = e;
    const auto last = static_cast<double>(std::max<size_t>(places_.size() - 1, 1));
    if (places_.size() < 3 || !(length > 0) || !marchToTip())
      for (size_t k = 0; k < places_.size(); ++k) places_[k] = length * static_cast<double>(k) / last;
    if (places_.size() > 1) places_.back() = length;
  }

  std::span<const Vec3> points_;
  std::vector<double> at_, places_;
  size_t last_edge_ = 0;  ///< the last edge of nonzero length
};

/// A new vertex is pinned if it lies between two pinned neighbours. In addition each pinned vertex pins the
/// new vertex nearest to it: an isolated pin would otherwise be lost between two samples.
void carryPins(const StrandSet& from, size_t s, const EvenCut& cut, std::span<uint8_t> pins) {
  const uint8_t* old_pins = from.pinned.data() + from.offsets[s];
  const size_t old_count = from.verticesOf(s);
  const auto last = static_cast<double>(pins.size() - 1);
  for (size_t i = 0; i < old_count; ++i) {
    if (!old_pins[i]) continue;
    const double place = cut.vertexAt(cut.at(i));
    pins[static_cast<size_t>(std::clamp(std::round(place), 0.0, last))] = 1;
    if (i + 1 == old_count || !old_pins[i + 1]) continue;
    for (double k = std::ceil(place); k <= std::min(cut.vertexAt(cut.at(i + 1)), last); ++k)
      pins[static_cast<size_t>(k)] = 1;
  }
}

void resampleStrand(const StrandSet& from, size_t s, size_t count, EvenCut& cut, StrandSet& to) {
  cut.start(from, s, count);
  const uint32_t first = from.offsets[s];
  for (size_t k = 0; k < count; ++k) {
    const EvenCut::OnEdge on = cut.onEdge(cut.place(k));
    Vec3 point = cut.pointAt(on);
    if (k == 0) point = from.strand(s).front();
    if (k + 1 == count && count > 1) point = from.strand(s).back();
    to.positions.push_back(point);
    if (!from.radii.empty()) {
      const float a = from.radii[first + on.edge], b = from.radii[first + on.end];
      to.radii.push_back(a + static_cast<float>(on.part) * (b - a));
    }
  }
  if (!from.pinned.empty()) {
    to.pinned.resize(to.positions.size(), 0);
    carryPins(from, s, cut, std::span(to.pinned).last(count));
  }
  if (!from.uvs.empty()) to.uvs.push_back(from.uvs[s]);
  if (!from.parts.empty()) to.parts.push_back(from.parts[s]);
  to.offsets.push_back(static_cast<uint32_t>(to.positions.size()));
}

void checkCount(int vertices) {
  if (vertices < static_cast<int>(kMinVerticesPerStrand) ||
      vertices > static_cast<int>(kMaxVerticesPerStrand))
    throw Error(fmt::format("strands cannot have {} vertices", vertices), "resampling",
                fmt::format("choose {} to {}", kMinVerticesPerStrand, kMaxVerticesPerStrand));
}

template <class CountOf>
StrandSet resampleAll(const StrandSet& strands, CountOf count_of) {
  StrandSet result;
  EvenCut cut;
  for (size_t s = 0; s < strands.strands(); ++s) resampleStrand(strands, s, count_of(s), cut, result);
  return result;
}

}  // namespace

StrandSet resample(const StrandSet& strands, int vertices) {
  checkCount(vertices);
  return resampleAll(strands, [&](size_t) { return static_cast<size_t>(vertices); });
}

StrandSet equalize(const StrandSet& strands, int max_vertices) {
  checkCount(max_vertices);
  return resampleAll(
      strands, [&](size_t s) { return std::min(strands.verticesOf(s), static_cast<size_t>(max_vertices)); });
}

}  // namespace strandcast
