#pragma once
#include <cstdint>
#include <optional>

#include "core/strand_set.h"

namespace strandcast {

/// Bytes per frame of these guides at rest on the network, with the daemon's default codec. Empty where a
/// strand is too long for the network.
std::optional<uint64_t> bytesPerFrame(const StrandSet& guides);

}  // namespace strandcast
