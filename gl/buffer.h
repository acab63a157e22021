#pragma once
#include <epoxy/gl.h>

#include <atomic>
#include <cstddef>
#include <span>
#include <utility>

namespace strandcast::gl {

/// Clears the errors of earlier commands, so that ranOutOfMemory() reports later ones only.
inline void discardErrors() {
  for (int i = 0; i < 64 && glGetError() != GL_NO_ERROR; ++i) {
  }
}
/// Whether an allocation since discardErrors() ran out of memory. Clears the error.
inline bool ranOutOfMemory() { return glGetError() == GL_OUT_OF_MEMORY; }

/// A buffer object of fixed size. Needs a current context for its whole life; a default-constructed one has
/// no object and needs none.
class Buffer {
 public:
  Buffer() = default;
  /// `flags` as for glNamedBufferStorage. Sizes below 16 bytes are raised to 16, so that the buffer can
  /// always be bound. Allocation failure is a GL error: see ranOutOfMemory().
  Buffer(size_t bytes, const void* data, GLbitfield flags) : bytes_(bytes < 16 ? 16 : bytes) {
    glCreateBuffers(1, &id_);
    bytes_of_all += bytes_;
    glNamedBufferStorage(id_, static_cast<GLsizeiptr>(bytes_), bytes < 16 ? nullptr : data, flags);
    if (bytes > 0 && bytes < 16 && data != nullptr && (flags & GL_DYNAMIC_STORAGE_BIT) != 0)
      glNamedBufferSubData(id_, 0, static_cast<GLsizeiptr>(bytes), data);
  }
  /// A copy of `data`, with GL_DYNAMIC_STORAGE_BIT.
  template <class T>
  explicit Buffer(std::span<const T> data) : Buffer(data.size_bytes(), data.data(), GL_DYNAMIC_STORAGE_BIT) {}
  ~Buffer() {
    if (id_ == 0) return;
    glDeleteBuffers(1, &id_);
    bytes_of_all -= bytes_;
  }
  Buffer(Buffer&& other) noexcept { *this = std::move(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }

  /// Overwrites bytes from `first_byte` on. Precondition: made with GL_DYNAMIC_STORAGE_BIT, and the data
  /// fits.
  template <class T>
  void write(std::span<const T> data, size_t first_byte = 0) {
    glNamedBufferSubData(id_, static_cast<GLintptr>(first_byte), static_cast<GLsizeiptr>(data.size_bytes()),
                         data.data());
  }
  void bindStorage(GLuint binding) const { glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, id_); }
  GLuint id() const { return id_; }
  size_t bytes() const { return bytes_; }
  /// Total size of all live buffers of the process. Thread-safe.
  static size_t bytesOfAll() { return bytes_of_all; }

 private:
  static inline std::atomic<size_t> bytes_of_all{0};
  GLuint id_ = 0;
  size_t bytes_ = 0;
};

}  // namespace strandcast::gl
