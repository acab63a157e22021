#pragma once

namespace strandcast {

/// Whether a sanitizer makes this program several times slower than users have it.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace strandcast
