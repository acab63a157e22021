#include "transport/codec/codec.h"

#include <array>

#include "core/error.h"
#include "core/name_lookup.h"

namespace strandcast {
namespace {

constexpr std::array<CodecInfo, 6> kCodecs = {{
    {Codec::kFloat32, "float32", "positions as they are, 12 bytes per vertex"},
    {Codec::kDelta16, "delta16",
     "16-bit differences along the strand, packed; about 3.5 bytes per vertex, for any hair and any link"},
    {Codec::kOctahedral12, "oct12",
     "directions of edges in 2 x 12 bits, packed; for edges that are short and do not stretch"},
    {Codec::kOctahedral16, "oct16", "directions in 2 x 16 bits, for long edges or a small --codec-error"},
    {Codec::kTangent, "tangent",
     "directions predicted from the groomed shape; smallest for one frame alone, where edges do not stretch"},
    {Codec::kTemporal, "temporal",
     "tangent predicted from the last two frames: smallest of all, for links that lose nothing (DDS)"},
}};

}  // namespace

std::span<const CodecInfo> codecList() { return kCodecs; }

const char* nameOf(Codec codec) {
  for (const CodecInfo& info : kCodecs) {
    if (info.codec == codec) return info.name;
  }
  return "?";
}

Codec codecNamed(const std::string& name, const std::string& where) {
  return namedEntry(kCodecs, "codec", name, where).codec;
}

void checkCodecOptions(const CodecOptions& options, const std::string& where) {
  if (!(options.max_error >= kMinCodecError && options.max_error <= kMaxCodecError)) {
    throw Error("the codec's worst error is out of range", where, "give 0.001 to 1 mm");
  }
  if (!(options.hair_error >= kMinHairError && options.hair_error <= kMaxHairError))
    throw Error("the worst error of hairs is out of range", where, "give 0.01 to 1 mm");
  if (options.key_interval < 1 || options.key_interval > kMaxKeyInterval) {
    throw Error("the interval of key frames is out of range", where, "give 1 to 1000 frames");
  }
  if (options.threads < 0)
    throw Error("the number of encoding threads is negative", where, "give 0, for all, or more");
}

}  // namespace strandcast
