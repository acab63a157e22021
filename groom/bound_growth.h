#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

#include <span>
#include <vector>

#include "core/geometry.h"
#include "core/strand_set.h"

namespace strandcast {

/// Bound hairs in double precision, with the kernel text of the shaders (kernels/hair.h): the reference of
/// tests and validation. Slow.
///
/// A guide has S + 1 nodes at equal parts of its rest arc length, on the same curve as render/guide_nodes.h.
/// Node i is at P_i, and at P'_i at rest. A guide whose nodes are all near where its root's motion carries
/// them counts as at rest (motionShare). Its rotation q_i from rest is that of the root, carried from node to
/// node (nodeRotation). Tangents of nodes are secants over S / 8 nodes to both sides, because edges of
/// received guides are noisy. A hair of length L has at arc length s the vertex x at rest. Its place on guide
/// k, of length L_k, is u = s / max(L, L_k), between the nodes i and i + 1 with f = S u - i:
///
///   x(t) = sum_k w_k ((1 - f) (P_i + q_i (x - P'_i)) + f (P_{i+1} + q_{i+1} (x - P'_{i+1})))
///
/// Where the guides are at rest the hair is too, whatever S is. Where they move rigidly it does the same.
class BoundHairReference {
 public:
  /// `positions`: m, world, vertices of all guides, as in a frame. `roots`: per guide, the motion of its root
  /// from the groom's rest frame to the world: that of the head, or of the skin under it. `segments`: S, 1 or
  /// more. Holds no reference to the arguments.
  BoundHairReference(const StrandSet& rest_guides, std::span<const Vec3> positions,
                     std::span<const Pose> roots, int segments);

  struct Vertex {
    Eigen::Vector3d position;  ///< m, world
    Eigen::Vector3d tangent;   ///< unit, or zero where the hair has none
  };
  /// The vertices of a hair, whose rest shape (m, groom frame) has 1 or more. Empty where a guide that it
  /// follows has fewer than two vertices, or one that is not finite or 1e6 m or farther from the origin.
  std::vector<Vertex> grow(std::span<const Vec3> rest, const HairBinding& binding) const;

 private:
  struct Node {
    Eigen::Vector3d rest, position;  // m
    Eigen::Quaterniond rotation;
  };

  int segments_;
  std::vector<double> lengths_;  // m, per guide, at rest; negative where the guide is not usable
  std::vector<Node> nodes_;      // segments + 1 per guide
};

}  // namespace strandcast
