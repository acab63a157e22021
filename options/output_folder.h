// Folders that programs write, and the numbered pictures and films in them.
#pragma once
#include <filesystem>
#include <vector>

#include "io/image.h"

namespace strandcast {

/// Creates a folder for output where it does not exist. The destructor removes a created folder that is still
/// empty.
class OutputFolder {
 public:
  /// Throws Error.
  explicit OutputFolder(const std::filesystem::path& folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

 private:
  std::vector<std::filesystem::path> made_;  // innermost first
};

/// Numbered pictures in one folder, from frame_0000.png on. The first picture written removes the pictures of
/// an earlier run and logs their number, unless they are kept. Files of other names are kept.
class PictureFolder {
 public:
  /// Creates the folder as OutputFolder does. Throws Error.
  explicit PictureFolder(const std::filesystem::path& folder, bool keeps_earlier = false)
      : folder_(folder), made_(folder), keeps_earlier_(keeps_earlier) {}
  /// Writes the next picture. Throws Error where that fails.
  void write(const Image& picture);
  /// Counts a picture that is there already.
  void skip() { ++written_; }
  int written() const { return written_; }
  /// "out/frame_*.png"
  std::string pattern() const { return (folder_ / "frame_*.png").string(); }

 private:
  void removeEarlier() const;

  const std::filesystem::path folder_;
  const OutputFolder made_;
  const bool keeps_earlier_;
  int written_ = 0;
};

/// The path of the picture with this number.
std::filesystem::path picturePath(const std::filesystem::path& folder, int number);
/// Whether a file name is that of a picture, as picturePath() gives it.
bool isPictureName(const std::string& name);

/// Throws Error where makeMovie() could not make this film: ffmpeg is not installed, the folder is not
/// writable, or ffmpeg does not support the extension. Call it before a long rendering. It encodes a film of
/// one small picture and removes it, which takes about a tenth of a second.
void checkMovie(const std::filesystem::path& movie);
/// Encodes the first `pictures` pictures of `folder` into a film at `fps` pictures per second; needs ffmpeg
/// on the PATH. An interrupt ends ffmpeg too and leaves no new film. An existing `movie` stays until a
/// complete film replaces it. Throws Error.
void makeMovie(const std::filesystem::path& folder, int pictures, double fps,
               const std::filesystem::path& movie);

}  // namespace strandcast
