#pragma once
#include <filesystem>
#include <string>

namespace strandcast {

/// Empty where there is no such file.
std::string textOf(const std::filesystem::path& file);
/// Throws Error.
void writeText(const std::filesystem::path& file, const std::string& text);

}  // namespace strandcast
