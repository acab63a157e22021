#include "gl/context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <cstdlib>
#include <cstring>
#include <mutex>
#include <vector>

#include "core/error.h"

namespace strandcast::gl {
namespace {

bool isSoftware(const std::string& renderer) {
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "Software"})
    if (renderer.find(name) != std::string::npos) return true;
  return false;
}

bool hasClientExtension(const char* name) {
  const char* list = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  return list != nullptr && std::strstr(list, name) != nullptr;
}

}  // namespace

struct HeadlessContext::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  std::string renderer;

  ~Impl() {
    if (display == EGL_NO_DISPLAY) return;
    if (context != EGL_NO_CONTEXT) {
      if (eglGetCurrentContext() == context)
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      eglDestroyContext(display, context);
    }
    // The display is shared by every context of the process: terminating it here would pull it from under
    // them.
  }

  bool create(EGLDisplay candidate, const std::string& label, std::string& tried) {
    EGLint major = 0, minor = 0;
    if (candidate == EGL_NO_DISPLAY || !eglInitialize(candidate, &major, &minor)) {
      tried += label + " (cannot be initialised), ";
      return false;
    }
    if (!eglBindAPI(EGL_OPENGL_API)) {
      tried += label + " (no desktop OpenGL), ";
      return false;
    }
    const EGLint config_wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                    EGL_NONE};
    EGLConfig config = nullptr;
    EGLint configs = 0;
    if (!eglChooseConfig(candidate, config_wanted, &config, 1, &configs) || configs == 0) config = nullptr;
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    EGLContext made = eglCreateContext(candidate, config, EGL_NO_CONTEXT, attributes);
    if (made == EGL_NO_CONTEXT) {
      tried += label + " (no OpenGL 4.5 core context), ";
      return false;
    }
    if (!eglMakeCurrent(candidate, EGL_NO_SURFACE, EGL_NO_SURFACE, made)) {
      eglDestroyContext(candidate, made);
      tried += label + " (no surfaceless context), ";
      return false;
    }
    display = candidate;
    context = made;
    renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    return true;
  }
};

HeadlessContext::HeadlessContext() : impl_(std::make_unique<Impl>()) {
  std::string tried;
  if (hasClientExtension("EGL_EXT_device_base") && hasClientExtension("EGL_EXT_platform_device")) {
    std::vector<EGLDeviceEXT> devices(16);
    EGLint count = 0;
    if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count)) {
      // Hardware drivers announce a DRM or vendor device; Mesa's software device says
      // EGL_MESA_device_software.
      for (const bool software : {false, true}) {
        for (EGLint i = 0; i < count; ++i) {
          const char* extensions = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
          const bool is_software =
              extensions != nullptr && std::strstr(extensions, "EGL_MESA_device_software");
          if (is_software != software) continue;
          EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr);
          if (impl_->create(display, "EGL device " + std::to_string(i), tried)) return;
        }
      }
    }
  }
  if (hasClientExtension("EGL_MESA_platform_surfaceless")) {
    EGLDisplay display =
        eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (impl_->create(display, "Mesa surfaceless", tried)) return;
  }
  throw Error("no OpenGL 4.5 without a display",
              tried.empty() ? "EGL offers no device" : "tried " + tried.substr(0, tried.size() - 2),
              "install a GL driver (Debian: libegl1 libgl1-mesa-dri, or the vendor's)");
}

HeadlessContext::~HeadlessContext() = default;

void HeadlessContext::makeCurrent() {
  eglBindAPI(EGL_OPENGL_API);
  if (!eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, impl_->context))
    throw Error("the OpenGL context cannot be made current", impl_->renderer,
                "it may be current on another thread");
}

void HeadlessContext::release() {
  eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

const std::string& HeadlessContext::renderer() const { return impl_->renderer; }
bool HeadlessContext::software() const { return isSoftware(impl_->renderer); }

bool headlessAvailable(std::string* device) {
  static std::once_flag once;
  static bool available = false;
  static std::string text;
  std::call_once(once, [] {
    const EGLDisplay display = eglGetCurrentDisplay();
    const EGLContext context = eglGetCurrentContext();
    const EGLSurface surface = eglGetCurrentSurface(EGL_DRAW);
    try {
      const HeadlessContext probe;
      available = true;
      text = probe.renderer();
    } catch (const Error& error) {
      text = error.what();
    }
    if (context != EGL_NO_CONTEXT) eglMakeCurrent(display, surface, surface, context);
  });
  if (device != nullptr) *device = text;
  return available;
}

}  // namespace strandcast::gl
