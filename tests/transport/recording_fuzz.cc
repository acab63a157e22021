#include "recording_fuzz.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "bound_hairs.h"
#include "core/error.h"
#include "core/hash.h"
#include "tests/io/scratch_folder.h"
#include "transport/codec/hair_codec.h"
#include "transport/message_bytes.h"
#include "transport/pose_inbox.h"
#include "transport/recording/recorder.h"
#include "transport/recording/recording.h"

namespace strandcast {
namespace {

constexpr uint64_t kMaxFrames = 64;  // read of one file: enough to reach every path quickly

/// Hairs that a receiver would refuse end the program.
bool isSoundFrame(const RecordedFrame& read) noexcept {
  if (!read.groom || !read.body || !read.frame) return false;
  if (read.hairs) checkHairs(*read.hairs, read.groom->guides, "fuzz");
  const GroomDescription& groom = *read.groom;
  // A reader waits for hairs that the growth names.
  const bool is_complete = read.hairs || (groom.growth & GroomDescription::kHairs) == 0;
  return is_complete && groom.growth >= 1 && groom.growth < 8 && !(read.hairs && read.damage.hairs) &&
         (groom.seeded.empty() || groom.seeded.size() == groom.guides.strands()) &&
         read.frame->positions.size() == read.groom->guides.vertices() &&
         std::all_of(read.poses.begin(), read.poses.end(),
                     [](const StepPoses& step) { return isSound(step.poses); }) &&
         std::all_of(read.frame->positions.begin(), read.frame->positions.end(),
                     [](const Vec3& position) { return position.allFinite(); });
}

}  // namespace

AirGrids sampleGrids(uint64_t frame, uint32_t cells, bool has_wind) {
  AirGrids grids;
  grids.cells = cells;
  grids.origin = Vec3(-0.1f, 1, 0.25f);
  grids.cell = 0.4f / static_cast<float>(cells);
  for (size_t which = 0; which < (has_wind ? kGridValues : 1); ++which)
    for (uint32_t cell = 0; cell < cells * cells * cells; ++cell) {
      const auto x = static_cast<float>(cell % cells), z = static_cast<float>(cell / (cells * cells));
      if (cell / cells % cells != 3) {  // most values are 0, so that seeds stay small
        grids.values[which].push_back(0);
        continue;
      }
      const float wave = std::sin(0.3f * x + static_cast<float>(which)) * (z + static_cast<float>(frame));
      grids.values[which].push_back(which == static_cast<size_t>(GridValue::kSolid) ? float(wave > 5) : wave);
    }
  return grids;
}

bool RecordingInMemory::read(uint64_t offset, std::span<uint8_t> to) {
  if (offset > bytes_.size() || to.size() > bytes_.size() - offset) std::abort();  // precondition of read()
  std::copy_n(bytes_.begin() + static_cast<ptrdiff_t>(offset), to.size(),
              to.begin());  // an empty record is valid
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
    const uint64_t frames = std::min(recording.frames(), kMaxFrames);
    RecordedFrame frame;
    AirGrids grids;
    const auto readGrids = [&](uint64_t number) {
      try {
        if (recording.readGrids(number, grids) && !isSound(grids)) std::abort();
      } catch (const Error&) {
      }
    };
    const auto readOne = [&](uint64_t number) {
      try {
        recording.read(number, frame);
      } catch (const Error&) {
        return;
      }
      if (!isSoundFrame(frame) || frame.record.number != number) std::abort();
      ++read;
    };
    for (uint64_t i = 0; i < frames; ++i) {
      readOne(i);
      readGrids(i);
    }
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

namespace {

StepPoses headOf(uint64_t step) {
  StepPoses out;
  out.step = step;
  out.is_cut = step == 0;
  out.poses.source = 5;
  out.poses.time = 16'666'667 * step;
  out.poses.names = "head joint:arm";
  out.poses.ages = {0};
  for (const float x : {0.01f, 0.02f})
    for (const float value : {x, 1.5f, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f}) out.poses.poses.push_back(value);
  return out;
}

}  // namespace

std::vector<FuzzSeeds> recordingSeeds() {
  const ScratchFolder folder;
  std::vector<FuzzSeeds> seeds;
  for (const CodecInfo& info : codecList()) {
    const std::filesystem::path file = folder / "a.rec";
    RecordingOptions options;
    options.codec.codec = info.codec;
    options.source = "how it was made";
    Recorder recorder(file, options);
    for (const uint64_t session : {11, 12}) {
      GroomDescription groom = hairGroom(14, [](size_t s) { return 2 + s % 5; });
      groom.session = session;
      if (session == 11) groom.growth |= GroomDescription::kHairs;
      recorder.setGroom(groom, sampleBody(4));
      if (session == 11)
        recorder.setHairs(boundHairs(
            groom.guides, 10, [](size_t h) { return 2 + h % 5; }, true));
      for (uint64_t number = 1; number <= 5; ++number) {
        if (number == 3) recorder.addInput({1, 33, CommandKind::kSetParameter, "wind", {1, 2, 3}});
        if (number > 3) recorder.addPoses(headOf(number - 4));
        recorder.addFrame(hairFrame(groom, number));
        if (number % 2 == 0) recorder.addGrids(sampleGrids(number, 16, number == 4));
      }
    }
    recorder.close();
    std::ifstream stream(file, std::ios::binary);
    std::vector<uint8_t> input = {1};  // selects repaired hashes
    input.insert(input.end(), std::istreambuf_iterator<char>(stream), {});
    seeds.push_back({info.name, {std::move(input)}});
  }
  return seeds;
}

}  // namespace strandcast
