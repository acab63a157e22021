#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace strandcast {

/// A whole regular file, as readFileBytes(), that lies beneath `folder` and is named relative to it. Links
/// are followed as long as they stay beneath it: one that is absolute or leads above the folder is refused,
/// in whatever part of the way it is, and so are names with `..` in them. The file that is read is the one
/// that was checked, also where somebody exchanges folders for links meanwhile. Hard links are files like
/// others. Throws Error, which names `relative` and not where the folder is.
std::vector<std::byte> readBeneath(const std::filesystem::path& folder,
                                   const std::filesystem::path& relative);

/// Throws Error where readBeneath() would not open it, which calls the folder `folder_name` and names
/// `where`.
void checkBeneath(const std::filesystem::path& folder, const std::filesystem::path& relative,
                  const std::string& folder_name, const std::string& where);

}  // namespace strandcast
