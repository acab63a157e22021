#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "transport/codec/guide_payload.h"

namespace strandcast {

/// Directions of a run's edges, unit vectors in the head's frame, in the order of StrandCoder: tile after
/// tile, edge after edge, x y z, one strand per lane.
using DirectionRows = std::vector<float>;

/// What encoder and decoder keep of a run for the frame that builds on it.
class TangentHistory {
 public:
  uint64_t frame = 0;  ///< 0 = none
  DirectionRows last;  ///< directions in `frame`

  /// Directions in the frame that `frame` built on; equal to `last` (no motion) where `frame` was a key
  /// frame.
  const DirectionRows& before() const { return was_key_ ? last : before_; }

  /// Records the directions of a frame; swaps the arrays.
  void accept(uint64_t of_frame, bool stands_alone, DirectionRows& directions) {
    frame = of_frame;
    was_key_ = stands_alone;
    before_.swap(last);
    last.swap(directions);
  }

 private:
  bool was_key_ = true;
  DirectionRows before_;
};

/// The inner loops of encoders and decoders along strands, one strand per lane. Compiled once per instruction
/// set. All instruction sets give the same bits: the operations are float32 sums, products, quotients and
/// square roots, none of them fused.

/// Scratch rows of lanes, reused from chunk to chunk. Memory: the longest strand times the number of lanes.
struct LaneRows {
  std::vector<float> numbers;
  std::vector<uint16_t> symbols;
};

/// Arguments of an encoder: a run of strands of one frame.
struct StrandEncoding {
  const GuideGeometry& geometry;
  const StrandRun& run;
  const HeadFrame& head;
  const Vec3* positions;  ///< per vertex of the run, world, m; may be non-finite
  const Vec3* roots;    ///< per strand of the run, as decoded: head's frame, m; delta16: in steps of the grid
  float step;           ///< m; unused by octahedral
  float squared_limit;  ///< m^2
  int bits = 16;        ///< octahedral: 12 or 16
  const DirectionRows* rest = nullptr;  ///< tangents: as rest_directions() writes them
  /// Tangents: directions in the frame that this one builds on; null to build on `rest`.
  const TangentHistory* history = nullptr;
  uint16_t* edges;                      ///< out: the planes of GuideSymbols::edges
  DirectionRows* directions = nullptr;  ///< tangents, out: decoded directions; may be null
  /// In and out, per strand of the run: largest squared error, m^2; infinite where the symbols cannot
  /// represent the strand.
  float* worst;
};

/// Arguments of a decoder: the symbols of a run of strands.
struct StrandDecoding {
  const GuideGeometry& geometry;
  const StrandRun& run;
  const HeadFrame& head;
  const Vec3* roots;  ///< as in StrandEncoding
  float step;         ///< m; unused by octahedral
  int bits = 16;
  bool along_strand = false;  ///< unused by tangents: symbols are residuals to the edge before
  const DirectionRows* rest = nullptr;
  const TangentHistory* history = nullptr;
  const uint16_t* edges;                ///< the planes of GuideSymbols::edges
  DirectionRows* directions = nullptr;  ///< tangents, out
  Vec3* positions;                      ///< out: per vertex of the run, world, m
};

/// The functions of one instruction set. Each decoder inverts the encoder of its encoding.
struct StrandCoder {
  std::string name;  ///< of the instruction set, as Highway names it
  void (*encode_delta)(const StrandEncoding& job, LaneRows& rows) = nullptr;
  void (*encode_octahedral)(const StrandEncoding& job, LaneRows& rows) = nullptr;
  void (*encode_tangents)(const StrandEncoding& job, LaneRows& rows) = nullptr;
  void (*decode_delta)(const StrandDecoding& job, LaneRows& rows) = nullptr;
  void (*decode_octahedral)(const StrandDecoding& job, LaneRows& rows) = nullptr;
  void (*decode_tangents)(const StrandDecoding& job, LaneRows& rows) = nullptr;
  /// Writes GuideGeometry::directions of a run as DirectionRows.
  void (*rest_directions)(const GuideGeometry& geometry, const StrandRun& run, DirectionRows& rows) = nullptr;
  /// Packs blocks of bits (bit_blocks.h). `to` must have maxPackedBytes() bytes; returns the end of the
  /// packed bytes.
  uint8_t* (*pack)(std::span<const uint16_t> numbers, uint8_t* to) = nullptr;
  /// Unpacks numbers.size() numbers and removes their bytes from the front of `bytes`. False where `bytes`
  /// ends early; the contents of both are unspecified then.
  bool (*unpack)(std::span<const uint8_t>& bytes, std::span<uint16_t> numbers) = nullptr;
  /// Residuals: each symbol minus the one before it if `along` (0 before the first), as signed numbers of
  /// `bits` bits.
  void (*subtract)(const uint16_t* symbols, size_t count, bool along, int bits,
                   uint16_t* residuals) = nullptr;
  /// Low and high bytes of zigzag(residual).
  void (*fold)(const uint16_t* residuals, size_t count, uint8_t* low, uint8_t* high) = nullptr;
  void (*unfold)(const uint8_t* low, const uint8_t* high, size_t count, uint16_t* symbols) = nullptr;
};

/// The coder of the best instruction set of this machine.
const StrandCoder& strandCoder();
/// The coders of all instruction sets that this program was compiled for and the machine can run, best first.
std::vector<StrandCoder> runnableStrandCoders();

}  // namespace strandcast
