#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/codec.h"
#include "transport/codec/guide_payload.h"
#include "transport/codec/strand_coder.h"
#include "transport/codec/symbol_packer.h"
#include "transport/guide_source.h"

namespace strandcast {

/// State that all chunks of a groom's frames share.
struct EncodedGroom {
  CodecOptions options;
  GuideGeometry geometry;
  std::vector<StrandRun> runs;            ///< one per chunk
  std::vector<DirectionRows> rests;       ///< per run; empty until they are needed
  std::vector<TangentHistory> histories;  ///< per run; kTemporal only
};

/// The guides of a frame: per run packed or in positions.
struct EncoderInput {
  std::span<const Vec3> positions;      ///< world, m; only of runs that are not packed
  std::span<const PackedRun> packed{};  ///< per run; empty = no run is packed

  bool isPacked(size_t run) const { return !packed.empty() && !packed[run].symbols.empty(); }
};

/// As EncodingReport, of one chunk.
struct ChunkReport {
  uint64_t strands_sent_finer = 0;
  double worst_error = 0;  ///< m, of the other strands
};

/// Encodes the guides of a run into a chunk. Several encoders may work on one groom at the same time, each on
/// another chunk. Memory: that of the largest chunk.
class ChunkEncoder {
 public:
  /// `groom` must outlive it and its options must not change. Every `coder` writes the same bytes.
  ChunkEncoder(EncodedGroom& groom, const StrandCoder& coder);
  /// As GuideEncoder::encode, with the guides in `guides` in place of frame.positions.
  ChunkReport encode(const GuideFrame& frame, const EncoderInput& guides, uint32_t index, GuideChunk& chunk);

 private:
  void encodeTangents(const GuideFrame& frame, uint32_t index, GuideChunk& chunk);
  void quantize(const GuideFrame& frame, uint32_t index, Encoding encoding, const TangentHistory* history);
  void quantizeRoots(const StrandRun& run, const HeadFrame& head, Encoding encoding);
  void collectStrandEnds(const StrandRun& run);
  void forgetExactStrands(const StrandRun& run);
  ChunkReport writePacked(const PackedRun& packed, const StrandRun& run, GuideChunk& chunk);
  void writeFloat32(const StrandRun& run, GuideChunk& chunk) const;
  void writePreamble(const StrandRun& run, uint8_t mode, float step, std::vector<uint8_t>& bytes) const;
  void writeSymbols(const StrandRun& run, GuideChunk& chunk);

  EncodedGroom* groom_;
  float squared_limit_;  // m^2
  float step_;           // m, of the grid of positions
  float tangent_step_;   // m, of the tangent plane's grid
  StrandCoder coder_;
  // Of the current chunk:
  std::span<const Vec3> positions_;  // of the frame's guides
  GuideSymbols symbols_;
  std::vector<uint32_t> strand_ends_;  // SymbolPrediction::strand_ends; not of tangents
  std::vector<uint16_t> exact_;        // strands of the run that are sent as float32
  float worst_squared_ = 0;            // m^2, of the other strands
  SymbolPacker packer_;
  LaneRows rows_;
  std::vector<Vec3> roots_;   // per strand: StrandEncoding::roots
  std::vector<float> worst_;  // per strand: StrandEncoding::worst
  DirectionRows directions_;  // kTemporal only
};

/// Encodes the guides of one groom into chunks. Memory: that of the groom's rest shape, of two frames for
/// kTemporal, and of two chunks for each encoding thread.
class GuideEncoder {
 public:
  /// Precondition: checkCodecOptions() accepts `options`. Every `coder` writes the same bytes.
  explicit GuideEncoder(const CodecOptions& options, const StrandCoder& coder = strandCoder());
  ~GuideEncoder();
  GuideEncoder(const GuideEncoder&) = delete;
  GuideEncoder& operator=(const GuideEncoder&) = delete;

  /// Precondition: checkAnnouncement() accepted `guides`.
  void setGroom(const StrandSet& guides);
  /// One run per chunk; a frame is these chunks in order.
  const std::vector<StrandRun>& runs() const { return groom_.runs; }
  /// Encodes chunk `index` of `frame`, header and payload, into `chunk`, whose memory is reused.
  /// Precondition: the frame has the positions of all runs and a head pose with a unit quaternion. Allocates
  /// only in the first frames.
  void encode(const GuideFrame& frame, uint32_t index, GuideChunk& chunk);
  /// Encodes all chunks of `frame` on as many threads as the options say. Calls send(chunk) for each chunk in
  /// order on this thread, while later chunks are still encoded. `send` may swap the chunk's memory; its
  /// exceptions propagate.
  void encodeAll(const GuideFrame& frame, const std::function<void(GuideChunk&)>& send);
  /// The same with the guides in `guides` in place of frame.positions.
  void encodeAll(const GuideFrame& frame, GuideSource& guides, const std::function<void(GuideChunk&)>& send);
  /// Of the encoded chunks of the newest frame number.
  const EncodingReport& report() const { return report_; }

 private:
  class EncoderPool;
  /// Has `guides` packed if the options allow it, and takes positions of the other runs.
  EncoderInput inputOf(const GuideFrame& frame, GuideSource& guides) const;
  void add(const GuideFrame& frame, const GuideChunk& chunk, const ChunkReport& report);

  EncodedGroom groom_;
  GuideGrid grid_;  // without a number where the options need another encoding than blocks of delta16
  const StrandCoder coder_;
  const int threads_;
  ChunkEncoder own_;  // for encoding without the pool
  GuideChunk own_chunk_;
  std::unique_ptr<EncoderPool> pool_;
  EncodingReport report_;
  uint64_t reported_frame_ = 0;
};

/// The groom that a publisher of a network has announced: its chunks, and the encoder of its frames.
class AnnouncedGroom {
 public:
  AnnouncedGroom(uint32_t groom_id, uint64_t session, const CodecOptions& codec)
      : groom_id_(groom_id), session_(session), hair_error_(codec.hair_error), encoder_(codec) {}

  struct Chunks {
    std::vector<GroomChunk> groom;
    std::vector<BodyChunk> body;
  };
  /// Throws Error as Publisher::announce().
  Chunks chunksOf(const GroomDescription& groom, const BodyDescription& body) const;
  /// The chunks of hairs that follow the groom accepted last. Throws Error as Publisher::announceHairs().
  std::vector<HairChunk> chunksOf(const HairDescription& hairs) const;
  /// Call after its chunks are sent: frames and hairs are of this groom from now on.
  void accept(const GroomDescription& groom);

  /// Calls send(chunk) for each chunk of the frame in order, as GuideEncoder::encodeAll(); for none where the
  /// frame is of another groom.
  void divide(const GuideFrame& frame, const std::function<void(GuideChunk&)>& send);
  /// The same with the guides in `guides` in place of frame.positions.
  void divide(const GuideFrame& frame, GuideSource& guides, const std::function<void(GuideChunk&)>& send);
  EncodingReport encoding() const { return encoder_.report(); }

 private:
  const uint32_t groom_id_;
  const uint64_t session_;
  const float hair_error_;
  GuideEncoder encoder_;
  std::optional<GroomDescription> accepted_;
};

}  // namespace strandcast
