#pragma once
#include <cstdint>
#include <span>
#include <string>

namespace strandcast {

/// How guides are written into chunks. The fields of a payload are described in docs/wire.md.
enum class Codec {
  kFloat32,       ///< positions as they are
  kDelta16,       ///< a grid of steps, 16-bit differences along the strand
  kOctahedral12,  ///< directions of edges in 2 x 12 bits; lengths from the groom. What does not fit: kDelta16
  kOctahedral16,  ///< the same in 2 x 16 bits
  kTangent,  ///< directions of edges, predicted from the rest shape; lengths from the groom. What does not
             ///< fit: kDelta16
  kTemporal  ///< kTangent, predicted from the last two frames, for links that lose nothing
};

struct CodecOptions {
  Codec codec = Codec::kDelta16;
  /// m, kMinCodecError to kMaxCodecError: no vertex is decoded further from where it was. A strand that would
  /// be is sent as it is. (kFloat32 has no error.)
  float max_error = 1e-5f;
  /// Frames from one that stands alone to the next, 1 to kMaxKeyInterval; kTemporal only. A reader that
  /// joins, or that missed a frame, waits that long.
  uint32_t key_interval = 10;
  /// Compresses kDelta16 and kOctahedral* with zstd: up to 7 % fewer bytes for twice the encoder's time.
  bool zstd = false;
  /// That encode a frame's chunks, kMaxEncodingThreads at most; 0 = all of the machine. The bytes are the
  /// same.
  int threads = 0;
};

inline constexpr float kMinCodecError = 1e-6f, kMaxCodecError = 1e-3f;  // m
inline constexpr uint32_t kMaxKeyInterval = 1000;
inline constexpr int kMaxEncodingThreads = 8;

struct CodecInfo {
  Codec codec;
  const char* name;
  const char* help;
};
std::span<const CodecInfo> codecList();
const char* nameOf(Codec codec);
/// Throws Error, naming `where`, on an unknown name.
Codec codecNamed(const std::string& name, const std::string& where);
/// Throws Error, naming `where`, on options out of range.
void checkCodecOptions(const CodecOptions& options, const std::string& where);

}  // namespace strandcast
