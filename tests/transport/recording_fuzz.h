#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "fuzz_seeds.h"
#include "transport/recording/air_grids.h"
#include "transport/recording/record_file.h"

namespace strandcast {

/// A recording in memory.
class RecordingInMemory final : public RecordingBytes {
 public:
  explicit RecordingInMemory(std::vector<uint8_t> bytes) : bytes_(std::move(bytes)) {}
  uint64_t size() const override { return bytes_.size(); }
  bool read(uint64_t offset, std::span<uint8_t> to) override;

 private:
  const std::vector<uint8_t> bytes_;
};

/// Recomputes every record's hash, so that damage reaches the reader's other checks.
void repairHashes(std::vector<uint8_t>& recording);

/// Grids of hair only, or of wind too, which differ from frame to frame.
AirGrids sampleGrids(uint64_t frame, uint32_t cells, bool has_wind);

/// Reads everything in an arbitrary file as a recording: forwards, backwards and by time. The first byte
/// selects whether hashes are repaired first. Aborts where a frame does not fit its groom, or grids are
/// invalid. Returns the number of frames read.
size_t fuzzRecording(const uint8_t* data, size_t size);

/// Recordings of a few frames, as fuzzRecording() expects them.
std::vector<FuzzSeeds> recordingSeeds();

}  // namespace strandcast
