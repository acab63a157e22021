#pragma once
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>

#include "tests/thorough.h"

namespace strandcast {

/// Guides (of 16 vertices) that transport_peer publishes at 60 Hz. Sanitizers slow every access to a vertex:
/// with one, two cores cannot send the full groom beside other tests, whatever the transport does.
inline constexpr int kPeerGuides = kSanitized ? 1000 : 4933;

/// Domains of the tests: their ports are above LCM's, which begin at 7667, and below Linux's ephemeral ports
/// (32768 and up).
inline constexpr int kFirstTestDomain = 3, kLastTestDomain = 100;

/// A domain has the ports 7400 + 250 * domain to 7400 + 250 * domain + 249.
inline int firstPort(int domain) { return 7400 + 250 * domain; }

/// A domain for test number `test` of this program. While this program runs, no other test program of this
/// machine gets it: binding an abstract socket name reserves it.
inline int testDomain(int test) {
  static std::map<int, int> own;
  if (const auto found = own.find(test); found != own.end()) return found->second;
  constexpr int kDomains = kLastTestDomain - kFirstTestDomain + 1;
  const int name = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  for (int tries = 0; tries < kDomains; ++tries) {
    // Starting at different numbers: a domain forgets a killed participant only after seconds.
    const int domain = kFirstTestDomain + (getpid() * 16 + test + tries) % kDomains;
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    // A name that begins with 0 is abstract: no file, and released with the process.
    const std::string text = "strandcast test domain " + std::to_string(domain);
    std::memcpy(address.sun_path + 1, text.data(), text.size());
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
    if (bind(name, reinterpret_cast<const sockaddr*>(&address), size) == 0) return own[test] = domain;
  }
  close(name);
  throw std::runtime_error("all domains of tests are taken");
}

}  // namespace strandcast
