#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/error.h"
#include "core/strand_model.h"
#include "groom/clean.h"

namespace strandcast {
namespace {

/// Walks one strand by the length along its polyline, counted from the root.
class ArcWalk {
 public:
  void start(const StrandSet& strands, size_t s) {
    points_ = strands.strand(s);
    at_.assign(points_.size(), 0.0);
    for (size_t i = 1; i < points_.size(); ++i)
      at_[i] = at_[i - 1] + (points_[i] - points_[i - 1]).cast<double>().norm();
    edge_ = 0;
  }
  double length() const { return at_.back(); }
  double at(size_t vertex) const { return at_[vertex]; }

  /// Moves on to the edge that holds `distance`, which must not be smaller than at the last call, and returns
  /// where on that edge it lies, 0 to 1.
  double moveTo(double distance) {
    while (edge_ + 2 < at_.size() && at_[edge_ + 1] < distance) ++edge_;
    if (at_.size() < 2) return 0;
    const double edge_length = at_[edge_ + 1] - at_[edge_];
    return edge_length > 0 ? std::clamp((distance - at_[edge_]) / edge_length, 0.0, 1.0) : 0.0;
  }
  size_t edge() const { return edge_; }
  size_t edgeEnd() const { return std::min(edge_ + 1, at_.size() - 1); }

  Vec3 pointAt(double t) const {
    const Eigen::Vector3d a = points_[edge_].cast<double>(), b = points_[edgeEnd()].cast<double>();
    return (a + t * (b - a)).cast<float>();
  }

 private:
  std::span<const Vec3> points_;
  std::vector<double> at_;
  size_t edge_ = 0;
};

/// A new vertex is pinned when it lies between two pinned ones; and a pinned one always pins the new vertex
/// nearest to it, or it would be lost between two samples.
void carryPins(const StrandSet& from, size_t s, const ArcWalk& walk, std::span<uint8_t> pins) {
  const uint8_t* old_pins = from.pinned.data() + from.offsets[s];
  const size_t old_count = from.verticesOf(s);
  const auto last = static_cast<double>(pins.size() - 1);
  const double to_sample = walk.length() > 0 ? last / walk.length() : 0.0;
  for (size_t i = 0; i < old_count; ++i) {
    if (!old_pins[i]) continue;
    const double place = walk.at(i) * to_sample;
    pins[static_cast<size_t>(std::clamp(std::round(place), 0.0, last))] = 1;
    if (i + 1 == old_count || !old_pins[i + 1]) continue;
    for (double k = std::ceil(place); k <= std::min(walk.at(i + 1) * to_sample, last); ++k)
      pins[static_cast<size_t>(k)] = 1;
  }
}

void resampleStrand(const StrandSet& from, size_t s, size_t count, ArcWalk& walk, StrandSet& to) {
  walk.start(from, s);
  const uint32_t first = from.offsets[s];
  for (size_t k = 0; k < count; ++k) {
    const double t = walk.moveTo(walk.length() * static_cast<double>(k) /
                                 static_cast<double>(std::max<size_t>(count - 1, 1)));
    Vec3 point = walk.pointAt(t);
    if (k == 0) point = from.strand(s).front();
    if (k + 1 == count && count > 1) point = from.strand(s).back();
    to.positions.push_back(point);
    if (!from.radii.empty()) {
      const float a = from.radii[first + walk.edge()], b = from.radii[first + walk.edgeEnd()];
      to.radii.push_back(a + static_cast<float>(t) * (b - a));
    }
  }
  if (!from.pinned.empty()) {
    to.pinned.resize(to.positions.size(), 0);
    carryPins(from, s, walk, std::span(to.pinned).last(count));
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
  ArcWalk walk;
  for (size_t s = 0; s < strands.strands(); ++s) resampleStrand(strands, s, count_of(s), walk, result);
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
