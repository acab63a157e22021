// Guides that a backend packs where it keeps them: what an encoder asks for, and what it gets.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// A run of whole strands: the strands of one chunk of a frame.
struct StrandRun {
  uint32_t first_strand = 0, strand_count = 0, first_vertex = 0, vertex_count = 0;
};

/// How the guides of a groom are packed: encoding 1 (delta16) in blocks of bits, docs/wire.md, "Payloads".
struct GuideGrid {
  uint64_t number = 0;  ///< hash of the content: encoders of one groom share what is packed; 0 = no grid
  std::vector<StrandRun> runs;      ///< consecutive; together all strands
  std::vector<int32_t> rest_roots;  ///< grid index of the root at rest: 3 per strand
  float step = 0, per_step = 0;     ///< m; 1 / step
  float squared_limit = 0;          ///< m^2: largest squared error of a vertex
};

/// The frame that guides are packed in.
struct PackingFrame {
  Eigen::Matrix<float, 3, 3, Eigen::DontAlign> rotation;  ///< of the head
  Vec3 position;                                          ///< of the head, m, world
  Vec3 origin = Vec3::Zero();                             ///< m, world: of the backend's coordinates

  bool operator==(const PackingFrame& other) const {
    return rotation == other.rotation && position == other.position && origin == other.origin;
  }
};

/// The symbols of one run.
struct PackedRun {
  /// Blocks of bits: the roots' symbols, then the edges'. Empty where the run must be encoded from positions:
  /// a strand exceeds the limit or the grid, or float32 is as small.
  std::span<const uint8_t> symbols;
  bool along_strand = false;  ///< edges are predicted from the edge before
  float worst_squared = 0;    ///< m^2: largest squared error of a vertex
};

}  // namespace strandcast
