// The window as a user sees it: a daemon, the viewer on a virtual display, and mouse and key events.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <numeric>
#include <thread>
#include <vector>

#include "io/image.h"
#include "options/presets.h"
#include "tests/apps/program_fixture.h"
#include "tests/transport/dds_domain.h"
#include "transport/recording/recording.h"

namespace strandcast {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

bool isInstalled(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

class ViewerWindowTest : public ProgramFixture {
 protected:
  void SetUp() override {
    for (const char* program : {"Xvfb", "xdotool"})
      if (!isInstalled(program)) GTEST_SKIP() << program << " is not installed";
    ProgramFixture::SetUp();
    // Starts Xvfb on a free display, whose number it writes to a file.
    const auto number = folder_ / "display";
    start({"sh", "-c", "exec Xvfb -displayfd 1 -noreset -screen 0 1000x700x24 2>/dev/null"}, "display");
    ASSERT_TRUE(until(seconds(20), [&] {
      return std::filesystem::exists(number) && std::filesystem::file_size(number) > 1;
    }));
    std::string digits;
    std::getline(std::ifstream(number) >> std::ws, digits);
    setenv("DISPLAY", (":" + digits).c_str(), 1);
    ASSERT_TRUE(until(seconds(20), [] {
      return std::system("xdotool getdisplaygeometry >/dev/null 2>&1") == 0;
    })) << "a display that has its number may not be open yet";
  }

  static bool until(seconds patience, const std::function<bool()>& ready) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (!ready()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(milliseconds(50));
    }
    return true;
  }
  /// Sends events, then waits for a few pictures.
  static void input(const std::string& words) {
    EXPECT_EQ(std::system(("xdotool " + words).c_str()), 0) << words;
    std::this_thread::sleep_for(milliseconds(900));
  }
  /// Holds a key for a few pictures.
  static void press(const std::string& key) {
    input("keydown " + key);
    input("keyup " + key);
  }
  /// Presses, drags in steps and releases; window pixels.
  static void drag(int x, int y, int to_x, int to_y) {
    input("mousemove " + std::to_string(x) + " " + std::to_string(y));
    input("mousedown 1");
    for (int step = 1; step <= 3; ++step)
      input("mousemove " + std::to_string(x + (to_x - x) * step / 3) + " " +
            std::to_string(y + (to_y - y) * step / 3));
    input("mouseup 1");
  }
};

/// The commands in a daemon's recording, by kind.
std::map<CommandKind, std::vector<Command>> commandsOf(const std::filesystem::path& file) {
  std::map<CommandKind, std::vector<Command>> found;
  Recording recording(file);
  RecordedFrame frame;
  for (uint64_t n = 0; n < recording.frames(); ++n) {
    recording.read(n, frame);
    for (const Command& command : frame.inputs) found[command.kind].push_back(command);
  }
  return found;
}

// The panel is 420 pixels wide; the picture is beside it, with the head in its middle.
constexpr int kPanel = 420, kHairX = kPanel + 122, kHairY = 190;

TEST_F(ViewerWindowTest, MouseAndKeysReachTheDaemonAndTheDisk) {
  const std::string domain = std::to_string(testDomain(1));
  const pid_t daemon =
      start({daemon_, "--scene", "straight", "--strands", "60", "--vertices", "10", "--motion", "still",
             "--backend", "reference", "--quiet", "--record", "daemon.rec", "--domain", domain},
            "daemon.log");
  const pid_t viewer =
      start({program_,       "view",  "--width",    "320", "--height",  "320", "--hairs",      "400",
             "--hair-width", "0.001", "--segments", "8",   "--samples", "1",   "--shadow-map", "64",
             "--shadows",    "off",   "--max-fps",  "6",   "--domain",  domain},
            "viewer.log");
  ASSERT_TRUE(until(seconds(30), [] {
    return std::system("xdotool search --name 'Strandcast: straight' >/dev/null 2>&1") == 0;
  })) << "the window shows the daemon's groom";
  std::this_thread::sleep_for(seconds(2));

  input("mousemove 600 100 key p");
  ASSERT_TRUE(until(seconds(10), [&] { return std::filesystem::exists(folder_ / "strandcast_0000.png"); }));
  std::this_thread::sleep_for(milliseconds(300));
  const Image before = readPng(folder_ / "strandcast_0000.png");
  EXPECT_EQ(before.height, 320);

  drag(600, 100, 690, 100);  // orbits
  input("key p");
  ASSERT_TRUE(until(seconds(10), [&] { return std::filesystem::exists(folder_ / "strandcast_0001.png"); }));
  std::this_thread::sleep_for(milliseconds(300));
  EXPECT_NE(readPng(folder_ / "strandcast_0001.png").rgb, before.rgb);
  drag(690, 100, 600, 100);  // and back

  // In the panel: finds a parameter and types a value.
  input("mousemove 200 155 click 1");
  input("type air_drag");
  input("mousemove 235 203 keydown ctrl");
  input("mousedown 1");
  input("mouseup 1");
  input("keyup ctrl");
  input("type 7");
  press("Return");

  input("mousemove 600 100 key 4");
  drag(kHairX, kHairY, kHairX - 40, kHairY - 20);  // pulls
  input("key 2");
  drag(600, 100, 640, 100);  // moves the head
  input("key space");
  input("key period");
  input("key space");
  input("mousemove 310 36 click 1");  // record
  std::this_thread::sleep_for(seconds(1));
  input("click 1");

  input("mousemove 600 100 key Escape");
  EXPECT_EQ(wait(viewer), 0);
  kill(daemon, SIGINT);
  wait(daemon);

  const auto commands = commandsOf(folder_ / "daemon.rec");
  const auto of = [&](CommandKind kind) {
    const auto found = commands.find(kind);
    return found == commands.end() ? std::vector<Command>{} : found->second;
  };
  const std::vector<Command> set = of(CommandKind::kSetParameter), pulls = of(CommandKind::kPull),
                             heads = of(CommandKind::kHeadPose), pauses = of(CommandKind::kPause);
  ASSERT_FALSE(set.empty());
  EXPECT_EQ(set.back().name, "air_drag");
  EXPECT_EQ(set.back().values, std::vector<double>{7});
  ASSERT_GE(pulls.size(), 2u);
  EXPECT_EQ(pulls.front().values.size(), 8u);
  EXPECT_TRUE(pulls.back().values.empty()) << "lets go in the end";
  ASSERT_FALSE(heads.empty());
  EXPECT_NE(heads.back().values[0], 0);
  ASSERT_GE(pauses.size(), 3u);
  EXPECT_EQ(pauses.front().values, std::vector<double>{1});
  EXPECT_EQ(pauses.back().values, std::vector<double>{0});
  EXPECT_EQ(of(CommandKind::kStep).size(), 1u);
  EXPECT_GT(Recording(folder_ / "take.rec").frames(), 5u);
}

TEST_F(ViewerWindowTest, PresetsAreSavedAndLoadedAndAnotherDaemonIsJoined) {
  const std::string domain = std::to_string(testDomain(2));
  int groom_id = 0;
  for (const std::string scene : {"straight", "wavy"})
    start({daemon_, "--scene", scene, "--groom-id", std::to_string(++groom_id), "--strands", "60",
           "--vertices", "10", "--motion", "still", "--backend", "reference", "--quiet", "--domain", domain,
           "--set", "air_drag=3.5"},
          scene + ".log");
  const pid_t viewer =
      start({program_,    "view",         "--width",   "320",        "--height", "440",       "--hairs",
             "400",       "--hair-width", "0.001",     "--segments", "8",        "--samples", "1",
             "--shadows", "off",          "--max-fps", "6",          "--domain", domain},
            "viewer.log");
  const auto shows = [](const std::string& groom) {
    return std::system(("xdotool search --name 'Strandcast: " + groom + "' >/dev/null 2>&1").c_str()) == 0;
  };
  ASSERT_TRUE(until(seconds(30), [&] { return shows("straight"); }));
  std::this_thread::sleep_for(seconds(2));

  const auto file = folder_ / "preset.toml";
  const auto saved = [&] {
    PictureOptions picture;
    readPreset(file, picture);
    return picture;
  };
  const auto air_drag = [&] {
    PictureOptions picture;
    for (const auto& [name, values] : readPreset(file, picture))
      if (name == "air_drag") return values.at(0);
    return -1.0;
  };
  // The panel with its first group closed: headers are 24 pixels apart, and the presets' buttons are below
  // their header.
  const std::string presets = "mousemove 150 419 click 1", save = "mousemove 30 470 click 1",
                    load = "mousemove 82 470 click 1";
  input("mousemove 150 179 click 1");
  input(presets);
  input("mousemove 700 60 click 1");  // a motion that ends in a click must not orbit
  input(save);
  ASSERT_TRUE(until(seconds(10), [&] { return std::filesystem::exists(file); }));
  EXPECT_EQ(saved().azimuth, 25);
  EXPECT_EQ(air_drag(), 3.5) << "as the daemon tells it";
  ASSERT_EQ(std::system((program_ + " ctl set air_drag 4.5 --domain " + domain).c_str()), 0);
  std::filesystem::remove(file);
  input(save);
  ASSERT_TRUE(until(seconds(10), [&] { return std::filesystem::exists(file); }));
  EXPECT_EQ(air_drag(), 4.5) << "as another client has set it";
  PictureOptions other = saved();
  other.azimuth = 90;
  other.settings.lights[0].kind = LightKind::kSpot;
  writePreset(file, {}, other);
  input(load);
  std::filesystem::remove(file);
  input(save);
  ASSERT_TRUE(until(seconds(10), [&] { return std::filesystem::exists(file); }));
  EXPECT_EQ(saved().azimuth, 90);
  EXPECT_EQ(saved().settings.lights[0].kind, LightKind::kSpot);

  input(presets);
  input("mousemove 150 443 click 1");  // the network; the second daemon is two lines below the first
  input("mousemove 60 500 click 1");
  EXPECT_TRUE(until(seconds(20), [&] { return shows("wavy"); }));

  const auto brightness = [&](const std::string& name) {
    input("mousemove 700 60 click 1");
    input("key p");
    EXPECT_TRUE(until(seconds(10), [&] { return std::filesystem::exists(folder_ / name); }));
    std::this_thread::sleep_for(milliseconds(300));
    const Image image = readPng(folder_ / name);
    return std::accumulate(image.rgb.begin(), image.rgb.end(), 0.0) / static_cast<double>(image.rgb.size());
  };
  const double one_light = brightness("strandcast_0000.png");
  input("mousemove 200 155 click 1");
  input("type light-color");
  input("mousemove 113 227 click 1");  // adds another
  EXPECT_GT(brightness("strandcast_0001.png"), one_light + 5);
  input("mousemove 700 60 key Escape");
  EXPECT_EQ(wait(viewer), 0);
}

}  // namespace
}  // namespace strandcast
