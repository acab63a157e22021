// Public API
#pragma once
#include <cstdint>
#include <span>
#include <string>

namespace strandcast {

/// How guides are encoded into chunks; docs/wire.md, "Payloads", has the format.
enum class Codec {
  kFloat32,       ///< float32 positions, exact
  kDelta16,       ///< positions on a grid, as 16-bit differences along the strand
  kOctahedral12,  ///< directions of edges in 2 x 12 bits, lengths from the groom. Falls back to kDelta16
  kOctahedral16,  ///< directions of edges in 2 x 16 bits, likewise
  kTangent,  ///< directions of edges, predicted from the rest shape; lengths from the groom. Falls back to
             ///< kDelta16
  kTemporal  ///< kTangent, predicted from the last two frames, for links without packet loss
};

/// Choices of an encoder; checkCodecOptions() checks their ranges.
struct CodecOptions {
  Codec codec = Codec::kDelta16;
  /// m, kMinCodecError to kMaxCodecError: bound on the error of every decoded vertex. A strand that would
  /// exceed it is sent as float32. kFloat32 has no error.
  float max_error = 1e-5f;
  /// Frames from one key frame to the next, 1 to kMaxKeyInterval; kTemporal only. A reader that joins, or
  /// missed a frame, waits for the next key frame.
  uint32_t key_interval = 10;
  /// Compresses kDelta16 and kOctahedral* with zstd: up to 7 % fewer bytes for twice the encoder's time.
  bool zstd = false;
  /// Threads that encode a frame's chunks, at most kMaxEncodingThreads; 0 = all of the machine. The bytes do
  /// not depend on it.
  int threads = 0;
  /// m, kMinHairError to kMaxHairError: bound on the error at rest of hairs that follow the guides.
  float hair_error = 30e-6f;
};

inline constexpr float kMinCodecError = 1e-6f, kMaxCodecError = 1e-3f;  // m
inline constexpr float kMinHairError = 10e-6f, kMaxHairError = 1e-3f;   // m
inline constexpr uint32_t kMaxKeyInterval = 1000;
inline constexpr int kMaxEncodingThreads = 8;

/// A codec as the option --codec names and explains it.
struct CodecInfo {
  Codec codec;
  const char* name;
  const char* help;
};
/// All codecs.
std::span<const CodecInfo> codecList();
const char* nameOf(Codec codec);
/// Throws Error, naming `where`, on an unknown name.
Codec codecNamed(const std::string& name, const std::string& where);
/// Throws Error, naming `where`, on options out of range.
void checkCodecOptions(const CodecOptions& options, const std::string& where);

}  // namespace strandcast
