#pragma once
#include <filesystem>
#include <string>

namespace strandcast {

/// The content of a file; empty where there is no such file.
std::string textOf(const std::filesystem::path& file);
/// Writes a file. Throws Error.
void writeText(const std::filesystem::path& file, const std::string& text);

}  // namespace strandcast
