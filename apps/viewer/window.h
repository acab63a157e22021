#pragma once
#include <chrono>
#include <string>
#include <vector>

struct GLFWwindow;

namespace strandcast {

/// A window with an OpenGL 4.5 context, current as long as it lives, and Dear ImGui in it.
class ViewerWindow {
 public:
  static const int kEscape, kTab;  ///< keys; letters and digits are their capital ASCII codes
  /// Pixels, and pictures a second at most (0: as many as the display shows). Throws Error where there is no
  /// display.
  ViewerWindow(int width, int height, double max_fps);
  ~ViewerWindow();
  ViewerWindow(const ViewerWindow&) = delete;
  ViewerWindow& operator=(const ViewerWindow&) = delete;

  bool isOpen() const;
  void close();
  int width() const;  ///< pixels
  int height() const;

  void beginFrame();  ///< takes events; panels may be made from now on
  /// Whether the panels leave the mouse, and keys, to the picture.
  bool mouseIsFree() const;
  bool keysAreFree() const;
  /// Pressed since the last beginFrame(), also those that are up again.
  const std::vector<int>& pressedKeys() const { return pressed_; }
  /// Draws the panels over what the window shows, and shows it; not more often than the display can or was
  /// asked for.
  void endFrame(const std::string& title);
  void clear();  ///< to dark grey

 private:
  using Clock = std::chrono::steady_clock;

  GLFWwindow* window_ = nullptr;
  Clock::duration shortest_;   ///< of frames
  Clock::time_point shown_{};  ///< when the last one was
  std::vector<int> pressed_;
};

}  // namespace strandcast
