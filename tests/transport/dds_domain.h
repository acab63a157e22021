#pragma once
#include <unistd.h>

namespace strandcast {

/// A domain for one test, its own among the tests of this program and most likely among programs that run at
/// once.
inline int testDomain(int test) { return 100 + (getpid() * 16 + test) % 130; }

}  // namespace strandcast
