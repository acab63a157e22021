#include "apps/cast_size.h"

#include "transport/codec/guide_encoder.h"

namespace strandcast {

std::optional<uint64_t> bytesPerFrame(const StrandSet& guides) {
  for (size_t s = 0; s < guides.strands(); ++s)
    if (guides.verticesOf(s) > kMaxWireVertices) return std::nullopt;
  GuideEncoder encoder{CodecOptions()};
  encoder.setGroom(guides);
  GuideFrame frame;
  frame.frame = 1;
  frame.positions = guides.positions;
  GuideChunk chunk;
  for (uint32_t i = 0; i < encoder.runs().size(); ++i) encoder.encode(frame, i, chunk);
  return encoder.report().frame_bytes;
}

}  // namespace strandcast
