#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/guide_encoder.h"

namespace strandcast {

/// What the publisher of a network has announced: how it goes out, and which frames fit it.
class AnnouncedGroom {
 public:
  AnnouncedGroom(uint32_t groom_id, uint64_t session, const CodecOptions& codec)
      : groom_id_(groom_id), session_(session), encoder_(codec) {}

  struct Chunks {
    std::vector<GroomChunk> groom;
    std::vector<BodyChunk> body;
  };
  /// Throws Error as Publisher::announce does.
  Chunks chunksOf(const GroomDescription& groom, const BodyDescription& body) const;
  /// Its chunks are out: frames are of this groom from now on.
  void accept(const GroomDescription& groom);

  /// Calls send(chunk) for one chunk of the frame after another, as GuideEncoder::encodeAll; for none where
  /// it is of another groom.
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
