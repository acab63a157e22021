#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "transport/codec/guide_payload.h"
#include "transport/codec/tangent_history.h"

namespace strandcast {

/// What encoders and decoders do along strands, as many strands side by side as the machine's vectors have
/// lanes. Compiled once per instruction set; all give the same bits, because they are sums, products,
/// quotients and square roots of float32, none of them fused.

/// Rows of lanes that a coder works in, kept for the next chunk: its memory is that of the longest strand,
/// once per lane.
struct LaneRows {
  std::vector<float> numbers;
  std::vector<uint16_t> symbols;
};

struct StrandEncoding {
  const GuideGeometry& geometry;
  const StrandRun& run;
  const HeadFrame& head;
  const Vec3* positions;  ///< per vertex of the run, world, m; may be not finite
  const Vec3*
      roots;   ///< per strand of the run, as it is decoded: head's frame, m; delta16: in steps of the grid
  float step;  ///< m; not of octahedral
  float squared_limit;                      ///< m^2
  int bits = 16;                            ///< octahedral: 12 or 16
  const DirectionRows* rest = nullptr;      ///< tangents: as rest_directions() has them
  const TangentHistory* history = nullptr;  ///< tangents: what this frame builds on in place of it, or null
  uint16_t* edges;                          ///< out: the planes of GuideSymbols::edges
  DirectionRows* directions = nullptr;      ///< tangents, out; may be null
  /// Per strand of the run, in and out: m^2, how far off it is; infinite where its symbols do not hold it.
  float* worst;
};

struct StrandDecoding {
  const GuideGeometry& geometry;
  const StrandRun& run;
  const HeadFrame& head;
  const Vec3* roots;  ///< as above
  float step;         ///< m; not of octahedral
  int bits = 16;
  bool along_strand = false;  ///< not of tangents: symbols are differences to the edge before
  const DirectionRows* rest = nullptr;
  const TangentHistory* history = nullptr;
  const uint16_t* edges;                ///< the planes of GuideSymbols::edges
  DirectionRows* directions = nullptr;  ///< tangents, out
  Vec3* positions;                      ///< out: per vertex of the run, world, m
};

struct StrandCoder {
  std::string name;  ///< of the instruction set, as Highway calls it
  void (*encode_delta)(const StrandEncoding& job, LaneRows& rows) = nullptr;
  void (*encode_octahedral)(const StrandEncoding& job, LaneRows& rows) = nullptr;
  void (*encode_tangents)(const StrandEncoding& job, LaneRows& rows) = nullptr;
  void (*decode_delta)(const StrandDecoding& job, LaneRows& rows) = nullptr;
  void (*decode_octahedral)(const StrandDecoding& job, LaneRows& rows) = nullptr;
  void (*decode_tangents)(const StrandDecoding& job, LaneRows& rows) = nullptr;
  /// The directions of GuideGeometry.
  void (*rest_directions)(const GuideGeometry& geometry, const StrandRun& run, DirectionRows& rows) = nullptr;
  /// Blocks of bits (bit_blocks.h) into room of mostPackedBytes(); where they end.
  uint8_t* (*pack)(std::span<const uint16_t> numbers, uint8_t* to) = nullptr;
  /// As many numbers as there is room for, off the front of `bytes`. False where these end before; both are
  /// arbitrary then.
  bool (*unpack)(std::span<const uint8_t>& bytes, std::span<uint16_t> numbers) = nullptr;
  /// Each symbol, `along` less the one before it (0 before the first): signed numbers of so many bits.
  void (*subtract)(const uint16_t* symbols, size_t count, bool along, int bits,
                   uint16_t* residuals) = nullptr;
  /// Low and high bytes of signed numbers that are folded to small ones (zigzag).
  void (*fold)(const uint16_t* residuals, size_t count, uint8_t* low, uint8_t* high) = nullptr;
  void (*unfold)(const uint8_t* low, const uint8_t* high, size_t count, uint16_t* symbols) = nullptr;
};

/// Of the best instruction set of this machine.
const StrandCoder& strandCoder();
/// All that this program was compiled for and the machine can run, best first.
std::vector<StrandCoder> runnableStrandCoders();

}  // namespace strandcast
