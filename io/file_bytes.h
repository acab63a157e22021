// Whole files as bytes: reading, also confined to a folder, and atomic writing.
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace strandcast {

/// Reads a whole regular file. Throws Error when it is missing, a directory, a pipe or device, unreadable,
/// empty or larger than 4 GiB (the formats' offsets have 32 bits).
std::vector<std::byte> readFileBytes(const std::filesystem::path& file);

/// As readFileBytes(), for a regular file already open for reading. `file` names it in errors.
std::vector<std::byte> readOpenFile(int descriptor, const std::filesystem::path& file);

/// The bytes of a text file as characters, without a UTF-8 byte-order mark.
std::string_view textOfFile(std::span<const std::byte> bytes);
/// As above, and without zero bytes at the end: some programs pad a file with them. Throws Error, naming
/// `name`, when the text is UTF-16.
std::string_view textOfFile(std::span<const std::byte> bytes, const std::string& name);

/// Finds where the line that starts at `begin` ends, and where the next line starts. A line ends with "\n",
/// "\r\n", "\r" alone, "\r\r\n" (a file converted twice), or the end of the text.
struct LineEnd {
  size_t end, next;
};
LineEnd lineEnd(std::string_view text, size_t begin);

/// Replaces `file` with `bytes`. The replacement is atomic for concurrent readers and writers where `file` is
/// a regular file in a writable folder. A link, pipe or device is written through. Throws Error when the file
/// cannot be opened or written in full.
void writeFileBytes(const std::filesystem::path& file, std::span<const std::byte> bytes);

/// Throws Error when the folder is missing or the file cannot be written. For callers that work long before
/// they write.
void checkWritable(const std::filesystem::path& file);

/// The extension with its dot, in lower case.
std::string lowerExtension(const std::filesystem::path& file);

/// Reads a whole regular file, as readFileBytes(), by a path relative to `folder` and confined to it. Links
/// are followed while they stay below `folder`. An absolute link, a link that leads above `folder` (in any
/// part of the path) and a path with `..` are refused. The file that is read is the one that was checked,
/// even if another process replaces folders by links meanwhile. Hard links count as ordinary files. Throws
/// Error, which names `relative` and does not disclose the location of `folder`.
std::vector<std::byte> readBeneath(const std::filesystem::path& folder,
                                   const std::filesystem::path& relative);

/// Throws Error where readBeneath() would not open the file. The error calls the folder `folder_name` and
/// names `where`.
void checkBeneath(const std::filesystem::path& folder, const std::filesystem::path& relative,
                  const std::string& folder_name, const std::string& where);

}  // namespace strandcast
