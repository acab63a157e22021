// Replaces functions of the C library in transport_peer, through which DDS and LCM send. Drops datagrams by
// seed, at the rate STRANDCAST_PEER_LOSS (0 to 1).
#include <dlfcn.h>
#include <sys/socket.h>

#include <cstdlib>
#include <mutex>
#include <random>

namespace {

bool isLost(int socket) {
  static const double rate = [] {
    const char* text = std::getenv("STRANDCAST_PEER_LOSS");
    return text != nullptr ? std::atof(text) : 0.0;
  }();
  int type = 0;
  socklen_t size = sizeof type;
  if (rate <= 0 || getsockopt(socket, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_DGRAM)
    return false;
  static std::mutex mutex;
  static std::mt19937 random(20240229);
  const std::lock_guard lock(mutex);
  return std::uniform_real_distribution<double>(0, 1)(random) < rate;
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" ssize_t sendmsg(int socket, const msghdr* message, int flags) {
  static const auto real = next<ssize_t (*)(int, const msghdr*, int)>("sendmsg");
  if (!isLost(socket)) return real(socket, message, flags);
  size_t bytes = 0;
  for (size_t i = 0; i < message->msg_iovlen; ++i) bytes += message->msg_iov[i].iov_len;
  return static_cast<ssize_t>(bytes);
}

extern "C" ssize_t sendto(int socket, const void* data, size_t bytes, int flags, const sockaddr* to,
                          socklen_t to_size) {
  static const auto real =
      next<ssize_t (*)(int, const void*, size_t, int, const sockaddr*, socklen_t)>("sendto");
  return isLost(socket) ? static_cast<ssize_t>(bytes) : real(socket, data, bytes, flags, to, to_size);
}
