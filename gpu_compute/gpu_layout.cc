#include "gpu_compute/gpu_layout.h"

#include <cmath>

#include "core/backend.h"

namespace strandcast::gpu {

Settings settingsOf(const StepInput& input, const StrandModel& model) {
  const Parameters& p = *input.parameters;
  const double h = static_cast<double>(p.time_step) / p.substeps;
  Settings s{};
  for (int c = 0; c < 3; ++c) {
    s.gravity[c] = p.gravity[c];
    s.wind[c] = p.wind[c];
  }
  const DragStep drag(p.air_drag, h);
  s.keep = static_cast<float>(drag.keep);
  s.time2 = static_cast<float>(drag.time2);
  s.substep = static_cast<float>(h);
  s.per_substep = static_cast<float>(1 / h);
  s.strength_root = static_cast<float>(1 - std::exp(-p.shape_rate * h / p.iterations));
  s.strength_tip = static_cast<float>(1 - std::exp(-p.shape_rate_tip * h / p.iterations));
  s.damping_time = p.damping_time;
  s.hair_radius = p.hair_radius;
  s.air_drag = p.air_drag;
  s.goal_rate = p.goal_rate;
  s.substeps = static_cast<uint32_t>(p.substeps);
  s.iterations = static_cast<uint32_t>(p.iterations);
  s.body_count = static_cast<uint32_t>(input.primitives.size());
  s.strand_count = static_cast<uint32_t>(model.strands());
  s.bone_count = static_cast<uint32_t>(model.bones.size());
  s.neighbourhoods = input.near != nullptr ? static_cast<uint32_t>(input.near->offsets.size()) - 1 : 0;
  return s;
}

}  // namespace strandcast::gpu
