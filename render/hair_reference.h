#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "render/hair_growth.h"

namespace strandcast {

/// Hairs grown on the CPU in double precision with the same kernel text as the shaders (kernels/hair.h): what
/// validation holds them against. Slow.
class HairReference {
 public:
  /// `positions` as a frame has them, of all guides' vertices. Guides that have no curve give zeros.
  HairReference(const StrandSet& rest_guides, std::span<const Vec3> positions, int segments);

  struct Vertex {
    Eigen::Vector3d position;  ///< m
    Eigen::Vector3d tangent;   ///< unit
  };
  /// A vertex at node 0 to `segments`; away from bodies. `growth`: what the hair was grown with.
  Vertex at(const Hair& hair, const HairGrowth& growth, int node) const;
  /// Length of the guide that a hair follows most, of its chords between nodes, m.
  double guideLength(const Hair& hair) const;

 private:
  struct Node {
    Eigen::Vector3d position, derivative, normal;
  };

  int segments_;
  std::vector<Node> nodes_;  ///< segments + 1 per guide
};

}  // namespace strandcast
