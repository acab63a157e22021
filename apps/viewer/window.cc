#include "apps/viewer/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <epoxy/gl.h>
#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>
#include <imgui/imgui.h>

#include <algorithm>
#include <thread>

#include "core/error.h"

namespace strandcast {
namespace {

Error windowError() {
  const char* text = nullptr;
  glfwGetError(&text);
  return Error("no window can be opened", text != nullptr ? text : "GLFW",
               "run it on a desktop with OpenGL 4.5, or use `strandcast render`");
}

void setStyle() {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0;
  style.FrameRounding = 3;
  style.GrabRounding = 3;
  style.WindowBorderSize = 0;
  style.FramePadding = {6, 3};
  style.ItemSpacing = {6, 5};
  style.WindowPadding = {10, 8};
  style.Colors[ImGuiCol_WindowBg] = {0.10f, 0.105f, 0.115f, 0.97f};
  style.Colors[ImGuiCol_Header] = {0.20f, 0.24f, 0.29f, 1};
  style.Colors[ImGuiCol_HeaderHovered] = {0.26f, 0.33f, 0.41f, 1};
  style.Colors[ImGuiCol_HeaderActive] = {0.28f, 0.38f, 0.48f, 1};
  style.Colors[ImGuiCol_FrameBg] = {0.17f, 0.18f, 0.20f, 1};
  style.Colors[ImGuiCol_FrameBgHovered] = {0.23f, 0.26f, 0.30f, 1};
  style.Colors[ImGuiCol_Button] = {0.22f, 0.28f, 0.35f, 1};
}

/// The highest refresh rate of all displays, Hz.
int refreshRate() {
  int count = 0, highest = 0;
  GLFWmonitor** monitors = glfwGetMonitors(&count);
  for (int i = 0; i < count; ++i)
    if (const GLFWvidmode* mode = glfwGetVideoMode(monitors[i]))
      highest = std::max(highest, mode->refreshRate);
  return highest > 0 ? highest : 60;
}

}  // namespace

const int ViewerWindow::kEscape = GLFW_KEY_ESCAPE, ViewerWindow::kTab = GLFW_KEY_TAB;

ViewerWindow::ViewerWindow(int width, int height, double max_fps) {
  if (glfwInit() == GLFW_FALSE) throw windowError();
  glfwWindowHint(GLFW_CONTEXT_CREATION_API,
                 GLFW_EGL_CONTEXT_API);  // the GPU backend uses EGL too, and restores this context
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  window_ = glfwCreateWindow(width, height, "Strandcast", nullptr, nullptr);
  if (window_ == nullptr) {
    const Error error = windowError();
    glfwTerminate();
    throw error;
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  // Slightly less than the display's period, for drivers where swapping waits.
  double shortest = 0.9 / refreshRate();
  if (max_fps > 0) shortest = std::max(shortest, 1 / max_fps);
  shortest_ = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(shortest));
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // panel positions are not saved
  setStyle();
  // Dear ImGui 1.86 samples keys only once per frame, so a short press is lost. It chains the callbacks set
  // before it.
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
    if (action == GLFW_PRESS)
      static_cast<ViewerWindow*>(glfwGetWindowUserPointer(window))->pressed_.push_back(key);
  });
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  if (!ImGui_ImplOpenGL3_Init("#version 450 core")) {
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window_);
    glfwTerminate();
    throw Error("the panels cannot be drawn", "Dear ImGui", "is libGL.so of the system's OpenGL installed?");
  }
}

ViewerWindow::~ViewerWindow() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

bool ViewerWindow::isOpen() const { return glfwWindowShouldClose(window_) == GLFW_FALSE; }
void ViewerWindow::close() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }

int ViewerWindow::width() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return width;
}

int ViewerWindow::height() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return height;
}

void ViewerWindow::beginFrame() {
  pressed_.clear();
  glfwPollEvents();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

bool ViewerWindow::mouseIsFree() const { return !ImGui::GetIO().WantCaptureMouse; }
bool ViewerWindow::keysAreFree() const { return !ImGui::GetIO().WantTextInput; }

void ViewerWindow::clear() {
  const float grey[4] = {0.06f, 0.06f, 0.065f, 1};
  glClearNamedFramebufferfv(0, GL_COLOR, 0, grey);
}

void ViewerWindow::endFrame(const std::string& title) {
  ImGui::Render();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width(), height());
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSetWindowTitle(window_, title.c_str());
  glfwSwapBuffers(window_);
  // Not all drivers wait for the display, and none does for a hidden window.
  std::this_thread::sleep_until(shown_ + shortest_);
  shown_ = Clock::now();
}

}  // namespace strandcast
