#include "air/strand_samples.h"

#include <algorithm>
#include <cmath>

namespace strandcast {
namespace {

constexpr float kLongest = 1.5f;  // cells that a piece of several edges may be long: the blur is wider

}  // namespace

StrandSamples strandSamples(const StrandModel& model, float cell) {
  StrandSamples out;
  out.offsets.push_back(0);
  std::vector<double> of_vertex(model.vertices());
  for (size_t s = 0; s < model.strands(); ++s) {
    const uint32_t first = model.offsets[s], last = model.offsets[s + 1] - 1;
    auto length = [&](uint32_t v) { return (model.rest_local[v + 1] - model.rest_local[v]).norm(); };
    auto add = [&](uint32_t vertex, const std::vector<double>& masses) {  // of vertices from `vertex` on
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
    // Vertices have half the mass of each edge; the model's masses are such halves added up, so that an
    // edge's is known from the root on.
    std::vector<double> edge_mass(last - first);
    double total = 0, long_ = 0;
    for (uint32_t v = first; v <= last; ++v) total += model.mass[v];
    for (uint32_t v = first; v < last; ++v) long_ += length(v);
    for (uint32_t v = first; v < last; ++v)
      edge_mass[v - first] = total * model.reference_mass[s] * length(v) / long_;
    for (uint32_t v = first; v < last;) {
      const int parts = static_cast<int>(std::ceil(length(v) / cell - 0.25f));
      if (parts > 1) {
        for (int p = 0; p < parts; ++p) {
          const double at = (p + 0.5) / parts, mass = edge_mass[v - first] / parts;
          add(v, {mass * (1 - at), mass * at});
        }
        ++v;
        continue;
      }
      std::vector<double> masses{0};
      float along = 0;
      const uint32_t begin = v;
      do {
        masses.back() += edge_mass[v - first] / 2;
        masses.push_back(edge_mass[v - first] / 2);
        along += length(v++);
      } while (v < last && along + length(v) <= kLongest * cell);
      add(begin, masses);
    }
    out.offsets.push_back(static_cast<uint32_t>(out.samples.size()));
  }
  size_t entry = 0;
  for (const StrandSample& sample : out.samples)
    for (uint32_t i = 0; i < sample.count; ++i, ++entry)
      out.vertex_parts[entry] = static_cast<float>(out.vertex_parts[entry] / of_vertex[sample.vertex + i]);
  return out;
}

}  // namespace strandcast
