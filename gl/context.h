#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace strandcast::gl {

/// The environment variable that names one EGL device by its number, 0 to 15, in the order of EGL. Two
/// processes on one host can so take one GPU each. Windows (GLFW) do not heed it.
inline constexpr const char* kDeviceVariable = "STRANDCAST_GPU";

/// What kDeviceVariable says; none where it is not set, or empty. Throws Error where it is no such number.
std::optional<int> chosenDevice();

/// An OpenGL 4.5 core context without a display, made current on the calling thread. Tries EGL devices
/// (hardware first), then Mesa's surfaceless platform; or the device of chosenDevice() alone. Throws Error,
/// saying what was tried, when there is none.
class HeadlessContext {
 public:
  HeadlessContext() : HeadlessContext(chosenDevice()) {}
  explicit HeadlessContext(std::optional<int> device);  ///< by its number, whatever chosenDevice() says
  ~HeadlessContext();
  HeadlessContext(const HeadlessContext&) = delete;
  HeadlessContext& operator=(const HeadlessContext&) = delete;

  void makeCurrent();
  void release();                       ///< so that another thread can make it current
  const std::string& renderer() const;  ///< GL_RENDERER
  bool software() const;                ///< isSoftwareRenderer(renderer())

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether GL_RENDERER is of a driver that draws on the processor: llvmpipe, softpipe, swrast, also under
/// zink or virgl, and the basic drivers of Windows and macOS.
bool isSoftwareRenderer(const std::string& renderer);
/// The same of the current context, which need not be a HeadlessContext.
bool currentIsSoftware();

/// An EGL device as `strandcast info --backends` lists it.
struct DeviceInfo {
  int number = 0;        ///< in the order of EGL, as kDeviceVariable takes it
  std::string renderer;  ///< GL_RENDERER, or why it gives no OpenGL 4.5 context
  std::string uuid;      ///< as `nvidia-smi -L` prints it, without "GPU-"; empty where the driver has none
};
/// All EGL devices of this machine. Makes a context on each in turn and leaves the caller's current.
std::vector<DeviceInfo> headlessDevices();

/// Whether a headless context can be made here; `device` gets GL_RENDERER or the reason. Cached.
bool headlessAvailable(std::string* device);

}  // namespace strandcast::gl
