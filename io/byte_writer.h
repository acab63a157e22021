#pragma once
#include <cstddef>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Appends little-endian values; the counterpart of ByteReader.
class ByteWriter {
 public:
  void reserve(size_t bytes) { bytes_.reserve(bytes); }
  size_t size() const { return bytes_.size(); }
  template <class T>
  void put(T value) {
    raw(&value, sizeof(T));
  }
  void put(const Vec3& point) { raw(point.data(), 3 * sizeof(float)); }
  /// Appends `bytes` zero bytes.
  void zeros(size_t bytes);
  /// Appends `bytes` bytes from `data` unchanged.
  void raw(const void* data, size_t bytes);
  /// Moves the bytes out.
  /// Moves the bytes out; the writer must not be used afterwards.
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace strandcast
