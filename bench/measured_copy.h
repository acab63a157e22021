#pragma once

namespace strandcast {

/// Bytes per second that `threads` threads move by copying memory beyond the caches, measured; a byte read
/// and written counts two.
double measuredCopy(int threads);

}  // namespace strandcast
