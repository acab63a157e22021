#include "transport/shared_memory_users.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <string>
#include <string_view>
#include <system_error>

namespace strandcast {
namespace {

// Fast DDS 2.9.1 names ports so. Its reader holds the file with the suffix kLock locked during its lifetime.
constexpr std::string_view kPort = "fastrtps_port";
constexpr const char* kLock = "_el";
constexpr int kFirstPort = 7400, kPortsPerDomain = 250;

bool isPortOf(const std::string& name, int domain) {
  if (!name.starts_with(kPort)) return false;
  int port = 0;
  const char* const end = name.data() + name.size();
  const auto [rest, failure] = std::from_chars(name.data() + kPort.size(), end, port);
  const int first = kFirstPort + kPortsPerDomain * domain;
  return failure == std::errc() && rest == end && port >= first && port < first + kPortsPerDomain;
}

/// Whether a live program holds the port: one left by a killed program is not locked.
bool isHeld(const std::filesystem::path& port) {
  const int file = open((port.string() + kLock).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (file < 0) return errno != ENOENT;
  const bool is_held = flock(file, LOCK_SH | LOCK_NB) != 0;
  close(file);
  return is_held;
}

}  // namespace

bool anotherUserSharesMemory(int domain, uid_t own, const std::filesystem::path& folder) {
  std::error_code failed;
  for (std::filesystem::directory_iterator i(folder, failed), end; !failed && i != end; i.increment(failed)) {
    struct stat about {};
    if (isPortOf(i->path().filename().string(), domain) && lstat(i->path().c_str(), &about) == 0 &&
        about.st_uid != own && isHeld(i->path()))
      return true;
  }
  return false;
}

}  // namespace strandcast
