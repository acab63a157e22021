#include "apps/picture_folder.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/error.h"

namespace strandcast {

void makeFolder(const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw Error("the folder cannot be made", folder.string(), failed.message());
}

std::filesystem::path picturePath(const std::filesystem::path& folder, int number) {
  return folder / fmt::format("frame_{:04d}.png", number);
}

void makeMovie(const std::filesystem::path& folder, int pictures, double fps,
               const std::filesystem::path& movie) {
  const std::string pattern = (folder / "frame_%04d.png").string(), rate = fmt::format("{:g}", fps),
                    count = std::to_string(pictures);
  const pid_t child = fork();
  if (child == 0) {
    execlp("ffmpeg", "ffmpeg", "-y", "-loglevel", "error", "-framerate", rate.c_str(), "-i", pattern.c_str(),
           "-frames:v", count.c_str(), "-pix_fmt", "yuv420p", "-crf", "18", movie.c_str(),
           static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) < 0)
    throw Error("ffmpeg cannot be started", movie.string(), "");
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    throw Error("ffmpeg is not installed", movie.string(),
                "install it or leave out --movie; the pictures are written");
  if (status != 0)
    throw Error("ffmpeg failed", movie.string(), "is the folder writable and the extension known?");
}

}  // namespace strandcast
