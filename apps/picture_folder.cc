#include "apps/picture_folder.h"

#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "apps/interrupt.h"
#include "core/error.h"

namespace strandcast {
namespace {

/// yuv420p has a colour for two by two pixels.
constexpr const char* kEvenSides = "pad=ceil(iw/2)*2:ceil(ih/2)*2";

}  // namespace

std::filesystem::path picturePath(const std::filesystem::path& folder, int number) {
  return folder / fmt::format("frame_{:04d}.png", number);
}

void makeMovie(const std::filesystem::path& folder, int pictures, double fps,
               const std::filesystem::path& movie) {
  // Beside what it will be, so that a film that fails takes the place of none.
  std::filesystem::path part = movie;
  part.replace_filename(movie.stem().string() + ".part" + movie.extension().string());
  std::string pattern;
  for (const char c : folder.string()) pattern += c == '%' ? "%%" : std::string(1, c);
  pattern = (std::filesystem::path(pattern) / "frame_%04d.png").string();
  std::vector<std::string> words = {"ffmpeg",     "-y",
                                    "-loglevel",  "error",
                                    "-framerate", fmt::format("{:g}", fps),
                                    "-i",         pattern,
                                    "-frames:v",  std::to_string(pictures),
                                    "-vf",        kEvenSides,
                                    "-pix_fmt",   "yuv420p",
                                    "-crf",       "18",
                                    part.string()};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const bool interrupted_before = g_interrupted;
  pid_t child = 0;
  if (const int failed = posix_spawnp(&child, "ffmpeg", nullptr, nullptr, arguments.data(), environ)) {
    if (failed == ENOENT)
      throw Error("ffmpeg is not installed", movie.string(),
                  "install it or leave out --movie; the pictures are written");
    throw Error("ffmpeg cannot be started", movie.string(), std::strerror(failed));
  }
  int status = 0;
  bool asked_to_end = false;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (g_interrupted && !interrupted_before && !std::exchange(asked_to_end, true)) kill(child, SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  std::error_code ignored;
  if (status == 0) {
    std::filesystem::rename(part, movie, ignored);
    if (!ignored) return;
  }
  std::filesystem::remove(part, ignored);
  if (g_interrupted && !interrupted_before) return;
  throw Error("ffmpeg failed", movie.string(), "is the folder writable and the extension known?");
}

}  // namespace strandcast
