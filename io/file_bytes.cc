#include "io/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

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
  const std::filesystem::path part = file.string() + "." + std::to_string(::getpid());
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

}  // namespace strandcast
