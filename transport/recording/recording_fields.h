#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace strandcast {

/// Recordings of version 1 have guide chunks of wire version 3, without colliders; those of version 2 have
/// chunks of wire version 5, without bends.
inline constexpr uint32_t kRecordingVersion = 3;
/// Frames per index, at most.
inline constexpr size_t kIndexFrames = 1024;

/// The first record of a recording.
struct RecordingHead {
  uint32_t version = kRecordingVersion;
  uint32_t groom_id = 0;
  float max_error = 0;  ///< m, bound on the error of positions; 0 = exact
  std::string codec;    ///< as of codecList()
  std::string layout;   ///< how to read the file, for people
  /// Input of resimulation: the program's own text; empty where it cannot be resimulated
  std::string source;
};

/// The record before a frame's guides.
struct FrameRecord {
  uint64_t number = 0;      ///< from 0 in this file
  double time = 0;          ///< simulation time since the start of the file, s; never decreases
  uint64_t state_hash = 0;  ///< positionsHash() of the positions before encoding
  uint32_t chunks = 0;      ///< number of guide chunks that follow
};

/// Offsets of the frames from first_number on: up to kIndexFrames of one groom.
struct IndexRecord {
  uint64_t previous = 0;  ///< offset of the index before this one; 0 = none
  uint64_t groom = 0;     ///< offset of the current groom
  uint64_t first_number = 0;
  std::vector<uint64_t> offsets;  ///< of each frame's first input, or of its kFrame
  std::vector<double> times;      ///< s
};

/// The last record of a recording that was closed.
struct EndRecord {
  uint64_t index = 0;  ///< offset of the last index; 0 = no frames
  uint64_t frames = 0;
};

/// Some layers of the air around a frame: air_grids.h.
struct GridRecord {
  uint64_t number = 0;            ///< of the frame
  uint32_t cells = 0;             ///< per axis
  std::array<float, 3> origin{};  ///< m
  float cell = 0;                 ///< m
  uint32_t first_layer = 0;       ///< along z
  uint32_t values = 0;            ///< a bit for each GridValue present
  std::vector<float> units;       ///< per GridValue present
  std::vector<uint8_t> packed;
};

// Fields, once for MessageWriter and MessageReader.

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
