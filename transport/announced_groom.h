#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/guide_encoder.h"

namespace strandcast {

/// The groom that a publisher of a network has announced: its chunks, and the encoder of its frames.
class AnnouncedGroom {
 public:
  AnnouncedGroom(uint32_t groom_id, uint64_t session, const CodecOptions& codec)
      : groom_id_(groom_id), session_(session), encoder_(codec) {}

  struct Chunks {
    std::vector<GroomChunk> groom;
    std::vector<BodyChunk> body;
  };
  /// Throws Error as Publisher::announce().
  Chunks chunksOf(const GroomDescription& groom, const BodyDescription& body) const;
  /// Call after its chunks are sent: frames are of this groom from now on.
  void accept(const GroomDescription& groom);

  /// Calls send(chunk) for each chunk of the frame in order, as GuideEncoder::encodeAll(); for none where the
  /// frame is of another groom.
  void divide(const GuideFrame& frame, const std::function<void(GuideChunk&)>& send);
  EncodingReport encoding() const { return encoder_.report(); }

 private:
  const uint32_t groom_id_;
  const uint64_t session_;
  GuideEncoder encoder_;
  std::optional<GroomDescription> accepted_;  // only its session and revision
  size_t vertices_ = 0;
};

}  // namespace strandcast
