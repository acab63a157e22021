#include "transport/recording/record_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "core/hash.h"
#include "transport/message_bytes.h"

namespace strandcast {
namespace {

uint64_t recordHash(RecordKind kind, std::span<const uint8_t> bytes) {
  ContentHash hash;
  uint8_t kind_bytes[4];
  storeBigEndian(kind, kind_bytes);
  hash.add(kind_bytes, sizeof kind_bytes);
  hash.add(bytes.data(), bytes.size());
  return hash.value();
}

bool isFile(int file) {
  struct stat about {};
  return fstat(file, &about) == 0 && S_ISREG(about.st_mode);
}

class FileBytes final : public RecordingBytes {
 public:
  explicit FileBytes(const std::filesystem::path& file) : file_(open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
    struct stat about {};
    if (file_ < 0 || fstat(file_, &about) != 0 || !S_ISREG(about.st_mode)) {
      const std::string cause = file_ < 0 ? std::strerror(errno) : "not a file";
      if (file_ >= 0) close(file_);
      throw Error("the recording cannot be read (" + cause + ")", file.string(), "check its path");
    }
    size_ = static_cast<uint64_t>(about.st_size);
    keep();
  }
  ~FileBytes() override { close(file_); }
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  uint64_t size() const override { return size_; }
  bool read(uint64_t offset, std::span<uint8_t> to) override {
    keep();
    while (!to.empty()) {
      const ssize_t got = pread(file_, to.data(), to.size(), static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      offset += static_cast<uint64_t>(got);
      to = to.subspan(static_cast<size_t>(got));
    }
    return true;
  }

 private:
  /// Locks the file so that no writer truncates it. A writer in progress has the lock and only appends; the
  /// lock is taken once that has ended.
  void keep() { is_kept_ = is_kept_ || flock(file_, LOCK_SH | LOCK_NB) == 0; }

  const int file_;
  uint64_t size_ = 0;
  bool is_kept_ = false;
};

[[noreturn]] void failToMake(const std::string& name, int cause) {
  throw Error(std::string("the recording cannot be made (") + std::strerror(cause) + ")", name,
              "check its folder");
}

/// Throws Error where another program has the file open. File systems without locks are accepted.
void lock(int file, const std::string& name) {
  if (!isFile(file) || flock(file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  close(file);
  throw Error("the recording cannot be made: another program writes or reads it", name,
              "wait until it has ended, or name another file");
}

/// Truncates an existing file after taking its lock.
std::FILE* emptied(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) failToMake(path.string(), errno);
  lock(file, path.string());
  if (isFile(file) && ftruncate(file, 0) != 0) {
    const int cause = errno;
    close(file);
    failToMake(path.string(), cause);
  }
  return fdopen(file, "wb");
}

}  // namespace

RecordWriter::RecordWriter(const std::filesystem::path& file) : name_(file.string()), file_(emptied(file)) {
  if (!file_) failToMake(name_, errno);
  std::setvbuf(file_.get(), nullptr, _IOFBF, 1 << 18);
  put(kRecordingMagic, sizeof kRecordingMagic);
}

void RecordWriter::check(const std::filesystem::path& file) {
  std::error_code unknown;
  if (std::filesystem::is_directory(file, unknown)) failToMake(file.string(), EISDIR);
  const bool is_there = std::filesystem::exists(file, unknown);
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (::access(is_there ? file.c_str() : folder.c_str(), W_OK) != 0) failToMake(file.string(), errno);
  if (!std::filesystem::is_regular_file(file, unknown)) return;
  const int old = open(file.c_str(), O_WRONLY | O_CLOEXEC);
  if (old < 0) failToMake(file.string(), errno);
  lock(old, file.string());
  close(old);
}

void RecordWriter::fail() const {
  throw Error(std::string("the recording cannot be written (") + std::strerror(errno) + ")", name_,
              has_whole_frame_ ? "is the disk full? What was written up to here can be replayed"
                               : "is the disk full? It holds no frame yet");
}

void RecordWriter::put(const void* data, size_t bytes) {
  if (bytes > 0 && std::fwrite(data, 1, bytes, file_.get()) != bytes) fail();
  size_ += bytes;
}

uint64_t RecordWriter::write(RecordKind kind, std::span<const uint8_t> bytes) {
  if (bytes.size() > kMaxRecordBytes)
    throw Error("a record would be larger than 4 MiB", name_, "is the configuration that large?");
  const uint64_t offset = size_;
  uint8_t head[kRecordHeadBytes];
  storeBigEndian(kind, head);
  storeBigEndian(static_cast<uint32_t>(bytes.size()), head + 4);
  storeBigEndian(recordHash(kind, bytes), head + 8);
  put(head, sizeof head);
  put(bytes.data(), bytes.size());
  has_frame_ = has_frame_ || kind == RecordKind::kFrame;
  return offset;
}

void RecordWriter::flush() {
  if (std::fflush(file_.get()) != 0) fail();
  has_whole_frame_ = has_frame_;
}

std::unique_ptr<RecordingBytes> openRecordingFile(const std::filesystem::path& file) {
  return std::make_unique<FileBytes>(file);
}

bool RecordReader::startsWithMagic() {
  uint8_t magic[sizeof kRecordingMagic];
  return size() >= sizeof magic && bytes_->read(0, magic) &&
         std::memcmp(magic, kRecordingMagic, sizeof magic) == 0;
}

bool RecordReader::skim(uint64_t offset, Record& record) {
  uint8_t head[kRecordHeadBytes];
  if (offset > size() || size() - offset < sizeof head || !bytes_->read(offset, head)) return false;
  record.kind = loadBigEndian<RecordKind>(head);
  length_ = loadBigEndian<uint32_t>(head + 4);
  hash_ = loadBigEndian<uint64_t>(head + 8);
  record.bytes = {};
  record.next = offset + sizeof head + length_;
  return length_ <= kMaxRecordBytes && record.next <= size();
}

bool RecordReader::read(uint64_t offset, Record& record) {
  if (!skim(offset, record)) return false;
  buffer_.resize(length_);
  if (!bytes_->read(offset + kRecordHeadBytes, buffer_)) return false;
  record.bytes = buffer_;
  return recordHash(record.kind, record.bytes) == hash_;
}

}  // namespace strandcast
