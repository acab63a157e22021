#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "apps/channel.h"
#include "apps/console.h"
#include "apps/interrupt.h"
#include "apps/picture_options.h"
#include "apps/verbs.h"
#include "core/error.h"

namespace strandcast {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Options {
  std::unique_ptr<SettingsOptions> settings;
  PictureOptions picture;
  double timeout = 20;  // s
  std::string playout = "smooth";
};

/// A GLFW window with an OpenGL 4.5 context, and the mouse turned into an orbit.
class Window {
 public:
  Window(const PictureOptions& picture)
      : azimuth_(picture.azimuth), elevation_(picture.elevation), zoom_(picture.zoom) {
    if (glfwInit() == GLFW_FALSE) throw windowError();
    glfwWindowHint(GLFW_CONTEXT_CREATION_API,
                   GLFW_EGL_CONTEXT_API);  // as the GPU backend's, which hands it back
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ =
        glfwCreateWindow(picture.settings.width, picture.settings.height, "Strandcast", nullptr, nullptr);
    if (window_ == nullptr) {
      const Error error = windowError();
      glfwTerminate();
      throw error;
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window_, this);
    glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double dy) {
      auto* self = static_cast<Window*>(glfwGetWindowUserPointer(w));
      self->zoom_ = std::clamp(self->zoom_ * std::exp(0.1 * dy), 0.05, 50.0);
    });
  }
  ~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  bool open() const { return glfwWindowShouldClose(window_) == GLFW_FALSE && !pressed(GLFW_KEY_ESCAPE); }
  bool pressed(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }
  void poll() {
    glfwPollEvents();
    double x = 0, y = 0;
    glfwGetCursorPos(window_, &x, &y);
    if (glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
      azimuth_ -= 0.4 * (x - last_x_);
      elevation_ = std::clamp(elevation_ + 0.4 * (y - last_y_), -89.0, 89.0);
    }
    last_x_ = x;
    last_y_ = y;
  }
  Camera camera(const Box& box) const {
    return orbit(box, static_cast<float>(azimuth_ * kPi / 180), static_cast<float>(elevation_ * kPi / 180),
                 static_cast<float>(zoom_));
  }
  void show(Renderer& renderer, const std::string& title) {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    renderer.present(width, height);
    glfwSetWindowTitle(window_, title.c_str());
    glfwSwapBuffers(window_);
  }

 private:
  static Error windowError() {
    const char* text = nullptr;
    glfwGetError(&text);
    return Error("no window can be opened", text != nullptr ? text : "GLFW",
                 "run it on a desktop with OpenGL 4.5, or use `strandcast render`");
  }

  GLFWwindow* window_ = nullptr;
  double azimuth_, elevation_, zoom_;
  double last_x_ = 0, last_y_ = 0;
};

int view(const Options& o) {
  const Settings settings = o.settings->resolve();
  Window window(o.picture);
  Stream stream(settings, o.settings->namesScene(), o.timeout);
  Subscriber& subscriber = stream.subscriber();

  FramePlayer player(subscriber, o.playout == "latest" ? Playout::kLatest : Playout::kSmooth);
  Renderer renderer(renderSettings(o.picture));
  std::shared_ptr<const GroomDescription> groom;
  std::shared_ptr<const BodyDescription> body;
  std::shared_ptr<const ColliderSet> colliders;
  Box box;
  const auto start = std::chrono::steady_clock::now();
  auto last = start;
  while (window.open() && !g_interrupted) {
    window.poll();
    const bool is_new = subscriber.groom() != groom;
    if (is_new) {
      groom = subscriber.groom();
      body = subscriber.body();
      setPicture(renderer, *groom, *body);
      box = pictureBox(*groom, *body);
    }
    if (is_new || subscriber.colliders() != colliders) {
      colliders = subscriber.colliders();
      setObstacles(renderer, o.picture, colliders.get(), *body);
    }
    const auto frame = player.next();
    if (!frame) continue;
    renderer.draw(*frame, window.camera(box));
    const auto now = std::chrono::steady_clock::now();
    const double fps = 1 / std::chrono::duration<double>(now - last).count();
    last = now;
    const auto status = subscriber.status();
    window.show(renderer,
                fmt::format("Strandcast: {} on {}, step {:.2f} ms, {:.0f} pictures/s", groom->name,
                            status ? status->backend : "?", status ? status->step_ms_median : 0.0, fps));
    if (settings.duration > 0 && std::chrono::duration<double>(now - start).count() > settings.duration)
      break;
  }
  return g_interrupted ? kExitInterrupted : 0;
}

}  // namespace

Verb addView(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  app.footer(
      "Drag with the left button to orbit, scroll to zoom, Escape ends it.\n"
      "With --scene, --groom or --config the simulation runs inside this process; without, a daemon's stream "
      "is drawn.");
  app.add_option("--timeout", o->timeout, "seconds to wait for a daemon")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  app.add_option("--playout", o->playout,
                 "smooth: even motion, one frame behind; latest: the newest frame as soon as it is there")
      ->check(CLI::IsMember({"smooth", "latest"}))
      ->capture_default_str();
  addPictureOptions(app, o->picture);
  o->settings = std::make_unique<SettingsOptions>(app);
  return [o] { return view(*o); };
}

}  // namespace strandcast
