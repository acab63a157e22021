#pragma once
#include <epoxy/gl.h>

namespace strandcast::gl {

/// Forgets the errors of earlier commands, so that what ranOutOfMemory() tells is of later ones.
inline void discardErrors() {
  for (int i = 0; i < 64 && glGetError() != GL_NO_ERROR; ++i) {
  }
}
/// Whether something that was made since discardErrors() does not fit the memory there is.
inline bool ranOutOfMemory() { return glGetError() == GL_OUT_OF_MEMORY; }

}  // namespace strandcast::gl
