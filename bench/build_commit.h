#pragma once
#include <string>

namespace strandcast {

/// The commit that this program was built from, with a + where sources had uncommitted changes; "unknown"
/// outside a git checkout.
std::string buildCommit();

}  // namespace strandcast
