#pragma once
#include <vector>

#include "core/backend.h"

namespace strandcast {

/// Every backend this program knows of, runnable here or not.
std::vector<BackendInfo> knownBackends();

}  // namespace strandcast
