#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "transport/codec/guide_payload.h"
#include "transport/codec/tangent_symbols.h"

namespace strandcast {

/// Encoding::kTangent: the direction of each edge is a point of the plane that touches the unit sphere where
/// it is predicted, so that its error is the same in all directions and what is written is the prediction's
/// error.
///
/// A strand is predicted from a reference shape, which is its rest shape or, in a frame that builds on
/// others, what its motion makes of them: the reference's edge is turned as the edge before it was turned
/// from the reference's by the smallest rotation (parallel transport; Bergou et al., Discrete Elastic Rods,
/// 2008).
///
/// Both ends compute the same predictions bit for bit: with sums, products, quotients and square roots of
/// float32 in the order given here, none of them fused.

/// What both ends remember of a run for the frame that builds on it.
struct TangentHistory {
  uint64_t frame = 0;              ///< 0 = nothing
  std::vector<Vec3> last, before;  ///< per edge: unit, in the head's frame, of `frame` and the one before it
  TangentSizes sizes;              ///< of `frame`

  /// What was written of a frame; exchanges the arrays. One that `stands_alone` has no motion yet.
  void accept(uint64_t of_frame, bool stands_alone, std::vector<Vec3>& directions, TangentSizes& of_sizes) {
    frame = of_frame;
    before.swap(last);
    last.swap(directions);
    if (stands_alone) before = last;
    sizes.swap(of_sizes);
  }
};

namespace tangent {

inline constexpr size_t kLanes = 4;  // strands that are walked together
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

struct Vector {
  Lanes x, y, z;
};

inline Lanes fill(float value) { return Lanes{value, value, value, value}; }
inline Lanes squareRoot(Lanes a) {
  return Lanes{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
inline Lanes atLeast(Lanes a, float least) { return a > fill(least) ? a : fill(least); }
inline Lanes magnitude(Lanes a) { return a < fill(0) ? -a : a; }
inline Lanes dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector sum(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector difference(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector scaled(const Vector& a, Lanes by) { return {a.x * by, a.y * by, a.z * by}; }
inline Vector unit(const Vector& a) { return scaled(a, fill(1) / squareRoot(dot(a, a))); }

/// `a` turned by the smallest rotation from `from` to `to`, both unit; as it is where these are almost
/// opposite.
inline Vector turned(const Vector& a, const Vector& from, const Vector& to) {
  const Lanes cosine = dot(from, to);
  const Vector both = sum(from, to);
  const Vector less = difference(a, scaled(both, dot(both, a) / (fill(1) + cosine)));
  const Vector result = sum(less, scaled(to, fill(2) * dot(from, a)));
  const auto is_sound = cosine > fill(-0.9f);
  return {is_sound ? result.x : a.x, is_sound ? result.y : a.y, is_sound ? result.z : a.z};
}

/// The axes u and v of the plane across a unit vector (Duff et al., Building an Orthonormal Basis, Revisited,
/// JCGT 2017).
inline void axesAcross(const Vector& n, Vector& u, Vector& v) {
  const Lanes sign = n.z < fill(0) ? fill(-1) : fill(1);
  const Lanes a = fill(-1) / (sign + n.z), b = n.x * n.y * a;
  u = {fill(1) + sign * n.x * n.x * a, sign * b, -sign * n.x};
  v = {b, sign + n.y * n.y * a, -n.y};
}

inline Vector load(const Vec3* const (&from)[kLanes]) {
  return {Lanes{from[0]->x(), from[1]->x(), from[2]->x(), from[3]->x()},
          Lanes{from[0]->y(), from[1]->y(), from[2]->y(), from[3]->y()},
          Lanes{from[0]->z(), from[1]->z(), from[2]->z(), from[3]->z()}};
}

/// An edge of four strands, on the way.
struct Edge {
  size_t edges[kLanes];     ///< of the run
  size_t vertices[kLanes];  ///< of the run, at their far ends
  bool is_there[kLanes];    ///< false in a strand that has ended: then its numbers mean nothing
  Vector from;              ///< where they begin, in the head's frame, m
  Vector predicted, u, v;   ///< directions
  Lanes length;             ///< m
};

/// What is written of these edges. Symbols are steps along u and v at the edge's far end.
inline void loadOffsets(const Edge& edge, const GuideSymbols& symbols, float step, Lanes& x, Lanes& y) {
  const size_t plane = symbols.edges.size() / 2;
  for (size_t l = 0; l < kLanes; ++l) {
    x[l] = static_cast<float>(static_cast<int16_t>(symbols.edges[edge.edges[l]]));
    y[l] = static_cast<float>(static_cast<int16_t>(symbols.edges[plane + edge.edges[l]]));
  }
  const Lanes by = fill(step) / atLeast(edge.length, kShortestEdge);
  x = x * by;
  y = y * by;
}

/// Aims at the `wanted` positions (per vertex of the run, head's frame, m), sets the symbols and reads them
/// back.
inline void chooseOffsets(const Edge& edge, std::span<const Vec3> wanted, float step, GuideSymbols& symbols,
                          Lanes& x, Lanes& y) {
  const Vec3* targets[kLanes];
  for (size_t l = 0; l < kLanes; ++l) targets[l] = &wanted[edge.vertices[l]];
  const Vector way = difference(load(targets), edge.from);
  const Lanes ahead = dot(way, edge.predicted), length = atLeast(edge.length, kShortestEdge);
  const Lanes scale = length / (ahead * fill(step));
  const Lanes u = dot(way, edge.u) * scale, v = dot(way, edge.v) * scale, most = fill(32767);
  // Where it does not hold, as for numbers that are none, the strand is found to be off and sent as it is.
  const auto holds = (ahead > fill(0.05f) * length) & (magnitude(u) < most) & (magnitude(v) < most);
  const size_t plane = symbols.edges.size() / 2;
  for (size_t l = 0; l < kLanes; ++l) {
    if (!edge.is_there[l]) continue;
    symbols.edges[edge.edges[l]] = holds[l] ? static_cast<uint16_t>(nearest(u[l])) : uint16_t{0};
    symbols.edges[plane + edge.edges[l]] = holds[l] ? static_cast<uint16_t>(nearest(v[l])) : uint16_t{0};
  }
  loadOffsets(edge, symbols, step, x, y);
}

}  // namespace tangent

/// Follows all strands of `run` from their roots in `positions` (per vertex, head's frame), which it fills,
/// and sets the `directions` of edges. For each edge of four strands it calls offsets(edge, x, y), which says
/// how far from the predicted direction theirs is, along u and v; these are numbers below 1e15.
template <class Offsets>
void walkTangents(const GuideGeometry& geometry, const StrandRun& run, const TangentHistory* history,
                  std::span<Vec3> positions, std::span<Vec3> directions, const Offsets& offsets) {
  using namespace tangent;
  if (directions.empty()) return;
  for (uint32_t group = 0; group < run.strand_count; group += kLanes) {
    size_t roots[kLanes], counts[kLanes], most = 0;
    const Vec3* root_positions[kLanes];
    for (uint32_t l = 0; l < kLanes; ++l) {
      const uint32_t number = std::min(group + l, run.strand_count - 1), s = run.first_strand + number;
      roots[l] = geometry.offsets[s] - run.first_vertex;
      const size_t edges = geometry.offsets[s + 1] - geometry.offsets[s] - 1;
      counts[l] = group + l < run.strand_count ? edges : 0;
      most = std::max(most, counts[l]);
      root_positions[l] = &positions[roots[l]];
    }
    Edge edge{};
    edge.from = load(root_positions);
    Vector reference_before{}, direction_before{};
    for (size_t i = 0; i < most; ++i) {
      const Vec3 *last[kLanes], *before[kLanes];
      for (uint32_t l = 0; l < kLanes; ++l) {
        edge.is_there[l] = i < counts[l];
        if (edge.is_there[l]) {
          edge.vertices[l] = roots[l] + 1 + i;
          edge.edges[l] = edge.vertices[l] - 1 - (group + l);
        }
        const size_t vertex = edge.vertices[l];
        edge.length[l] = geometry.lengths[run.first_vertex + vertex];
        last[l] = history ? &history->last[edge.edges[l]] : &geometry.directions[run.first_vertex + vertex];
        before[l] = history ? &history->before[edge.edges[l]] : last[l];
      }
      Vector reference = load(last);
      if (history) reference = unit(difference(sum(reference, reference), load(before)));
      edge.predicted = i == 0 ? reference : turned(reference, reference_before, direction_before);
      axesAcross(edge.predicted, edge.u, edge.v);
      Lanes x{}, y{};
      offsets(edge, x, y);
      const Vector direction = unit(sum(sum(edge.predicted, scaled(edge.u, x)), scaled(edge.v, y)));
      edge.from = sum(edge.from, scaled(direction, edge.length));
      for (size_t l = 0; l < kLanes; ++l) {
        if (!edge.is_there[l]) continue;
        directions[edge.edges[l]] = Vec3(direction.x[l], direction.y[l], direction.z[l]);
        positions[edge.vertices[l]] = Vec3(edge.from.x[l], edge.from.y[l], edge.from.z[l]);
      }
      reference_before = reference;
      direction_before = direction;
    }
  }
}

}  // namespace strandcast
