#pragma once
#include <vector>

#include "render/hair_pass.h"

namespace strandcast {

/// A vertex of grown hair, read back from the device.
struct GrownVertex {
  Vec3 position;  ///< m
  uint32_t hair;
  Vec3 tangent;  ///< unit
  uint32_t node;
};

/// The vertices that the compute shader grew last with this node stride: hair after hair in draw order, root
/// to tip.
std::vector<GrownVertex> readComputed(const HairPass& pass, const GuideNodes& nodes, int node_stride);
/// The vertices that the tessellator grows, by transform feedback: two per line, lines in unspecified order.
std::vector<GrownVertex> readTessellated(const HairPass& pass, const GuideNodes& nodes,
                                         const HairDetail& detail);

}  // namespace strandcast
