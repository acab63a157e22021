#pragma once
#include <vector>

#include "gl/buffer.h"
#include "gl/program.h"
#include "render/guide_nodes.h"
#include "render/hair_growth.h"

namespace strandcast {

/// Hairs grown by a compute shader, once per picture for all passes. Every vertex is two vec4: position (w:
/// the part of the hair's length behind it) and unit tangent (w: 1 where all its guides are usable); vertices
/// of a hair follow each other from the root on, hairs as they were given.
class HairVertices {
 public:
  /// A buffer holds as many hairs as the device allows; there are as many buffers as it takes.
  struct Chunk {
    size_t first, hairs;
    gl::Buffer vertices;
  };

  HairVertices();

  /// Grows the first `count` of the hairs that are bound with a vertex at every `node_stride`-th node, kept
  /// out of bodies where `bodies` says so. The guides' nodes, hairs and GrowthBlock are bound.
  void grow(size_t count, int segments, int node_stride, bool bodies);

  const std::vector<Chunk>& chunks() const { return chunks_; }
  size_t hairs() const { return hairs_; }  ///< grown last
  int nodesPerHair() const { return nodes_per_hair_; }
  size_t bytes() const;  ///< of device memory

 private:
  void makeRoom(size_t count, int most_nodes);

  gl::Program free_, among_bodies_;
  std::vector<Chunk> chunks_;
  size_t room_ = 0, hairs_ = 0;
  int most_nodes_ = 0, nodes_per_hair_ = 0;
};

}  // namespace strandcast
