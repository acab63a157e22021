#pragma once
#include <vector>

#include "gl/buffer.h"
#include "gl/program.h"
#include "render/guide_nodes.h"
#include "render/hair_growth.h"

namespace strandcast {

/// Hairs grown by a compute shader, once per picture for all passes. A vertex is two vec4: position (w:
/// fraction of the hair's length up to it) and unit tangent (w: 1 where all its guides are usable). Vertices
/// of a hair are contiguous from the root on; hairs are in their given order.
class HairVertices {
 public:
  /// A buffer holds as many hairs as the device allows; there are as many buffers as needed.
  struct Chunk {
    size_t first, hairs;
    gl::Buffer vertices;
  };

  HairVertices();

  /// Grows the first `count` of the bound hairs with a vertex at every `node_stride`-th node, and keeps them
  /// out of bodies where `bodies` is set. Precondition: the guides' nodes, the hairs and GrowthBlock are
  /// bound.
  void grow(size_t count, int segments, int node_stride, bool bodies);

  const std::vector<Chunk>& chunks() const { return chunks_; }
  size_t hairs() const { return hairs_; }  ///< number grown last
  int nodesPerHair() const { return nodes_per_hair_; }
  size_t bytes() const;  ///< device memory

 private:
  void makeRoom(size_t count, int max_nodes);

  gl::Program free_, among_bodies_;
  std::vector<Chunk> chunks_;
  size_t room_ = 0, hairs_ = 0;
  int max_nodes_ = 0, nodes_per_hair_ = 0;
};

}  // namespace strandcast
