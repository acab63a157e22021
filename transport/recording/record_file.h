// The records of a recording: their kinds and fields, and the file that frames them.
#pragma once
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace strandcast {

/// Messages of wire version 7. Older recordings: old_messages.h.
inline constexpr uint32_t kRecordingVersion = 4;
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
  uint64_t materials = 0;   ///< offset of the newest light materials; 0 = none: nothing writes them yet
  uint64_t lights = 0;      ///< likewise of the lights
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

/// What live sources move from here on: PoseSamples::names and weight_names.
struct PoseNamesRecord {
  std::string names, weight_names;
};

/// The poses that live sources gave to a step, as it took them: StepPoses.
struct PosesRecord {
  uint64_t names = 0;  ///< offset of the PoseNamesRecord
  uint64_t step = 0;   ///< steps of the simulation before it
  uint32_t flags = 0;  ///< 1: a cut
  uint64_t source = 0, time = 0;
  std::vector<float> poses, scales, weights;  ///< as in PoseSamples, of one sample
};
inline constexpr uint32_t kCutFlag = 1;
inline constexpr size_t kMaxPosesPerFrame = 4096;  ///< PosesRecords before a frame

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
  s.number(m.materials);
  s.number(m.lights);
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

template <class Stream>
void recordFields(Stream& s, auto& m, std::type_identity<PoseNamesRecord>) {
  s.text(m.names);
  s.text(m.weight_names);
}

template <class Stream>
void recordFields(Stream& s, auto& m, std::type_identity<PosesRecord>) {
  s.number(m.names);
  s.number(m.step);
  s.number(m.flags);
  s.number(m.source);
  s.number(m.time);
  s.array(m.poses);
  s.array(m.scales);
  s.array(m.weights);
}

/// The records that a recording is made of: docs/wire.md, "Recordings".
enum class RecordKind : uint32_t {
  kHead = 1,        ///< head: version and how to read the file
  kGroom = 2,       ///< GroomChunk
  kBody = 3,        ///< BodyChunk
  kInput = 4,       ///< Command that was executed before the frame that follows
  kFrame = 5,       ///< number, time and hash of a frame
  kGuides = 6,      ///< GuideChunk of the frame before it
  kIndex = 7,       ///< offsets of the frames since the last index or groom
  kEnd = 8,         ///< offset of the last index
  kGrids = 9,       ///< some layers of the air around the frame before it
  kHairs = 12,      ///< HairChunk, after the body of its groom
  kPoseNames = 14,  ///< PoseNamesRecord
  kPoses = 15       ///< PosesRecord of a step before the frame that follows
};
/// Whether the record may come between a frame and the one before: what the simulation was given.
constexpr bool isInput(RecordKind kind) {
  return kind == RecordKind::kInput || kind == RecordKind::kPoseNames || kind == RecordKind::kPoses;
}

inline constexpr char kRecordingMagic[8] = {'S', 'T', 'R', 'N', 'D', 'R', 'E', 'C'};
inline constexpr uint64_t kRecordHeadBytes = 16;       ///< kind, length, hash
inline constexpr uint32_t kMaxRecordBytes = 4u << 20;  ///< after the head of a record

/// Writes consecutive records.
class RecordWriter {
 public:
  /// Throws Error when the file cannot be created, or another program writes or reads it. Truncates an
  /// existing file.
  explicit RecordWriter(const std::filesystem::path& file);
  /// Throws Error where the constructor would, as far as can be determined without changing the file.
  static void check(const std::filesystem::path& file);
  /// Returns the offset of the record. Throws Error when it cannot be written.
  uint64_t write(RecordKind kind, std::span<const uint8_t> bytes);
  /// Flushes to the operating system; call after the last record of a frame. Throws Error.
  void flush();
  uint64_t size() const { return size_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void put(const void* data, size_t bytes);
  [[noreturn]] void fail() const;

  const std::string name_;
  std::unique_ptr<std::FILE, Close> file_;
  uint64_t size_ = 0;
  bool has_frame_ = false, has_whole_frame_ = false;  // written, and flushed
};

/// Random access to the bytes of a recording.
class RecordingBytes {
 public:
  virtual ~RecordingBytes() = default;
  virtual uint64_t size() const = 0;
  /// False on a read error. Precondition: the range is within size().
  virtual bool read(uint64_t offset, std::span<uint8_t> to) = 0;
};
/// Throws Error when the file cannot be opened. While it is open no RecordWriter truncates it. A RecordWriter
/// that has it open already continues; its additions are not seen. After that one ends, the lock is taken
/// with the next read.
std::unique_ptr<RecordingBytes> openRecordingFile(const std::filesystem::path& file);

/// Reads one record at a time; memory: the largest record.
class RecordReader {
 public:
  explicit RecordReader(std::unique_ptr<RecordingBytes> bytes) : bytes_(std::move(bytes)) {}
  struct Record {
    RecordKind kind = RecordKind::kEnd;
    std::span<const uint8_t> bytes;  ///< valid until the next read
    uint64_t next = 0;               ///< offset of the next record
  };
  uint64_t size() const { return bytes_->size(); }
  /// Whether the file begins with kRecordingMagic.
  bool startsWithMagic();
  /// False where there is no complete, undamaged record.
  bool read(uint64_t offset, Record& record);
  /// Reads only kind and length of the record: its bytes are neither read nor checked.
  bool skim(uint64_t offset, Record& record);

 private:
  std::unique_ptr<RecordingBytes> bytes_;
  std::vector<uint8_t> buffer_;
  uint32_t length_ = 0;  // of the record that skim() read last, with its hash
  uint64_t hash_ = 0;
};

}  // namespace strandcast
