#pragma once
#include <cstddef>
#include <cstdint>

namespace strandcast {

/// 64 bits over bytes, in the order they are added: FNV-1a (Fowler, Noll, Vo).
class ContentHash {
 public:
  void add(const void* data, size_t bytes) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < bytes; ++i) value_ = (value_ ^ p[i]) * 1099511628211ull;
  }
  template <class T>
  void add(const T& value) {
    add(&value, sizeof(T));
  }
  uint64_t value() const { return value_; }

 private:
  uint64_t value_ = 14695981039346656037ull;
};

}  // namespace strandcast
