#pragma once
#include <unistd.h>

namespace strandcast {

/// Guides (of 16 vertices) that transport_peer publishes at 60 Hz. Under the thread sanitizer, which slows
/// every access to a vertex down many times, the full groom is more than a machine of two cores can send,
/// whatever the transport does.
#ifdef __SANITIZE_THREAD__
inline constexpr int kPeerGuides = 1000;
#else
inline constexpr int kPeerGuides = 4933;
#endif

/// A domain for one test, its own among the tests of this program and most likely among programs that run at
/// once.
inline int testDomain(int test) { return 100 + (getpid() * 16 + test) % 130; }

}  // namespace strandcast
