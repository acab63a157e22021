#pragma once
#include <filesystem>

namespace strandcast {

/// Numbered pictures in one folder: frame_0000.png and on.
std::filesystem::path picturePath(const std::filesystem::path& folder, int number);
/// Joins the first so many pictures of `folder` into a film of `fps` of them a second; needs ffmpeg,
/// installed apart. Older ones may lie behind them. An interrupt while it runs ends ffmpeg too, and then
/// there is no film of them; what `movie` was before stays until a whole one takes its place. Throws Error.
void makeMovie(const std::filesystem::path& folder, int pictures, double fps,
               const std::filesystem::path& movie);

}  // namespace strandcast
