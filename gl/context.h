#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace strandcast::gl {

/// The environment variable that selects an EGL device by its number, 0 to 15, in the order of EGL, so that
/// two processes on one host can use one GPU each. Windows (GLFW) ignore it.
inline constexpr const char* kDeviceVariable = "STRANDCAST_GPU";

/// The value of kDeviceVariable; none if it is unset or empty. Throws Error if it is no number from 0 to 15.
std::optional<int> chosenDevice();

/// An OpenGL 4.5 core context without a display, made current on the calling thread. Tries EGL devices
/// (hardware first), then Mesa's surfaceless platform; with chosenDevice(), that device only. Throws Error,
/// saying what was tried, if none works.
class HeadlessContext {
 public:
  HeadlessContext() : HeadlessContext(chosenDevice()) {}
  explicit HeadlessContext(std::optional<int> device);  ///< `device` in place of chosenDevice()
  ~HeadlessContext();
  HeadlessContext(const HeadlessContext&) = delete;
  HeadlessContext& operator=(const HeadlessContext&) = delete;

  void makeCurrent();                   ///< throws Error if it is current on another thread
  void release();                       ///< afterwards another thread can make it current
  const std::string& renderer() const;  ///< GL_RENDERER
  bool software() const;                ///< isSoftwareRenderer(renderer())

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether GL_RENDERER names a driver that renders on the CPU: llvmpipe, softpipe, swrast, also under zink or
/// virgl, and the basic drivers of Windows and macOS.
bool isSoftwareRenderer(const std::string& renderer);
/// The same for the current context, which need not be a HeadlessContext.
bool currentIsSoftware();

/// An EGL device as `strandcast info --backends` lists it.
struct DeviceInfo {
  int number = 0;        ///< in the order of EGL, for kDeviceVariable
  std::string renderer;  ///< GL_RENDERER, or why there is no OpenGL 4.5 context
  std::string uuid;      ///< as `nvidia-smi -L` prints it, without "GPU-"; empty if the driver has none
};
/// All EGL devices of this machine. Makes a context on each in turn; restores the caller's current context.
std::vector<DeviceInfo> headlessDevices();

/// Whether this machine can make a headless context. `device`, unless null, gets GL_RENDERER or the reason.
/// The first call decides; later ones return its result. Thread-safe.
bool headlessAvailable(std::string* device);

}  // namespace strandcast::gl
