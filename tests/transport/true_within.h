#pragma once
#include <chrono>
#include <functional>
#include <thread>

namespace strandcast {

/// Polls a condition; false when it is not true within `patience`.
inline bool trueWithin(std::chrono::milliseconds patience, const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace strandcast
