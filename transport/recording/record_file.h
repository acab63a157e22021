#pragma once
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace strandcast {

/// The records that a recording is made of: docs/wire.md, "Recordings".
enum class RecordKind : uint32_t {
  kHead = 1,    ///< head: version and how to read the file
  kGroom = 2,   ///< GroomChunk
  kBody = 3,    ///< BodyChunk
  kInput = 4,   ///< Command that was executed before the frame that follows
  kFrame = 5,   ///< number, time and hash of a frame
  kGuides = 6,  ///< GuideChunk of the frame before it
  kIndex = 7,   ///< offsets of the frames since the last index or groom
  kEnd = 8,     ///< offset of the last index
  kGrids = 9    ///< some layers of the air around the frame before it
};

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
