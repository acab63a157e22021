#include "transport/concealment.h"

#include <algorithm>

#include "transport/codec/guide_payload.h"

namespace strandcast {

void Concealment::setGroom(const StrandSet& guides) {
  offsets_ = guides.offsets;
  last_.assign(guides.vertices(), Vec3::Zero());
  before_.assign(guides.vertices(), Vec3::Zero());
  times_.assign(guides.strands(), {});
}

void Concealment::learn(const GuideFrame& frame, std::span<const StrandRun> received) {
  const HeadFrame head(frame.head);
  for (const StrandRun& run : received) {
    for (uint32_t s = run.first_strand; s < run.first_strand + run.strand_count; ++s) {
      Times& times = times_[s];
      times = {frame.simulation_time, times.last, times.count + 1, frame.frame};
    }
    for (uint32_t v = run.first_vertex; v < run.first_vertex + run.vertex_count; ++v) {
      before_[v] = last_[v];
      last_[v] = head.toHead(frame.positions[v]);
    }
  }
}

void Concealment::extrapolate(uint32_t strand, double time, std::span<Vec3> out) const {
  const Times& times = times_[strand];
  const uint32_t first = offsets_[strand];
  const double between = times.last - times.before;
  const bool has_motion = times.count >= 2 && between > 0 && between <= kMaxExtrapolation;
  const auto ahead =
      static_cast<float>(has_motion ? std::clamp(time - times.last, 0.0, kMaxExtrapolation) / between : 0.0);
  for (size_t i = 0; i < out.size(); ++i) {
    const Vec3& last = last_[first + i];
    Vec3 moved = last + ahead * (last - before_[first + i]);
    if (i > 0) {
      // Each vertex goes its own straight way; the strand keeps its length.
      const Vec3 edge =
          moved - (last_[first + i - 1] + ahead * (last_[first + i - 1] - before_[first + i - 1]));
      const float length = edge.norm();
      const Vec3 edge_before = last - last_[first + i - 1];
      moved = out[i - 1] + (length > 0 ? Vec3(edge * (edge_before.norm() / length)) : edge_before);
    }
    out[i] = moved;
  }
  if (!std::all_of(out.begin(), out.end(), [](const Vec3& p) { return p.allFinite(); }))
    std::copy_n(last_.begin() + first, out.size(), out.begin());
}

bool Concealment::conceal(GuideFrame& frame) {
  const HeadFrame head(frame.head);
  frame.strands_concealed = 0;
  for (uint32_t s = 0; s < times_.size(); ++s) {
    if (times_[s].count == 0) return false;
    if (times_[s].frame == frame.frame) continue;
    const std::span<Vec3> strand(frame.positions.data() + offsets_[s], offsets_[s + 1] - offsets_[s]);
    extrapolate(s, frame.simulation_time, strand);
    for (Vec3& position : strand) position = head.toWorld(position);
    ++frame.strands_concealed;
  }
  return true;
}

}  // namespace strandcast
