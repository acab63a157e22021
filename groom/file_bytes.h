#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace strandcast {

/// A whole regular file. Throws Error when it is missing, a directory, a pipe or device, unreadable, empty or
/// larger than 4 GiB (the formats' offsets have 32 bits).
std::vector<std::byte> readFileBytes(const std::filesystem::path& file);

/// The same of a regular file that is open for reading; `file` names it in errors.
std::vector<std::byte> readOpenFile(int descriptor, const std::filesystem::path& file);

/// Those of a text file as characters, without the byte-order mark that UTF-8 may begin with.
std::string_view textOfFile(std::span<const std::byte> bytes);
/// The same without the zero bytes that some programs fill up a file's end with. Throws Error, naming `name`,
/// where the text is UTF-16.
std::string_view textOfFile(std::span<const std::byte> bytes, const std::string& name);

/// Where the line that starts at `begin` ends, and where the next one starts. "\n", "\r\n", "\r" alone and
/// the
/// "\r\r\n" of a file converted twice end a line; so does the end of the text.
struct LineEnd {
  size_t end, next;
};
LineEnd lineEnd(std::string_view text, size_t begin);

/// Replaces `file` with `bytes`: whole or not at all, whoever else writes or reads it, where it is a regular
/// file in a folder that can be written to; a link, pipe or device is written through. Throws Error when it
/// cannot be opened or written in full.
void writeFileBytes(const std::filesystem::path& file, std::span<const std::byte> bytes);

/// Throws Error where the folder is not there or the file cannot be written: for what takes long to make.
void checkWritable(const std::filesystem::path& file);

/// The extension with its dot, in lower case.
std::string lowerExtension(const std::filesystem::path& file);

}  // namespace strandcast
