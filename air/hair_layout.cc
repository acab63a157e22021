#include "air/hair_layout.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernels/scalar_grid.h"

namespace strandcast {
namespace {

constexpr double kFastestWave = 1.4;  // cells in a step; with 2, hair that was pushed apart vibrates
constexpr int kMargin = 6;            // cells around the groom at rest

}  // namespace

double HairLayout::largestStiffness(double seconds) const {
  const double speed = kFastestWave * static_cast<double>(cell) / seconds;
  return speed * speed;
}

Pose HeadExtrapolation::ahead(const Pose& begin, const Pose& end) {
  if (std::exchange(
          is_rebased_,
          false)) {  // `begin` was rounded to the new origin; the shift alone would not reproduce it
    begin_.position += begin.position - end_.position;
    end_.position = begin.position;
  }
  const bool goes_on =
      known_ && begin.position == end_.position && begin.rotation.coeffs() == end_.rotation.coeffs();
  const Pose before = goes_on ? begin_ : begin;
  known_ = true;
  begin_ = begin;
  end_ = end;
  const auto part = static_cast<float>(kernels::f64::extrapolationShare());
  const Quat turn = begin.rotation * before.rotation.conjugate();
  return {begin.position + part * (begin.position - before.position),
          (Quat::Identity().slerp(part, turn) * begin.rotation).normalized()};
}

HairLayout hairLayout(const Box& box, int cells) {
  const float cell = std::max(box.sizes().maxCoeff(), 1e-3f) / static_cast<float>(cells - 1 - 2 * kMargin);
  return {cells, cell, Vec3(box.center()) - Vec3::Constant(0.5f * cell * static_cast<float>(cells - 1))};
}

namespace {

// Greatest length of a piece of several edges, in cells; the blur is wider. With 2.25 rounding errors excite
// a head of hair at rest: 0.6 mm in a second.
constexpr float kLongest = 1.5f;
constexpr uint32_t kMaxParts = 16;

float edgeLength(const StrandModel& model, uint32_t edge) {
  return (model.rest_local[edge + 1] - model.rest_local[edge]).norm();
}

StrandPieces piecesOf(const StrandModel& model, size_t strand, float cell) {
  StrandPieces out{model.offsets[strand], static_cast<uint32_t>(model.verticesOf(strand)) - 1, 0, 0, 1};
  float longest = 0;
  for (uint32_t e = out.vertex; e < out.vertex + out.edges; ++e)
    longest = std::max(longest, edgeLength(model, e));
  const float cells = longest / cell;
  const auto parts = static_cast<uint32_t>(std::max(1.0f, std::ceil(cells - 0.25f)));
  out.parts = static_cast<uint16_t>(std::min(parts, kMaxParts));
  uint32_t pieces = out.edges * out.parts;
  if (out.parts == 1) {
    const auto together = static_cast<uint32_t>(
        std::clamp(std::floor(kLongest / std::max(cells, 1e-6f)), 1.0f, static_cast<float>(out.edges)));
    pieces = (out.edges + together - 1) / together;
  }
  out.pieces = static_cast<uint16_t>(pieces);
  return out;
}

}  // namespace

StrandSamples strandSamples(const StrandModel& model, float cell) {
  StrandSamples out;
  out.offsets.push_back(0);
  out.edge_masses.assign(model.vertices(), {0, 0});
  std::vector<double> of_vertex(model.vertices());
  for (size_t s = 0; s < model.strands(); ++s) {
    StrandPieces strand = piecesOf(model, s, cell);
    strand.sample = static_cast<uint32_t>(out.samples.size());
    out.strands.push_back(strand);
    const uint32_t first = strand.vertex, last = first + strand.edges;
    auto add = [&](uint32_t vertex,
                   const std::vector<double>& masses) {  // one mass per vertex, starting at `vertex`
      double mass = 0;
      for (const double m : masses) mass += m;
      out.samples.push_back({vertex, static_cast<uint32_t>(out.shares.size()),
                             static_cast<uint32_t>(masses.size()), static_cast<float>(mass)});
      for (size_t i = 0; i < masses.size(); ++i) {
        out.shares.push_back(static_cast<float>(masses[i] / mass));
        out.vertex_parts.push_back(static_cast<float>(masses[i]));
        of_vertex[vertex + i] += masses[i];
      }
    };
    // A vertex has the mass of half of each adjacent edge. The thickness of a half is that at a quarter of
    // the edge.
    auto length = [&](uint32_t edge) {
      return edge >= first && edge < last ? edgeLength(model, edge) : 0.0f;
    };
    auto thickness = [&](uint32_t vertex) {
      return double{model.mass[vertex]} / double{length(vertex - 1) + length(vertex)};
    };
    auto half = [&](uint32_t vertex, uint32_t edge) {
      const uint32_t other = vertex == edge ? edge + 1 : edge;
      return length(edge) > 0 ? double{length(edge)} * (3 * thickness(vertex) + thickness(other)) : 0.0;
    };
    auto part = [&](uint32_t vertex, uint32_t edge) {
      return static_cast<float>(double{model.mass[vertex]} * model.reference_mass[s] * half(vertex, edge) /
                                (half(vertex, vertex - 1) + half(vertex, vertex)));
    };
    for (uint32_t e = first; e < last; ++e) out.edge_masses[e] = {part(e, e), part(e + 1, e)};
    for (uint32_t e = first; strand.parts > 1 && e < last; ++e)
      for (int p = 0; p < strand.parts; ++p) {
        const double at = (p + 0.5) / strand.parts, share = 2.0 / strand.parts;
        add(e,
            {share * (1 - at) * double{out.edge_masses[e][0]}, share * at * double{out.edge_masses[e][1]}});
      }
    for (uint32_t p = 0; strand.parts == 1 && p < strand.pieces; ++p) {
      const uint32_t begin = strand.firstEdge(p), end = strand.firstEdge(p + 1);
      std::vector<double> masses(end - begin + 1);
      for (uint32_t e = begin; e < end; ++e) {
        masses[e - begin] += double{out.edge_masses[first + e][0]};
        masses[e - begin + 1] += double{out.edge_masses[first + e][1]};
      }
      add(first + begin, masses);
    }
    out.offsets.push_back(static_cast<uint32_t>(out.samples.size()));
  }
  size_t entry = 0;
  for (const StrandSample& sample : out.samples)
    for (uint32_t i = 0; i < sample.count; ++i, ++entry)
      out.vertex_parts[entry] = static_cast<float>(out.vertex_parts[entry] / of_vertex[sample.vertex + i]);
  return out;
}

DragShares dragShares(const StrandModel& model, const StrandSamples& samples) {
  DragShares out;
  const std::vector<float>& scale = model.air_drag_scale;
  if (std::all_of(scale.begin(), scale.end(), [](float factor) { return factor == 1; })) return out;
  double mass = 0, dragged = 0;
  for (const StrandPieces& strand : samples.strands)
    for (uint32_t p = 0; p < strand.pieces; ++p) {
      // All parts of an edge have the factor of the edge.
      const uint32_t first = strand.firstEdge(p),
                     end = strand.parts > 1 ? first + 1 : strand.firstEdge(p + 1);
      double own = 0, own_dragged = 0;
      for (uint32_t v = strand.vertex + first; v < strand.vertex + end; ++v)
        for (size_t side = 0; side < 2; ++side) {
          own += double{samples.edge_masses[v][side]};
          own_dragged += double{samples.edge_masses[v][side]} * double{scale[v + side]};
        }
      const double factor = own_dragged / own;
      out.of_samples.push_back(static_cast<float>(factor));
      const double of_sample = double{samples.samples[strand.sample + p].mass};
      mass += of_sample;
      dragged += of_sample * factor;
    }
  out.mean = mass > 0 ? dragged / mass : 1;
  for (float& share : out.of_samples) share = out.mean > 0 ? static_cast<float>(share / out.mean) : 0.0f;
  return out;
}

}  // namespace strandcast
