#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "render/hair_growth.h"

namespace strandcast {

/// Hairs grown on the CPU in double precision with the same kernel source as the shaders (kernels/hair.h):
/// the reference of validation. Slow.
class HairReference {
 public:
  /// `positions`: vertices of all guides, as in a frame. Guides without a curve give zeros.
  HairReference(const StrandSet& rest_guides, std::span<const Vec3> positions, int segments);

  struct Vertex {
    Eigen::Vector3d position;  ///< m
    Eigen::Vector3d tangent;   ///< unit
  };
  /// The vertex at node 0 to `segments`, without bodies. `growth`: the parameters of the hair's growth.
  Vertex at(const Hair& hair, const HairGrowth& growth, int node) const;
  /// Length of the hair's guide 0 as the sum of chords between nodes, m.
  double guideLength(const Hair& hair) const;

 private:
  struct Node {
    Eigen::Vector3d position, derivative, normal;
  };

  int segments_;
  std::vector<Node> nodes_;  ///< segments + 1 per guide
};

}  // namespace strandcast
