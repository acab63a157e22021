#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace strandcast {

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
