#include "io/polygon.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <utility>

namespace strandcast {
namespace {

constexpr double kNoEar = -1;
/// Quality of a corner whose neighbours coincide (a spike). It is cut off before all ears, because no other
/// test can tell the sides of the remaining polygon apart.
constexpr double kSpike = 2;
/// A polygon is flat if its corners lie within this share of its size from its plane: six printed digits.
constexpr double kFlat = 1e-5;
/// Threshold of twice the area, as a share of the square of the polygon's size, for a degenerate triangle:
/// rounding error of collinear corners.
constexpr double kRoundedArea = 1e-12;

double crossOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Twice the signed area of a triangle, positive if counter-clockwise.
double turnOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return crossOf(b - a, c - a);
}

/// Whether p lies in the triangle, its border included.
bool isWithin(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
              const Eigen::Vector2d& c) {
  return turnOf(a, b, p) >= 0 && turnOf(b, c, p) >= 0 && turnOf(c, a, p) >= 0;
}

bool isLess(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

}  // namespace

bool PolygonCutter::cut(std::span<const uint32_t> corners, std::vector<Triangle>& triangles) {
  gather(corners);
  if (ring_.size() < 3) return false;
  if (ring_.size() == 3) {
    add(0, 1, 2, triangles);
    return true;
  }
  if (!flatten()) {
    for (uint32_t i = 2; i < ring_.size(); ++i) add(0, i - 1, i, triangles);
    return false;
  }
  if (is_flat_ && fan(triangles)) return true;
  rotateToLeast();
  flatten();  // again: from another corner the plane has another origin and rounds differently
  link();
  return clip(triangles);
}

/// Fills the ring, without corners that repeat the previous one.
void PolygonCutter::gather(std::span<const uint32_t> corners) {
  ring_.clear();
  for (const uint32_t vertex : corners)
    if (ring_.empty() || ring_.back().vertex != vertex)
      ring_.push_back({vertex, Eigen::Vector2d::Zero(), 0, 0, kNoEar, false, false});
  while (ring_.size() > 1 && ring_.back().vertex == ring_.front().vertex) ring_.pop_back();
}

/// Projects the corners to the polygon's plane. Returns false if the polygon has no area.
bool PolygonCutter::flatten() {
  const auto at = [&](size_t i) {
    return Eigen::Vector3d(positions_[ring_[i % ring_.size()].vertex].cast<double>());
  };
  const Eigen::Vector3d origin = at(0);
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  double size = 0;
  for (size_t i = 0; i < ring_.size(); ++i) {
    area += (at(i) - origin).cross(at(i + 1) - origin);
    size = std::max(size, (at(i) - origin).norm());
  }
  no_area_ = kRoundedArea * size * size;
  if (!(area.norm() > no_area_)) return false;
  const Eigen::Vector3d normal = area.normalized();
  const Eigen::Vector3d x = normal.unitOrthogonal(), y = normal.cross(x);
  double highest = 0, lowest = 0;
  for (size_t i = 0; i < ring_.size(); ++i) {
    const Eigen::Vector3d p = at(i) - origin;
    ring_[i].at = {x.dot(p), y.dot(p)};
    highest = std::max(highest, normal.dot(p));
    lowest = std::min(lowest, normal.dot(p));
  }
  is_flat_ = highest - lowest <= kFlat * size;
  return true;
}

/// Adds the triangle fan of the first corner, or nothing if the fan does not cover the polygon once.
bool PolygonCutter::fan(std::vector<Triangle>& triangles) const {
  double angle = 0;
  for (size_t i = 2; i < ring_.size(); ++i) {
    const Eigen::Vector2d a = ring_[i - 1].at - ring_[0].at, b = ring_[i].at - ring_[0].at;
    if (!(crossOf(a, b) > 0)) return false;
    angle += std::atan2(crossOf(a, b), a.dot(b));
  }
  if (angle >= 2 * std::numbers::pi) return false;
  for (uint32_t i = 2; i < ring_.size(); ++i) add(0, i - 1, i, triangles);
  return true;
}

/// Rotates the ring to start at the corner from which the sequence of positions is lexicographically least.
/// Two candidates are compared at a time, and each comparison advances one of them (Booth 1980).
void PolygonCutter::rotateToLeast() {
  const size_t count = ring_.size();
  const auto at = [&](size_t i) -> const Vec3& { return positions_[ring_[i % count].vertex]; };
  size_t first = 0, second = 1, equal = 0;
  while (first < count && second < count && equal < count) {
    const Vec3 &a = at(first + equal), &b = at(second + equal);
    if (a == b) {
      ++equal;
      continue;
    }
    (isLess(b, a) ? first : second) += equal + 1;
    if (first == second) ++second;
    equal = 0;
  }
  std::rotate(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(std::min(first, second)),
              ring_.end());
}

void PolygonCutter::link() {
  const auto count = static_cast<uint32_t>(ring_.size());
  for (uint32_t i = 0; i < count; ++i) {
    ring_[i].before = (i + count - 1) % count;
    ring_[i].after = (i + 1) % count;
  }
  inward_.clear();
  for (uint32_t i = 0; i < count; ++i) {
    ring_[i].is_inward = !(turnAt(i) > 0);
    if (ring_[i].is_inward) inward_.push_back(i);
  }
}

double PolygonCutter::turnAt(uint32_t corner) const {
  return turnOf(ring_[ring_[corner].before].at, ring_[corner].at, ring_[ring_[corner].after].at);
}

/// Whether the total turning angle along the ring is one full circle, as in a polygon without
/// self-intersection. Corners that reverse direction may turn either way; the result is then true.
bool PolygonCutter::turnsOnce() const {
  double angle = 0;
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  for (size_t i = 0; i < 2 * ring_.size(); ++i) {  // the first round finds the edge before the first
    const Eigen::Vector2d edge = ring_[(i + 1) % ring_.size()].at - ring_[i % ring_.size()].at;
    if (edge.isZero(0)) continue;
    if (i >= ring_.size()) {
      const double turn = crossOf(last, edge), along = last.dot(edge);
      if (along < 0 && std::abs(turn) <= no_area_) return true;
      angle += std::atan2(turn, along);
    }
    last = edge;
  }
  return std::abs(angle - 2 * std::numbers::pi) < 1;
}

/// Similarity of the triangle at a corner to an equilateral one, 0 to 1; kSpike for a spike; kNoEar if the
/// corner is no ear.
double PolygonCutter::earQuality(uint32_t tip) {
  const Eigen::Vector2d &b = ring_[tip].at, &a = ring_[ring_[tip].before].at, &c = ring_[ring_[tip].after].at;
  if (a == c) return kSpike;
  const double area = turnOf(a, b, c);
  if (!(area > 0)) return kNoEar;
  tests_ += inward_.size();
  for (const uint32_t i : inward_) {
    const Corner& corner = ring_[i];
    if (corner.is_gone || !corner.is_inward || corner.at == a || corner.at == b || corner.at == c) continue;
    if (isWithin(corner.at, a, b, c)) return kNoEar;
  }
  return 2 * std::numbers::sqrt3 * area /
         ((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm());
}

/// The corner to cut off when there is no ear: a collinear one, else the one of the largest left turn. Only
/// polygons that intersect themselves reach the latter case.
uint32_t PolygonCutter::tipWithoutEar(uint32_t from, bool& covers_once) const {
  uint32_t widest = from, i = from;
  do {
    if (std::abs(turnAt(i)) <= no_area_) return i;
    if (turnAt(i) > turnAt(widest)) widest = i;
    i = ring_[i].after;
  } while (i != from);
  covers_once = false;
  return widest;
}

/// Ear clipping, best ear first, until one triangle is left. Returns whether the triangles cover the polygon
/// once.
bool PolygonCutter::clip(std::vector<Triangle>& triangles) {
  std::priority_queue<std::pair<double, uint32_t>> ears;
  const auto judge = [&](uint32_t i) {
    ++tests_;
    if (turnAt(i) > 0) ring_[i].is_inward = false;
    ring_[i].quality = isSpent() ? kNoEar : earQuality(i);
    if (ring_[i].quality != kNoEar) ears.emplace(ring_[i].quality, i);
  };
  const auto judgeAll = [&](uint32_t from) {
    for (uint32_t i = from, first = true; first || i != from; i = ring_[i].after, first = false) judge(i);
  };
  const auto nextEar = [&](uint32_t none) {
    for (; !ears.empty(); ears.pop()) {
      const auto [quality, i] = ears.top();
      if (!ring_[i].is_gone && ring_[i].quality == quality) return i;
    }
    return none;
  };
  bool covers_once = turnsOnce();
  const auto count = static_cast<uint32_t>(ring_.size());
  judgeAll(0);
  uint32_t at = 0;  // a corner that is still in the ring
  for (uint32_t left = count; left > 3 && !isSpent(); --left) {
    uint32_t tip = nextEar(count);
    if (tip == count) {  // a corner that blocked an ear may be gone
      judgeAll(at);
      tip = nextEar(count);
    }
    if (tip == count) {
      tip = tipWithoutEar(at, covers_once);
      tests_ += left;
    }
    const uint32_t before = ring_[tip].before, after = ring_[tip].after;
    add(before, tip, after, triangles);
    ring_[before].after = after;
    ring_[after].before = before;
    ring_[tip].is_gone = true;
    if (tip == at) at = after;
    judge(before);
    judge(after);
  }
  add(ring_[at].before, at, ring_[at].after, triangles);
  return covers_once && turnAt(at) >= -no_area_;
}

void PolygonCutter::add(uint32_t a, uint32_t b, uint32_t c, std::vector<Triangle>& triangles) const {
  const Triangle made{ring_[a].vertex, ring_[b].vertex, ring_[c].vertex};
  if (made[0] != made[1] && made[1] != made[2] && made[2] != made[0]) triangles.push_back(made);
}

}  // namespace strandcast
