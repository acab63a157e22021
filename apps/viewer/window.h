#pragma once
#include <chrono>
#include <string>
#include <vector>

struct GLFWwindow;

namespace strandcast {

/// A window with an OpenGL 4.5 context, current for its lifetime, and a Dear ImGui context.
class ViewerWindow {
 public:
  static const int kEscape, kTab;  ///< key codes; letters and digits are their capital ASCII codes
  /// Size in pixels; `max_fps`: pictures per second at most, 0 = the display's rate. Throws Error where there
  /// is no display.
  ViewerWindow(int width, int height, double max_fps);
  ~ViewerWindow();
  ViewerWindow(const ViewerWindow&) = delete;
  ViewerWindow& operator=(const ViewerWindow&) = delete;

  bool isOpen() const;
  void close();
  int width() const;  ///< pixels
  int height() const;

  void beginFrame();  ///< polls events; panels may be drawn from now on
  /// Whether the panels do not capture the mouse, or the keys.
  bool mouseIsFree() const;
  bool keysAreFree() const;
  /// Keys pressed since the last beginFrame(), including those released again.
  const std::vector<int>& pressedKeys() const { return pressed_; }
  /// Draws the panels over the window's content and swaps buffers; waits so that the display's rate or
  /// max_fps is not exceeded.
  void endFrame(const std::string& title);
  void clear();  ///< to dark grey

 private:
  using Clock = std::chrono::steady_clock;

  GLFWwindow* window_ = nullptr;
  Clock::duration shortest_;   ///< of a frame
  Clock::time_point shown_{};  ///< time of the last swap
  std::vector<int> pressed_;
};

}  // namespace strandcast
