#pragma once
#include <cstdint>
#include <vector>

#include "air/hair_layout.h"
#include "air/strand_samples.h"

namespace strandcast::gpu {

/// Samples that one workgroup takes: the same pieces of strands that are neighbours and are cut alike. Read
/// by shaders/sample_tile.glsl as 8 words.
struct SampleTile {
  uint32_t first_strand;  ///< in SampleTiles::roots
  uint32_t strands;
  uint32_t first_piece;
  uint32_t pieces;
  uint32_t edges, pieces_of_strand, parts;  ///< of each strand, see StrandPieces
  uint32_t margin;                          ///< pieces before the first that its vertices also need
};

constexpr uint32_t kTileSamples = 320;  ///< of a tile at most, with its margin: an invocation each

/// All samples, in tiles. Tile t has the places from t kTileSamples on in arrays of samples; neighbours at
/// rest are neighbours there.
struct SampleTiles {
  std::vector<SampleTile> tiles;
  std::vector<uint32_t> roots;   ///< per strand in the order of tiles: its first vertex
  std::vector<uint32_t> order;   ///< per place: strand + 65536 piece, of its tile
  std::vector<uint32_t> places;  ///< of each of StrandSamples::samples
};

SampleTiles sampleTiles(const StrandModel& model, const StrandSamples& samples, const HairLayout& layout);

}  // namespace strandcast::gpu
