#pragma once
#include <cstdint>
#include <vector>

#include "air/hair_layout.h"

namespace strandcast::gpu {

/// The samples of one workgroup: the same pieces of neighbouring strands that are cut alike. 8 words, read by
/// shaders/sample_tile.glsl.
struct SampleTile {
  uint32_t first_strand;                    ///< index in SampleTiles::roots
  uint32_t strands;                         ///< number of strands
  uint32_t first_piece;                     ///< of each strand
  uint32_t pieces;                          ///< per strand
  uint32_t edges, pieces_of_strand, parts;  ///< of each strand, see StrandPieces
  uint32_t margin;  ///< pieces before first_piece that its vertices also need; see hair_gather.comp
};

constexpr uint32_t kTileSamples = 320;  ///< samples per tile at most, with its margin: one invocation each

/// All samples, in tiles. Arrays of samples have kTileSamples entries per tile, within a tile in Morton order
/// of the rest positions.
struct SampleTiles {
  std::vector<SampleTile> tiles;
  std::vector<uint32_t> roots;   ///< per strand, in the order of tiles: its first vertex
  std::vector<uint32_t> order;   ///< per entry: strand of the tile + 65536 x piece of the tile
  std::vector<uint32_t> places;  ///< per element of StrandSamples::samples: its entry
};

/// Divides the samples of `model` into tiles. `layout`: the hair grid, for the order.
SampleTiles sampleTiles(const StrandModel& model, const StrandSamples& samples, const HairLayout& layout);

}  // namespace strandcast::gpu
