#include "recording_fuzz.h"

#include <algorithm>
#include <cstdlib>

#include "core/content_hash.h"
#include "core/error.h"
#include "transport/message_bytes.h"
#include "transport/recording/recording.h"

namespace strandcast {
namespace {

constexpr uint64_t kMostFrames = 64;  // that are read of one file: enough for every path, and quick

bool isSoundFrame(const RecordedFrame& read) {
  return read.groom && read.body && read.frame &&
         read.frame->positions.size() == read.groom->guides.vertices() &&
         std::all_of(read.frame->positions.begin(), read.frame->positions.end(),
                     [](const Vec3& position) { return position.allFinite(); });
}

}  // namespace

bool RecordingInMemory::read(uint64_t offset, std::span<uint8_t> to) {
  if (offset > bytes_.size() || to.size() > bytes_.size() - offset) std::abort();  // as it has promised
  std::copy_n(bytes_.begin() + static_cast<ptrdiff_t>(offset), to.size(),
              to.begin());  // also of an empty record
  return true;
}

void repairHashes(std::vector<uint8_t>& recording) {
  for (uint64_t at = sizeof kRecordingMagic; recording.size() - at >= kRecordHeadBytes;) {
    const auto length = loadBigEndian<uint32_t>(recording.data() + at + 4);
    const uint64_t begin = at + kRecordHeadBytes;
    if (length > recording.size() - begin) return;
    ContentHash hash;
    hash.add(recording.data() + at, 4);
    hash.add(recording.data() + begin, length);
    storeBigEndian(hash.value(), recording.data() + at + 8);
    at = begin + length;
  }
}

size_t fuzzRecording(const uint8_t* data, size_t size) {
  if (size < 1 + sizeof kRecordingMagic) return 0;
  std::vector<uint8_t> bytes(data + 1, data + size);
  if (data[0] % 2 == 1) repairHashes(bytes);
  size_t read = 0;
  try {
    Recording recording(std::make_unique<RecordingInMemory>(std::move(bytes)), "fuzz");
    const uint64_t frames = std::min(recording.frames(), kMostFrames);
    RecordedFrame frame;
    const auto readOne = [&](uint64_t number) {
      try {
        recording.read(number, frame);
      } catch (const Error&) {
        return;
      }
      if (!isSoundFrame(frame) || frame.record.number != number) std::abort();
      ++read;
    };
    for (uint64_t i = 0; i < frames; ++i) readOne(i);
    for (uint64_t i = frames; i-- > 0;) readOne(i);
    for (const double part : {-1.0, 0.0, 0.5, 1.0, 2.0}) {
      const uint64_t number = recording.frameAt(part * recording.seconds());
      if (recording.frames() > 0 && number >= recording.frames()) std::abort();
      readOne(number);
    }
  } catch (const Error&) {
  }
  return read;
}

}  // namespace strandcast
