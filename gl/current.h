#pragma once
#include <epoxy/egl.h>

#include "gl/context.h"

namespace strandcast::gl {

/// Restores the calling thread's current EGL context at the end of the scope, so that code with its own
/// context leaves its caller's unchanged.
class RestoreCurrent {
 public:
  RestoreCurrent()
      : display_(eglGetCurrentDisplay()),
        context_(eglGetCurrentContext()),
        draw_(eglGetCurrentSurface(EGL_DRAW)),
        read_(eglGetCurrentSurface(EGL_READ)) {}
  ~RestoreCurrent() {
    if (context_ == eglGetCurrentContext()) return;
    if (context_ != EGL_NO_CONTEXT)
      eglMakeCurrent(display_, draw_, read_, context_);
    else
      eglMakeCurrent(eglGetCurrentDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
  RestoreCurrent(const RestoreCurrent&) = delete;
  RestoreCurrent& operator=(const RestoreCurrent&) = delete;

 private:
  EGLDisplay display_;
  EGLContext context_;
  EGLSurface draw_, read_;
};

/// Makes `context` current for the scope, and restores the thread's previous context afterwards. The next
/// scope may then be on any thread.
class MakeCurrent {
 public:
  explicit MakeCurrent(HeadlessContext& context) { context.makeCurrent(); }

 private:
  RestoreCurrent restore_;
};

}  // namespace strandcast::gl
