#include "io/byte_writer.h"

namespace strandcast {

void ByteWriter::zeros(size_t bytes) { bytes_.resize(bytes_.size() + bytes); }

void ByteWriter::raw(const void* data, size_t bytes) {
  const auto* first = static_cast<const std::byte*>(data);
  bytes_.insert(bytes_.end(), first, first + bytes);
}

}  // namespace strandcast
