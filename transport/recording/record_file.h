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
  kHead = 1,    ///< what the file is and how to read it
  kGroom = 2,   ///< GroomChunk
  kBody = 3,    ///< BodyChunk
  kInput = 4,   ///< Command that was obeyed before the frame that follows
  kFrame = 5,   ///< number, time and hash of a frame
  kGuides = 6,  ///< GuideChunk of the frame before it
  kIndex = 7,   ///< where the frames since the last index or groom begin
  kEnd = 8,     ///< where the last index is
  kGrids = 9    ///< some layers of the air around the frame before it
};

inline constexpr char kRecordingMagic[8] = {'S', 'T', 'R', 'N', 'D', 'R', 'E', 'C'};
inline constexpr uint64_t kRecordHeadBytes = 16;       ///< kind, length, hash
inline constexpr uint32_t kMaxRecordBytes = 4u << 20;  ///< behind its head

/// Writes records one behind the other.
class RecordWriter {
 public:
  /// Throws Error when the file cannot be made, or another program writes or reads it. An old one is emptied.
  explicit RecordWriter(const std::filesystem::path& file);
  /// Throws Error where the constructor would, as far as can be known while the file stays as it is.
  static void check(const std::filesystem::path& file);
  /// Where the record begins. Throws Error when it cannot be written.
  uint64_t write(RecordKind kind, std::span<const uint8_t> bytes);
  /// Hands everything to the system, behind the last record of a frame. Throws Error.
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

/// The bytes of a recording, wherever they are.
class RecordingBytes {
 public:
  virtual ~RecordingBytes() = default;
  virtual uint64_t size() const = 0;
  /// False when they cannot be read. The caller asks only for bytes within size().
  virtual bool read(uint64_t offset, std::span<uint8_t> to) = 0;
};
/// Throws Error when the file cannot be opened. While it is open no RecordWriter empties it; one that writes
/// it already goes on, and what it adds is not seen. After that one's end it is kept from the next read on.
std::unique_ptr<RecordingBytes> openRecordingFile(const std::filesystem::path& file);

/// Reads one record at a time; its memory is that of the largest record.
class RecordReader {
 public:
  explicit RecordReader(std::unique_ptr<RecordingBytes> bytes) : bytes_(std::move(bytes)) {}
  struct Record {
    RecordKind kind = RecordKind::kEnd;
    std::span<const uint8_t> bytes;  ///< until the next read
    uint64_t next = 0;               ///< where the next record begins
  };
  uint64_t size() const { return bytes_->size(); }
  bool startsWithMagic();
  /// False where there is no whole and undamaged record.
  bool read(uint64_t offset, Record& record);
  /// Kind and place of the next one alone: the bytes are neither read nor checked.
  bool skim(uint64_t offset, Record& record);

 private:
  std::unique_ptr<RecordingBytes> bytes_;
  std::vector<uint8_t> buffer_;
  uint32_t length_ = 0;  // of the record that was skimmed last, and its hash
  uint64_t hash_ = 0;
};

}  // namespace strandcast
