#pragma once
#include <vector>

#include "render/hair_pass.h"

namespace strandcast {

/// A vertex of a grown hair, read back from the device.
struct GrownVertex {
  Vec3 position;  ///< m
  uint32_t hair;
  Vec3 tangent;  ///< unit
  uint32_t node;
};

/// What the compute shader grew last with this node stride: hair after hair, root to tip, counted as they are
/// drawn.
std::vector<GrownVertex> readComputed(const HairPass& pass, const GuideNodes& nodes, int node_stride);
/// What the tessellator grows, by transform feedback: two vertices a line, lines in no certain order.
std::vector<GrownVertex> readTessellated(const HairPass& pass, const GuideNodes& nodes,
                                         const HairDetail& detail);

}  // namespace strandcast
