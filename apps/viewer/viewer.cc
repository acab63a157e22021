// The verb `view`: its options, and the loop of its window.
#include <fmt/format.h>
#include <imgui/imgui.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <future>
#include <memory>
#include <string>

#include "apps/cli/verbs.h"
#include "apps/viewer/panel.h"
#include "apps/viewer/window.h"
#include "core/error.h"
#include "io/image.h"
#include "options/console.h"
#include "options/number_range.h"
#include "options/picture_options.h"
#include "options/picture_scene.h"
#include "options/picture_settings.h"
#include "options/settings.h"
#include "service/stream.h"
#include "transport/subscriber.h"

namespace strandcast {

/// The options of `strandcast view`.
struct ViewerOptions {
  Settings settings;
  bool here = false;  ///< simulate in this process
  PictureOptions picture;
  double timeout = 20;  ///< s, to wait for a daemon
  double max_fps = 0;   ///< pictures per second at most; 0 = the display's rate
  Playout playout = Playout::kSmooth;
  std::string preset_file = "preset.toml";
};

namespace {

using Clock = std::chrono::steady_clock;

/// The picture's rectangle in the window, pixels.
struct Viewport {
  int left, top, width, height;
  float aspect() const { return static_cast<float>(width) / static_cast<float>(height); }
};

/// Keys that send a command or switch a tool.
constexpr int kToolKeys[] = {'1', '2', '3', '4', '5'};

class Viewer {
 public:
  explicit Viewer(const ViewerOptions& options)
      : options_(options),
        window_(windowWidth(options.picture), windowHeight(options.picture), options.max_fps),
        panel_(options.picture, options.preset_file),
        network_(options.settings),
        session_(std::make_unique<ViewerSession>(options.settings, options.here, options.timeout,
                                                 options.playout)),
        renderer_(renderSettings(options.picture)) {
    if (!options.here) network_.listen();
  }

  int run() {
    const auto start = Clock::now();
    auto last = start;
    double per_second = 0;
    while (window_.isOpen() && !g_interrupted) {
      const auto now = Clock::now();
      const double seconds = std::chrono::duration<double>(now - last).count();
      last = now;
      per_second += (1 / std::max(seconds, 1e-4) - per_second) * std::min(1.0, 3 * seconds);
      if (options_.settings.duration > 0 &&
          std::chrono::duration<double>(now - start).count() > options_.settings.duration)
        break;
      session_->checkAlive();
      window_.beginFrame();
      const Viewport view = viewport();
      const PanelRequests requests =
          panel_.draw(*session_, network_, statistics_, static_cast<float>(window_.width()),
                      static_cast<float>(window_.height()));
      finishJoining();
      if (requests.join) startJoining(*requests.join);
      if (requests.single_step) step();
      if (requests.reset) session_->commands().send(CommandKind::kReset, "", {});
      takeKeys();
      takeMouse(view);
      changed_ |= requests.picture_changed;
      applySettings(view);
      window_.clear();
      drawPicture(view);
      if (requests.screenshot || screenshot_asked_) takeScreenshot();
      panel_.measure(*session_, statistics_, per_second);
      window_.endFrame(title(per_second));
    }
    return g_interrupted ? kExitInterrupted : 0;
  }

 private:
  static int windowWidth(const PictureOptions& picture) {
    return picture.settings.width + static_cast<int>(ViewerPanel::kWidth);
  }
  static int windowHeight(const PictureOptions& picture) {
    return picture.settings.height + static_cast<int>(ViewerPanel::kPlotHeight);
  }

  Viewport viewport() const {
    const int left = panel_.shown ? static_cast<int>(ViewerPanel::kWidth) : 0;
    const int bottom = panel_.shown && panel_.plots_shown ? static_cast<int>(ViewerPanel::kPlotHeight) : 0;
    return {left, 0, std::max(window_.width() - left, 16), std::max(window_.height() - bottom, 16)};
  }

  std::string title(double per_second) const {
    const auto groom = session_->subscriber().groom();
    return fmt::format("Strandcast: {}, {:.0f} pictures/s", groom ? groom->name : "no groom", per_second);
  }

  void step() {
    panel_.paused = true;
    session_->commands().send(CommandKind::kPause, "", {1});
    session_->commands().send(CommandKind::kStep, "", {1});
  }

  void takeKeys() {
    if (!window_.keysAreFree()) return;
    const std::vector<int>& keys = window_.pressedKeys();
    const auto pressed = [&](int key) { return std::find(keys.begin(), keys.end(), key) != keys.end(); };
    if (pressed(ViewerWindow::kEscape)) window_.close();
    if (pressed(ViewerWindow::kTab)) panel_.shown = !panel_.shown;
    if (pressed(' ')) {
      panel_.paused = !panel_.paused;
      session_->commands().send(CommandKind::kPause, "", {panel_.paused ? 1.0 : 0.0});
    }
    if (pressed('.')) step();
    if (pressed('R')) session_->commands().send(CommandKind::kReset, "", {});
    if (pressed('P')) screenshot_asked_ = true;
    for (int i = 0; i < 5; ++i)
      if (pressed(kToolKeys[i])) panel_.tool = static_cast<MouseTool>(i);
  }

  /// A button pressed over the picture captures the mouse until it is released.
  void takeMouse(const Viewport& view) {
    const ImGuiIO& io = ImGui::GetIO();
    const PicturePoint mouse{(io.MousePos.x - static_cast<float>(view.left)) / static_cast<float>(view.width),
                             (io.MousePos.y - static_cast<float>(view.top)) / static_cast<float>(view.height),
                             view.aspect()};
    const Camera camera = pictureCamera(panel_.picture, box_);
    const bool free = window_.mouseIsFree();
    if (free && io.MouseWheel != 0)
      panel_.picture.zoom =
          std::clamp(panel_.picture.zoom * std::exp(0.1 * static_cast<double>(io.MouseWheel)), 0.05, 50.0);
    if (free && ImGui::IsMouseClicked(0) && frame_) {
      const MouseTool tool = io.KeyShift ? MouseTool::kPull : io.KeyCtrl ? MouseTool::kTurnHead : panel_.tool;
      orbiting_ = !tool_.press(tool, panel_.hand, camera, *frame_, mouse);
    }
    if (free && ImGui::IsMouseClicked(1)) orbiting_ = true;
    if (!ImGui::IsMouseDown(0) && !ImGui::IsMouseDown(1)) {
      orbiting_ = false;
      if (tool_.isHolding()) tool_.release(session_->commands());
    }
    if (tool_.isHolding()) tool_.drag(camera, mouse, session_->commands());
    // Motion before the press, in the same picture, is not part of the drag.
    if (!orbiting_ || ImGui::IsMouseClicked(0) || ImGui::IsMouseClicked(1)) return;
    panel_.picture.azimuth -= 0.4 * static_cast<double>(io.MouseDelta.x);
    panel_.picture.elevation =
        std::clamp(panel_.picture.elevation + 0.4 * static_cast<double>(io.MouseDelta.y), -89.0, 89.0);
  }

  /// The picture's height comes from the settings, its width from the window.
  void applySettings(const Viewport& view) {
    const int width = std::clamp(
        static_cast<int>(std::lround(static_cast<float>(panel_.picture.settings.height) * view.aspect())), 16,
        16384);
    if (!changed_ && width == panel_.picture.settings.width) return;
    changed_ = false;
    panel_.picture.settings.width = width;
    try {
      renderer_.setSettings(renderSettings(panel_.picture));
      if (scene_.groom && scene_.body) frameScene();
    } catch (const Error& error) {
      panel_.say(error.what());
    }
  }

  void frameScene() { box_ = pictureBox(*scene_.groom, *scene_.body, renderer_.hairReach()); }

  void setObstacles() {
    const auto colliders = session_->subscriber().colliders();
    if (!scene_.body || (colliders && colliders->session != scene_.body->session)) return;
    const bool known = obstacles_set_ && colliders == colliders_;
    if (known || !needsObstacles(panel_.picture, colliders.get())) return;
    obstacles_set_ = true;
    colliders_ = colliders;
    std::vector<HairObstacle> obstacles = hairObstacles(colliders.get(), *scene_.body);
    std::vector<std::shared_ptr<const DistanceField>> fields;
    for (const HairObstacle& obstacle : obstacles) fields.push_back(obstacle.shape.field);
    panel_.setFields(std::move(fields));
    renderer_.setObstacles(std::move(obstacles));
  }

  /// Keeps the last picture until groom and body of a new daemon have both arrived.
  void takeFrame() {
    const auto frame = session_->player().next();
    if (!frame) return;
    if (!scene_.fits(*frame)) {
      const StreamScene now = StreamScene::of(session_->subscriber());
      if (!now.fits(*frame)) return;
      scene_ = now;
      setScene(renderer_, *scene_.groom, *scene_.body, scene_.hairs.get());
      panel_.setFields({});
      obstacles_set_ = false;
      frameScene();
    } else if (const auto hairs = session_->subscriber().hairs(); hairs && hairs != scene_.hairs) {
      scene_.hairs = hairs;  // they came after the groom
      renderer_.setHairs(*hairs);
    }
    frame_ = frame;
  }

  void drawPicture(const Viewport& view) {
    takeFrame();
    try {
      setObstacles();
    } catch (const Error& error) {
      panel_.say(error.what());
    }
    if (!frame_) return;
    const Camera camera = pictureCamera(panel_.picture, box_);
    renderer_.draw(*frame_, camera);
    tellSize(camera, view);
    statistics_ = renderer_.statistics();
    renderer_.present(view.left, window_.height() - view.top - view.height, view.width, view.height);
    if (tool_.isHolding()) markHand(view);
  }

  /// Tells the daemon how large the hair is.
  void tellSize(const Camera& camera, const Viewport& view) {
    session_->subscriber().setPictures(pixelsOfHair(camera, *frame_, view.height), 0);
  }

  /// Draws a ring at the hand.
  void markHand(const Viewport& view) const {
    const auto at = projected(pictureCamera(panel_.picture, box_), tool_.hand(), view.aspect());
    if (!at) return;
    ImGui::GetBackgroundDrawList()->AddCircle(
        {static_cast<float>(view.left) + at->x * static_cast<float>(view.width),
         static_cast<float>(view.top) + at->y * static_cast<float>(view.height)},
        9, IM_COL32(255, 220, 120, 255), 0, 2);
  }

  void takeScreenshot() {
    screenshot_asked_ = false;
    std::string name;
    do name = fmt::format("strandcast_{:04d}.png", screenshots_++);
    while (std::filesystem::exists(name));
    try {
      writePng(name, renderer_.read());
      panel_.say(name + " is written");
    } catch (const Error& error) {
      panel_.say(error.what());
    }
  }

  void startJoining(uint32_t groom_id) {
    if (joining_.valid()) return;
    Settings settings = options_.settings;
    settings.groom_id = groom_id;
    panel_.say(fmt::format("joined groom {}", groom_id));
    joining_ = std::async(std::launch::async, [=, this] {
      return std::make_unique<ViewerSession>(settings, false, options_.timeout, options_.playout);
    });
  }

  void finishJoining() {
    if (!joining_.valid() || joining_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    try {
      session_ = joining_.get();
      scene_ = {};
      frame_.reset();
      panel_.paused = false;
    } catch (const Error& error) {
      panel_.say(error.what());
    }
  }

  const ViewerOptions& options_;
  ViewerWindow window_;
  ViewerPanel panel_;
  NetworkList network_;
  std::unique_ptr<ViewerSession> session_;
  std::future<std::unique_ptr<ViewerSession>> joining_;
  Renderer renderer_;
  RenderStatistics statistics_;
  StreamScene scene_;
  std::shared_ptr<const GuideFrame> frame_;
  Box box_;
  HairTool tool_;
  bool orbiting_ = false, changed_ = false, obstacles_set_ = false, screenshot_asked_ = false;
  std::shared_ptr<const ColliderSet> colliders_;  ///< source of the obstacles
  int screenshots_ = 0;
};

}  // namespace

/// Runs the window until it is closed or settings.duration has passed; returns the program's exit code.
/// Throws Error.
int runViewer(const ViewerOptions& options) { return Viewer(options).run(); }

Verb addView(CLI::App& app) {
  const auto o = std::make_shared<ViewerOptions>();
  const auto settings = std::make_shared<std::unique_ptr<SettingsOptions>>();
  app.footer(
      "Drag with the left button to orbit, scroll to zoom; the panel has everything else. Keys: Space pauses "
      "the simulation, . takes a single step, R resets the hair, P takes a screenshot, 1 to 5 choose what "
      "dragging does (orbit, move head, turn head, pull, comb), Tab hides the panel, Escape quits.\n"
      "With --scene, --groom or --config the simulation runs inside this process; without them, the verb "
      "draws a daemon's stream. For a simulation in this process the panel \"Air\" draws slices through the "
      "grids of wind and hair.");
  app.add_option("--timeout", o->timeout, "seconds to wait for a daemon")
      ->check(finiteRange(0.1, 3600.0))
      ->capture_default_str();
  app.add_option_function<std::string>(
         "--playout",
         [o](const std::string& name) {
           o->playout = name == "latest" ? Playout::kLatest : Playout::kSmooth;
         },
         "smooth: interpolated motion, one frame late; latest: the newest frame on arrival")
      ->check(CLI::IsMember({"smooth", "latest"}))
      ->default_str("smooth");
  app.add_option("--max-fps", o->max_fps, "limit of pictures per second; 0 = the display's refresh rate")
      ->check(finiteRange(0.0, 1000.0))
      ->capture_default_str();
  app.add_option("--preset-file", o->preset_file, "preset that the panel saves and loads")
      ->capture_default_str();
  addPictureOptions(app, o->picture);
  *settings = std::make_unique<SettingsOptions>(app);
  return [o, settings] {
    (*settings)->refuseWithoutScene();
    (*settings)->warnOfUnusedNetwork();
    warnOfUnusedPictureOptions(o->picture);
    o->settings = (*settings)->resolve();
    o->here = (*settings)->namesScene();
    return runViewer(*o);
  };
}

}  // namespace strandcast
