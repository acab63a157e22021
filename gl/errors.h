#pragma once
#include <epoxy/gl.h>

namespace strandcast::gl {

/// Clears the errors of earlier commands, so that ranOutOfMemory() reports later ones only.
inline void discardErrors() {
  for (int i = 0; i < 64 && glGetError() != GL_NO_ERROR; ++i) {
  }
}
/// Whether an allocation since discardErrors() ran out of memory. Clears the error.
inline bool ranOutOfMemory() { return glGetError() == GL_OUT_OF_MEMORY; }

}  // namespace strandcast::gl
