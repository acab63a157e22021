#pragma once
#include <cstdint>
#include <optional>

#include "core/strand_set.h"

namespace strandcast {

/// Bytes that a frame of these guides takes on the network with the daemon's default codec, at rest; nothing
/// where a strand is too long for the network.
std::optional<uint64_t> bytesPerFrame(const StrandSet& guides);

}  // namespace strandcast
