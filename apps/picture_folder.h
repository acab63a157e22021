#pragma once
#include <filesystem>

#include "apps/output_folder.h"
#include "render/image.h"

namespace strandcast {

/// Numbered pictures in one folder: frame_0000.png and on. Those of an earlier run do not stay beside them:
/// the first picture that is written takes the place of all of them, and a line tells how many went. Files of
/// other names stay as they are.
class PictureFolder {
 public:
  /// Makes the folder, as OutputFolder. Throws Error.
  explicit PictureFolder(const std::filesystem::path& folder) : folder_(folder), made_(folder) {}
  /// The next picture. Throws Error where it cannot be written.
  void write(const Image& picture);
  int written() const { return written_; }
  /// "out/frame_*.png"
  std::string pattern() const { return (folder_ / "frame_*.png").string(); }

 private:
  void removeEarlier() const;

  const std::filesystem::path folder_;
  const OutputFolder made_;
  int written_ = 0;
};

/// Of the picture with this number.
std::filesystem::path picturePath(const std::filesystem::path& folder, int number);
/// Whether a file in a folder of pictures is one by its name, as picturePath() gives it.
bool isPictureName(const std::string& name);

/// Throws Error where makeMovie() could not make this film: ffmpeg is not installed, its folder cannot be
/// written to, or ffmpeg makes no film of this extension. For what takes long to draw: it makes a film of one
/// small picture and removes it, which takes about a tenth of a second.
void checkMovie(const std::filesystem::path& movie);
/// Joins the first so many pictures of `folder` into a film of `fps` of them a second; needs ffmpeg,
/// installed apart. An interrupt while it runs ends ffmpeg too, and then
/// there is no film of them; what `movie` was before stays until a whole one takes its place. Throws Error.
void makeMovie(const std::filesystem::path& folder, int pictures, double fps,
               const std::filesystem::path& movie);

}  // namespace strandcast
