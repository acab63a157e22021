#include "gl/context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <mutex>

#include "core/error.h"
#include "gl/current.h"

namespace strandcast::gl {
namespace {

constexpr int kMaxDevices = 16;

bool hasClientExtension(const char* name) {
  const char* list = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  return list != nullptr && std::strstr(list, name) != nullptr;
}

std::vector<EGLDeviceEXT> eglDevices() {
  std::vector<EGLDeviceEXT> devices(kMaxDevices);
  EGLint count = 0;
  if (!hasClientExtension("EGL_EXT_device_base") || !hasClientExtension("EGL_EXT_platform_device") ||
      !eglQueryDevicesEXT(kMaxDevices, devices.data(), &count))
    count = 0;
  devices.resize(static_cast<size_t>(count));
  return devices;
}

/// Mesa marks its software device by an extension. The extension string may be null, as on NVIDIA's devices.
bool isSoftwareDevice(EGLDeviceEXT device) {
  const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
  return extensions != nullptr && std::strstr(extensions, "EGL_MESA_device_software") != nullptr;
}

EGLDisplay displayOf(EGLDeviceEXT device) {
  return eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
}

std::string labelOf(size_t number) { return "EGL device " + std::to_string(number); }

/// UUID of the current context's device; empty if the driver has none.
std::string currentUuid() {
  if (!epoxy_has_gl_extension("GL_EXT_memory_object")) return {};
  std::array<GLubyte, GL_UUID_SIZE_EXT> bytes{};
  glGetUnsignedBytei_vEXT(GL_DEVICE_UUID_EXT, 0, bytes.data());
  if (glGetError() != GL_NO_ERROR) return {};
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (size_t i = 0; i < bytes.size(); ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) text += '-';
    text += kDigits[bytes[i] >> 4];
    text += kDigits[bytes[i] & 15];
  }
  return text;
}

}  // namespace

bool isSoftwareRenderer(const std::string& renderer) {
  std::string lower = renderer;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "software", "microsoft basic render"})
    if (lower.find(name) != std::string::npos) return true;
  return false;
}

bool currentIsSoftware() {
  const GLubyte* const renderer = glGetString(GL_RENDERER);
  return renderer != nullptr && isSoftwareRenderer(reinterpret_cast<const char*>(renderer));
}

std::optional<int> chosenDevice() {
  const char* const text = std::getenv(kDeviceVariable);
  if (text == nullptr || *text == '\0') return std::nullopt;
  const char* const end = text + std::strlen(text);
  int number = -1;
  const auto [rest, failure] = std::from_chars(text, end, number);
  if (rest != end || failure != std::errc() || number < 0 || number >= kMaxDevices)
    throw Error("not the number of an EGL device", std::string(kDeviceVariable) + "=" + text,
                "give one that `strandcast info --backends` lists");
  return number;
}

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
    // No eglTerminate(): all contexts of the process share the display.
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

HeadlessContext::HeadlessContext(std::optional<int> device) : impl_(std::make_unique<Impl>()) {
  std::string tried;
  const std::vector<EGLDeviceEXT> devices = eglDevices();
  if (device) {
    const auto number = static_cast<size_t>(*device);
    const std::string count = std::to_string(devices.size());
    if (number >= devices.size())
      throw Error("there is no " + labelOf(number),
                  std::string(kDeviceVariable) + "=" + std::to_string(number),
                  "EGL lists " + count + ", counted from 0: see `strandcast info --backends`");
    if (impl_->create(displayOf(devices[number]), labelOf(number), tried)) return;
    throw Error("no OpenGL 4.5 without a display on the device that was asked for",
                tried.substr(0, tried.size() - 2),
                std::string("unset ") + kDeviceVariable + " or name another");
  }
  for (const bool software : {false, true})
    for (size_t i = 0; i < devices.size(); ++i)
      if (isSoftwareDevice(devices[i]) == software && impl_->create(displayOf(devices[i]), labelOf(i), tried))
        return;
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
bool HeadlessContext::software() const { return isSoftwareRenderer(impl_->renderer); }

std::vector<DeviceInfo> headlessDevices() {
  const RestoreCurrent restore;
  std::vector<DeviceInfo> out(eglDevices().size());
  for (size_t i = 0; i < out.size(); ++i) {
    out[i].number = static_cast<int>(i);
    try {
      const HeadlessContext context(out[i].number);
      out[i].renderer = context.renderer();
      out[i].uuid = currentUuid();
    } catch (const Error& error) {
      out[i].renderer = error.what();
    }
  }
  return out;
}

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
