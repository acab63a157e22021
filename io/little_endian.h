// Little-endian values in the bytes of a file: ByteReader and ByteWriter.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/geometry.h"

namespace strandcast {

static_assert(std::endian::native == std::endian::little,
              "the binary readers copy little-endian files as they are");

/// Reads little-endian values from the bytes of a file. Offsets and counts may have any value. Each read
/// first checks them against the size, in 64 bits and without a product that could overflow. A failed check
/// throws Error with the name of the file and the byte offset.
class ByteReader {
 public:
  ByteReader(std::span<const std::byte> bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  uint64_t size() const { return bytes_.size(); }
  /// Location as errors name it: "file, byte 160".
  std::string where(uint64_t offset) const { return name_ + ", byte " + std::to_string(offset); }
  /// Throws Error located at byte `offset`.
  [[noreturn]] void fail(const std::string& what, uint64_t offset,
                         const std::string& remedy = kDamaged) const {
    throw Error(what, where(offset), remedy);
  }

  /// Throws Error unless `count` elements of `element_bytes` (at least 1) lie inside the file from `offset`
  /// on.
  void require(uint64_t offset, uint64_t count, uint64_t element_bytes, const char* what) const {
    if (offset > size() || count > (size() - offset) / element_bytes)
      fail(std::string("the file ends before its ") + what + " (" + std::to_string(count) + " times " +
               std::to_string(element_bytes) + " bytes in a file of " + std::to_string(size()) + ")",
           offset);
  }

  /// The value of type T at `offset`; `what` names it in errors.
  template <class T>
  T at(uint64_t offset, const char* what = "header") const {
    require(offset, 1, sizeof(T), what);
    T value;
    std::memcpy(&value, bytes_.data() + offset, sizeof(T));
    return value;
  }

  /// Copies `count` values of T to `out`, which may have any element type of the same size.
  template <class T>
  void copy(uint64_t offset, uint64_t count, void* out, const char* what) const {
    require(offset, count, sizeof(T), what);
    if (count > 0) std::memcpy(out, bytes_.data() + offset, count * sizeof(T));
  }

  static constexpr const char* kDamaged = "the file is damaged, export or copy it again";

 private:
  std::span<const std::byte> bytes_;
  std::string name_;
};

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

inline void ByteWriter::zeros(size_t bytes) { bytes_.resize(bytes_.size() + bytes); }

inline void ByteWriter::raw(const void* data, size_t bytes) {
  const auto* first = static_cast<const std::byte*>(data);
  bytes_.insert(bytes_.end(), first, first + bytes);
}

}  // namespace strandcast
