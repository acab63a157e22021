#pragma once
#include <memory>
#include <string>

namespace strandcast::gl {

/// An OpenGL 4.5 core context without a display, made current on the calling thread. Tries EGL devices
/// (hardware first), then Mesa's surfaceless platform. Throws Error, saying what was tried, when there is
/// none.
class HeadlessContext {
 public:
  HeadlessContext();
  ~HeadlessContext();
  HeadlessContext(const HeadlessContext&) = delete;
  HeadlessContext& operator=(const HeadlessContext&) = delete;

  void makeCurrent();
  void release();                       ///< so that another thread can make it current
  const std::string& renderer() const;  ///< GL_RENDERER
  bool software() const;                ///< llvmpipe, softpipe or swrast

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether a headless context can be made here; `device` gets GL_RENDERER or the reason. Cached.
bool headlessAvailable(std::string* device);

}  // namespace strandcast::gl
