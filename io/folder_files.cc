#include "io/folder_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstring>
#include <deque>
#include <string>
#include <utility>

#include "core/error.h"
#include "io/file_bytes.h"

namespace strandcast {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int number() const { return number_; }
  bool isOpen() const { return number_ >= 0; }

 private:
  int number_;
};

/// Resolves a path below a folder component by component. Each folder is opened relative to the previous one
/// without following links; links are resolved here. No name is looked up again after its check. (The
/// kernel's openat2 with RESOLVE_BENEATH does the same, but is missing in older kernels and many containers.)
class WayBeneath {
 public:
  WayBeneath(const std::filesystem::path& folder, const std::filesystem::path& relative,
             const std::string& folder_name, const std::string& where)
      : name_(fmt::format("'{}'", relative.c_str())), folder_name_(folder_name), where_(where) {
    if (relative.empty() || relative.is_absolute() || relative.native().find('\0') != std::string::npos ||
        std::find(relative.begin(), relative.end(), "..") != relative.end())
      throw Error(name_ + " is no name within " + folder_name_, where_,
                  "give one without .. or a / in front");
    folders_.emplace_back(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (!folders_.back().isOpen())
      throw Error(folder_name_ + " cannot be read", where_,
                  fmt::format("is it there? {}", std::strerror(errno)));
    prepend(relative);
  }

  /// Opens the file at the end of the path, which must be regular.
  Descriptor open() {
    while (!steps_.empty()) {
      const std::string step = std::move(steps_.front());
      steps_.pop_front();
      if (step.empty() || step == ".") continue;
      if (step == "..") {
        if (folders_.size() == 1) leadsOut();
        folders_.pop_back();
      } else if (!followLink(step)) {
        if (std::all_of(steps_.begin(), steps_.end(), [](const std::string& s) { return s.empty(); }))
          return openFile(step);
        enter(step);
      }
    }
    throw Error(name_ + " is a folder", where_, "name a file in it");
  }

 private:
  [[noreturn]] void leadsOut() const {
    throw Error(name_ + " is a link out of " + folder_name_, where_, "put the file itself in there");
  }
  [[noreturn]] void isNotThere(int error) const {
    throw Error(name_ + " is not in " + folder_name_, where_,
                fmt::format("{}; give the name of a file in there", std::strerror(error)));
  }
  int last() const { return folders_.back().number(); }
  void prepend(const std::filesystem::path& steps) {
    std::deque<std::string> all;
    for (const std::filesystem::path& step : steps) all.push_back(step.string());
    steps_.insert(steps_.begin(), all.begin(), all.end());
  }

  /// Returns whether `step` is a link. The components of its target then come first in `steps_`.
  bool followLink(const std::string& step) {
    constexpr int kMostLinks = 40;  // the limit of Linux
    std::array<char, PATH_MAX> target;
    const ssize_t length = ::readlinkat(last(), step.c_str(), target.data(), target.size());
    if (length < 0) {
      if (errno == EINVAL) return false;  // it exists and is no link
      isNotThere(errno);
    }
    const std::filesystem::path to(std::string(target.data(), static_cast<size_t>(length)));
    if (to.is_absolute() || static_cast<size_t>(length) == target.size()) leadsOut();
    if (++links_ > kMostLinks) isNotThere(ELOOP);
    prepend(to);
    return true;
  }

  void enter(const std::string& step) {
    Descriptor next(::openat(last(), step.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    if (!next.isOpen()) isNotThere(errno);
    folders_.push_back(std::move(next));
  }

  Descriptor openFile(const std::string& step) const {
    // O_NONBLOCK: opening a pipe would wait for a writer.
    Descriptor file(
        ::openat(last(), step.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    if (!file.isOpen()) isNotThere(errno);
    struct stat status {};
    if (::fstat(file.number(), &status) != 0) isNotThere(errno);
    if (!S_ISREG(status.st_mode))
      throw Error(name_ + " is not a regular file", where_, "name a file that is one");
    return file;
  }

  std::string name_, folder_name_, where_;
  std::vector<Descriptor> folders_;  ///< open folders, from the starting folder down to the current one
  std::deque<std::string> steps_;    ///< components still to be resolved
  int links_ = 0;
};

}  // namespace

std::vector<std::byte> readBeneath(const std::filesystem::path& folder,
                                   const std::filesystem::path& relative) {
  const Descriptor file = WayBeneath(folder, relative, "its folder", relative.string()).open();
  return readOpenFile(file.number(), relative);
}

void checkBeneath(const std::filesystem::path& folder, const std::filesystem::path& relative,
                  const std::string& folder_name, const std::string& where) {
  (void)WayBeneath(folder, relative, folder_name, where).open();
}

}  // namespace strandcast
