#pragma once

namespace strandcast {

/// Measured bytes per second that `threads` threads move by copying memory larger than the caches; a byte
/// read and written counts as two.
double measuredCopy(int threads);

}  // namespace strandcast
