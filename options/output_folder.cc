#include "options/output_folder.h"

#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/file_bytes.h"
#include "options/console.h"

namespace strandcast {

namespace fs = std::filesystem;

OutputFolder::OutputFolder(const fs::path& folder) {
  std::error_code failed;
  for (fs::path path = folder; !path.empty() && fs::status(path, failed).type() == fs::file_type::not_found;
       path = path.parent_path())
    made_.push_back(path);
  fs::create_directories(folder, failed);
  if (failed) throw Error("the folder cannot be made", folder.string(), failed.message());
}

OutputFolder::~OutputFolder() {
  std::error_code is_used;
  for (const fs::path& path : made_) fs::remove(path, is_used);
}

namespace {

/// yuv420p stores one colour per 2 x 2 pixels, so sides must be even.
constexpr const char* kEvenSides = "pad=ceil(iw/2)*2:ceil(ih/2)*2";

/// A temporary file beside the film, so that a failed run does not replace an existing film.
std::filesystem::path partOf(const std::filesystem::path& movie) {
  std::filesystem::path part = movie;
  part.replace_filename(movie.stem().string() + ".part" + movie.extension().string());
  return part;
}

/// Encodes the first `pictures` pictures of `folder` into `film`. Returns ffmpeg's exit status; empty where
/// it cannot be started. `quiet`: discards ffmpeg's output.
std::optional<int> runFfmpeg(const std::filesystem::path& folder, int pictures, double fps,
                             const std::filesystem::path& film, bool quiet) {
  std::string pattern;
  for (const char c : folder.string()) pattern += c == '%' ? "%%" : std::string(1, c);
  pattern = (std::filesystem::path(pattern) / "frame_%04d.png").string();
  std::vector<std::string> words = {"ffmpeg",     "-y",
                                    "-loglevel",  quiet ? "quiet" : "error",
                                    "-framerate", fmt::format("{:g}", fps),
                                    "-i",         pattern,
                                    "-frames:v",  std::to_string(pictures),
                                    "-vf",        kEvenSides,
                                    "-pix_fmt",   "yuv420p",
                                    "-crf",       "18",
                                    film.string()};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const bool interrupted_before = g_interrupted;
  pid_t child = 0;
  if (const int failed = posix_spawnp(&child, "ffmpeg", nullptr, nullptr, arguments.data(), environ)) {
    if (failed == ENOENT) return std::nullopt;
    throw Error("ffmpeg cannot be started", film.string(), std::strerror(failed));
  }
  int status = 0;
  bool asked_to_end = false;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (g_interrupted && !interrupted_before && !std::exchange(asked_to_end, true)) kill(child, SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return status;
}

/// A temporary folder, removed by the destructor.
class ScratchPictures {
 public:
  ScratchPictures() {
    std::string name = (std::filesystem::temp_directory_path() / "strandcast_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw Error("the folder for a test of ffmpeg cannot be made", name, std::strerror(errno));
    folder_ = name;
  }
  ~ScratchPictures() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  ScratchPictures(const ScratchPictures&) = delete;
  ScratchPictures& operator=(const ScratchPictures&) = delete;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

}  // namespace

std::filesystem::path picturePath(const std::filesystem::path& folder, int number) {
  return folder / fmt::format("frame_{:04d}.png", number);
}

bool isPictureName(const std::string& name) {
  constexpr std::string_view kBefore = "frame_", kAfter = ".png";
  if (!name.starts_with(kBefore) || !name.ends_with(kAfter) ||
      name.size() < kBefore.size() + kAfter.size() + 4)
    return false;
  const std::string digits = name.substr(kBefore.size(), name.size() - kBefore.size() - kAfter.size());
  return std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; }) &&
         (digits.size() == 4 || digits[0] != '0');
}

void PictureFolder::removeEarlier() const {
  std::error_code failed;
  std::vector<std::filesystem::path> earlier;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, failed))
    if (isPictureName(entry.path().filename().string()) &&
        entry.symlink_status().type() == std::filesystem::file_type::regular)
      earlier.push_back(entry.path());
  for (const std::filesystem::path& picture : earlier)
    if (!std::filesystem::remove(picture, failed) && failed)
      throw Error("a picture of an earlier run cannot be removed", picture.string(), failed.message());
  if (!earlier.empty())
    spdlog::info("{}: {} picture{} of an earlier run removed", pattern(), earlier.size(),
                 earlier.size() == 1 ? "" : "s");
}

void PictureFolder::write(const Image& picture) {
  if (written_ == 0 && !keeps_earlier_) removeEarlier();
  writePng(picturePath(folder_, written_), picture);
  ++written_;
}

void checkMovie(const std::filesystem::path& movie) {
  if (movie.empty()) throw Error("the film has no name", "--movie ''", "name a file, e.g. --movie hair.mp4");
  if (movie.extension().empty())
    throw Error("the film has no extension", movie.string(),
                "the extension selects the format, e.g. hair.mp4");
  checkWritable(movie);
  const ScratchPictures scratch;
  Image picture;
  picture.width = picture.height = 16;
  picture.rgb.assign(size_t{16} * 16 * 3, 0);
  writePng(picturePath(scratch.folder(), 0), picture);
  const std::filesystem::path film = scratch.folder() / ("trial" + movie.extension().string());
  const std::optional<int> status = runFfmpeg(scratch.folder(), 1, 30, film, true);
  if (!status)
    throw Error("ffmpeg is not installed", "--movie " + movie.string(), "install it, or leave out --movie");
  if (*status != 0)
    throw Error("ffmpeg does not write this format", "--movie " + movie.string(),
                "choose another extension, e.g. .mp4");
}

void makeMovie(const std::filesystem::path& folder, int pictures, double fps,
               const std::filesystem::path& movie) {
  const std::filesystem::path part = partOf(movie);
  const bool interrupted_before = g_interrupted;
  const std::optional<int> status = runFfmpeg(folder, pictures, fps, part, false);
  if (!status)
    throw Error("ffmpeg is not installed", movie.string(),
                "install it or leave out --movie; the pictures are written");
  std::error_code ignored;
  if (*status == 0) {
    std::filesystem::rename(part, movie, ignored);
    if (!ignored) return;
  }
  std::filesystem::remove(part, ignored);
  if (g_interrupted && !interrupted_before) return;
  throw Error("ffmpeg failed", movie.string(), "is the folder writable and the extension known?");
}

}  // namespace strandcast
