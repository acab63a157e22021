#include "io/file_bytes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <deque>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "core/error.h"

namespace strandcast {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{1} << 32;

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

uint64_t regularFileSize(const std::filesystem::path& file) {
  std::error_code failure;
  const std::filesystem::file_status status = std::filesystem::status(file, failure);
  if (!std::filesystem::exists(status))
    throw Error("the file cannot be found", file.string() + ", byte 0", "check the path");
  if (std::filesystem::is_directory(status))
    throw Error("this is a directory", file.string() + ", byte 0", "name a file in it");
  if (!std::filesystem::is_regular_file(status))
    throw Error("this is not a regular file", file.string() + ", byte 0", "copy it into a file first");
  const uint64_t size = std::filesystem::file_size(file, failure);
  if (failure) throw Error("the file cannot be read", file.string() + ", byte 0", failure.message());
  return size;
}

/// Throws Error, which names `file`, when `into` cannot be opened or written in full.
void write(const std::filesystem::path& into, std::span<const std::byte> bytes,
           const std::filesystem::path& file) {
  File stream(std::fopen(into.c_str(), "wb"), &std::fclose);
  if (!stream)
    throw Error("the file cannot be written", file.string(),
                std::string(std::strerror(errno)) + ", check the folder and its permissions");
  const size_t put = std::fwrite(bytes.data(), 1, bytes.size(), stream.get());
  const bool closed = std::fclose(stream.release()) == 0;
  if (put != bytes.size() || !closed)
    throw Error("the file cannot be written in full", file.string() + ", byte " + std::to_string(put),
                "check the free space of the disk");
}

bool isWritable(const std::filesystem::path& path) { return ::access(path.c_str(), W_OK) == 0; }

std::filesystem::path folderOf(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

/// False for links, pipes and devices, which are written through, and for write-protected files, which stay.
bool mayBeReplaced(const std::filesystem::path& file) {
  std::error_code failure;
  const std::filesystem::file_status status = std::filesystem::symlink_status(file, failure);
  const bool is_own = std::filesystem::is_regular_file(status) &&
                      std::filesystem::hard_link_count(file, failure) == 1 && isWritable(file);
  return (is_own || !std::filesystem::exists(status)) && isWritable(folderOf(file));
}

void checkSize(uint64_t size, const std::filesystem::path& file) {
  if (size == 0) throw Error("the file is empty", file.string() + ", byte 0", "export or copy it again");
  if (size > kMaxFileBytes)
    throw Error("the file is larger than 4 GiB", file.string() + ", byte 0", "split it into several files");
}

std::vector<std::byte> readWhole(std::FILE* stream, uint64_t size, const std::filesystem::path& file) {
  std::vector<std::byte> bytes(size);
  const size_t got = std::fread(bytes.data(), 1, bytes.size(), stream);
  if (got != bytes.size())
    throw Error("the file cannot be read to its end", file.string() + ", byte " + std::to_string(got),
                "check the disk, or whether another program is writing it");
  return bytes;
}

}  // namespace

std::vector<std::byte> readFileBytes(const std::filesystem::path& file) {
  const uint64_t size = regularFileSize(file);
  checkSize(size, file);
  const File stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!stream)
    throw Error("the file cannot be opened", file.string() + ", byte 0",
                std::string(std::strerror(errno)) + ", check its permissions");
  return readWhole(stream.get(), size, file);
}

std::vector<std::byte> readOpenFile(int descriptor, const std::filesystem::path& file) {
  struct stat status {};
  const int own = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
  const File stream(own >= 0 ? ::fdopen(own, "rb") : nullptr, &std::fclose);
  if (!stream || ::fstat(descriptor, &status) != 0)
    throw Error("the file cannot be opened", file.string() + ", byte 0", std::strerror(errno));
  const auto size = static_cast<uint64_t>(status.st_size);
  checkSize(size, file);
  return readWhole(stream.get(), size, file);
}

std::string_view textOfFile(std::span<const std::byte> bytes) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

namespace {

/// iconv's name of the encoding if a text is UTF-16, else null. Detected by the byte-order mark, or by zero
/// bytes in the first few characters.
const char* wideEncodingOf(std::string_view text) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) return "UTF-16";
  constexpr size_t kLooks = 8;  // bytes
  if (text.size() < 2 || (text[0] == 0) == (text[1] == 0)) return nullptr;
  for (size_t i = 2; i < std::min(kLooks, text.size()); ++i)
    if ((text[i] == 0) != (text[i % 2] == 0)) return nullptr;
  return text[0] == 0 ? "UTF-16BE" : "UTF-16LE";
}

}  // namespace

std::string_view textOfFile(std::span<const std::byte> bytes, const std::string& name) {
  std::string_view text = textOfFile(bytes);
  if (const char* encoding = wideEncodingOf(text))
    throw Error("the text is UTF-16", name + ", byte 0",
                std::string("save it as UTF-8: iconv -f ") + encoding + " -t UTF-8 FILE > COPY");
  while (text.ends_with('\0')) text.remove_suffix(1);
  return text;
}

LineEnd lineEnd(std::string_view text, size_t begin) {
  size_t end = begin;
  while (end < text.size() && text[end] != '\n' && text[end] != '\r') ++end;
  const std::string_view rest = text.substr(end);
  for (const std::string_view mark : {"\r\r\n", "\r\n", "\n", "\r"})
    if (rest.starts_with(mark)) return {end, end + mark.size()};
  return {end, end};
}

void writeFileBytes(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  if (!mayBeReplaced(file)) return write(file, bytes, file);
  // Daemons of one process may write one file at once: a field of the cache.
  static std::atomic<unsigned> newest{0};
  const std::filesystem::path part = fmt::format("{}.{}.{}", file.string(), ::getpid(), newest.fetch_add(1));
  std::error_code failure, ignored;
  try {
    write(part, bytes, file);
  } catch (const Error&) {
    std::filesystem::remove(part, ignored);
    throw;
  }
  const std::filesystem::file_status old = std::filesystem::status(file, ignored);
  if (std::filesystem::exists(old)) std::filesystem::permissions(part, old.permissions(), ignored);
  std::filesystem::rename(part, file, failure);
  if (!failure) return;
  std::filesystem::remove(part, ignored);
  write(file, bytes, file);  // rename() fails on a mount point, for example
}

void checkWritable(const std::filesystem::path& file) {
  std::error_code failure;
  const std::filesystem::path folder = folderOf(file);
  const bool exists = std::filesystem::exists(file, failure);
  if (std::filesystem::is_directory(folder, failure) && !std::filesystem::is_directory(file, failure) &&
      isWritable(exists ? file : folder))
    return;
  throw Error("the file cannot be written", file.string(),
              "name a file in a folder that is there and may be written to");
}

std::string lowerExtension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); });
  return extension;
}

namespace {

class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int number() const { return number_; }
  bool isOpen() const { return number_ >= 0; }

 private:
  int number_;
};

/// Resolves a path below a folder component by component. Each folder is opened relative to the previous one
/// without following links; links are resolved here. No name is looked up again after its check. (The
/// kernel's openat2 with RESOLVE_BENEATH does the same, but is missing in older kernels and many containers.)
class ConfinedPath {
 public:
  ConfinedPath(const std::filesystem::path& folder, const std::filesystem::path& relative,
               const std::string& folder_name, const std::string& where)
      : name_(fmt::format("'{}'", relative.c_str())), folder_name_(folder_name), where_(where) {
    if (relative.empty() || relative.is_absolute() || relative.native().find('\0') != std::string::npos ||
        std::find(relative.begin(), relative.end(), "..") != relative.end())
      throw Error(name_ + " is no name within " + folder_name_, where_,
                  "give one without .. or a / in front");
    folders_.emplace_back(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (!folders_.back().isOpen())
      throw Error(folder_name_ + " cannot be read", where_,
                  fmt::format("is it there? {}", std::strerror(errno)));
    prepend(relative);
  }

  /// Opens the file at the end of the path, which must be regular.
  Descriptor open() {
    while (!steps_.empty()) {
      const std::string step = std::move(steps_.front());
      steps_.pop_front();
      if (step.empty() || step == ".") continue;
      if (step == "..") {
        if (folders_.size() == 1) leadsOut();
        folders_.pop_back();
      } else if (!followLink(step)) {
        if (std::all_of(steps_.begin(), steps_.end(), [](const std::string& s) { return s.empty(); }))
          return openFile(step);
        enter(step);
      }
    }
    throw Error(name_ + " is a folder", where_, "name a file in it");
  }

 private:
  [[noreturn]] void leadsOut() const {
    throw Error(name_ + " is a link out of " + folder_name_, where_, "put the file itself in there");
  }
  [[noreturn]] void isNotThere(int error) const {
    throw Error(name_ + " is not in " + folder_name_, where_,
                fmt::format("{}; give the name of a file in there", std::strerror(error)));
  }
  int last() const { return folders_.back().number(); }
  void prepend(const std::filesystem::path& steps) {
    std::deque<std::string> all;
    for (const std::filesystem::path& step : steps) all.push_back(step.string());
    steps_.insert(steps_.begin(), all.begin(), all.end());
  }

  /// Returns whether `step` is a link. The components of its target then come first in `steps_`.
  bool followLink(const std::string& step) {
    constexpr int kMaxLinks = 40;  // the limit of Linux
    std::array<char, PATH_MAX> target;
    const ssize_t length = ::readlinkat(last(), step.c_str(), target.data(), target.size());
    if (length < 0) {
      if (errno == EINVAL) return false;  // it exists and is no link
      isNotThere(errno);
    }
    const std::filesystem::path to(std::string(target.data(), static_cast<size_t>(length)));
    if (to.is_absolute() || static_cast<size_t>(length) == target.size()) leadsOut();
    if (++links_ > kMaxLinks) isNotThere(ELOOP);
    prepend(to);
    return true;
  }

  void enter(const std::string& step) {
    Descriptor next(::openat(last(), step.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    if (!next.isOpen()) isNotThere(errno);
    folders_.push_back(std::move(next));
  }

  Descriptor openFile(const std::string& step) const {
    // O_NONBLOCK: opening a pipe would wait for a writer.
    Descriptor file(
        ::openat(last(), step.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    if (!file.isOpen()) isNotThere(errno);
    struct stat status {};
    if (::fstat(file.number(), &status) != 0) isNotThere(errno);
    if (!S_ISREG(status.st_mode))
      throw Error(name_ + " is not a regular file", where_, "name a file that is one");
    return file;
  }

  std::string name_, folder_name_, where_;
  std::vector<Descriptor> folders_;  ///< open folders, from the starting folder down to the current one
  std::deque<std::string> steps_;    ///< components still to be resolved
  int links_ = 0;
};

}  // namespace

std::vector<std::byte> readBeneath(const std::filesystem::path& folder,
                                   const std::filesystem::path& relative) {
  const Descriptor file = ConfinedPath(folder, relative, "its folder", relative.string()).open();
  return readOpenFile(file.number(), relative);
}

void checkBeneath(const std::filesystem::path& folder, const std::filesystem::path& relative,
                  const std::string& folder_name, const std::string& where) {
  (void)ConfinedPath(folder, relative, folder_name, where).open();
}

}  // namespace strandcast
