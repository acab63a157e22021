#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace strandcast {

/// Version 1 has guide chunks of version 3 of the wire, without colliders, version 2 of version 5, without
/// their bends.
inline constexpr uint32_t kRecordingVersion = 3;
/// Frames that one index holds at most.
inline constexpr size_t kIndexFrames = 1024;

/// What stands at the head of a recording.
struct RecordingHead {
  uint32_t version = kRecordingVersion;
  uint32_t groom_id = 0;
  float max_error = 0;  ///< m, of the positions in it; 0 = exact
  std::string codec;    ///< as of codecList()
  std::string layout;   ///< how to read the file, for people
  std::string source;   ///< what resimulates it: the program's own text; empty where it cannot be
};

/// What stands before a frame's guides.
struct FrameRecord {
  uint64_t number = 0;      ///< from 0 in this file
  double time = 0;          ///< s of simulation since the start of the file, never falling
  uint64_t state_hash = 0;  ///< positionsHash() of what was recorded, before it was encoded
  uint32_t chunks = 0;      ///< that follow
};

/// Where frames first_number and on begin: up to kIndexFrames of one groom.
struct IndexRecord {
  uint64_t previous = 0;  ///< where the index before this one is; 0 = none
  uint64_t groom = 0;     ///< where the groom in force begins
  uint64_t first_number = 0;
  std::vector<uint64_t> offsets;  ///< of each frame's first input, or of its kFrame
  std::vector<double> times;      ///< s
};

struct EndRecord {
  uint64_t index = 0;  ///< where the last one is; 0 = no frames
  uint64_t frames = 0;
};

/// Some layers of the air around a frame: air_grids.h.
struct GridRecord {
  uint64_t number = 0;            ///< of the frame
  uint32_t cells = 0;             ///< per axis
  std::array<float, 3> origin{};  ///< m
  float cell = 0;                 ///< m
  uint32_t first_layer = 0;       ///< along z
  uint32_t values = 0;            ///< a bit for each GridValue that is there
  std::vector<float> units;       ///< of each that is there
  std::vector<uint8_t> packed;
};

// Once for MessageWriter and MessageReader.

template <class Stream>
void recordFields(Stream& s, auto& m, std::type_identity<RecordingHead>) {
  s.number(m.version);
  s.number(m.groom_id);
  s.number(m.max_error);
  s.text(m.codec);
  s.text(m.layout);
  s.text(m.source);
}

template <class Stream>
void recordFields(Stream& s, auto& m, std::type_identity<FrameRecord>) {
  s.number(m.number);
  s.number(m.time);
  s.number(m.state_hash);
  s.number(m.chunks);
}

template <class Stream>
void recordFields(Stream& s, auto& m, std::type_identity<IndexRecord>) {
  s.number(m.previous);
  s.number(m.groom);
  s.number(m.first_number);
  s.array(m.offsets);
  s.array(m.times);
}

template <class Stream>
void recordFields(Stream& s, auto& m, std::type_identity<EndRecord>) {
  s.number(m.index);
  s.number(m.frames);
}

template <class Stream>
void recordFields(Stream& s, auto& m, std::type_identity<GridRecord>) {
  s.number(m.number);
  s.number(m.cells);
  s.items(m.origin);
  s.number(m.cell);
  s.number(m.first_layer);
  s.number(m.values);
  s.array(m.units);
  s.array(m.packed);
}

}  // namespace strandcast
