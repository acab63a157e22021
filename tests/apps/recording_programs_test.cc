// The programs as a user runs them: streams are recorded, replayed, resimulated and drawn.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>

#include "io/groom_file.h"
#include "tests/apps/program_fixture.h"
#include "tests/transport/dds_domain.h"

namespace strandcast {
namespace {

class RecordingPrograms : public ProgramFixture {
 protected:
  const std::string domain_ = std::to_string(testDomain(0));
};

TEST_F(RecordingPrograms, ARunIsRecordedReplayedAndRepeatedBitForBit) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const std::string run_file = (folder_ / "run.rec").string(), network = " --domain " + domain_;
  const pid_t daemon = start({daemon_, "--scene", "wavy", "--strands", "60", "--motion", "shake", "--backend",
                              "simd", "--domain", domain_, "--quiet", "--record", run_file},
                             "daemon.txt");
  ASSERT_EQ(run(program_ + " ctl wind 3 0 0 --timeout 60" + network).exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl set time_step 0.01" + network).exit_code, 0);
  EXPECT_EQ(
      run(program_ + " ctl fan add spot cone 0 0 0.6 --direction 0 0 -1 --length 1" + network).exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl fan move spot 0.5 0 0.6 --speed 9 --seconds 1" + network).exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl motion nod" + network).exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl pause" + network).exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl step 500" + network).exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl go" + network).exit_code, 0);
  const std::string live = (folder_ / "live.rec").string();
  const Outcome recorded =
      run(program_ + " record " + live + " --seconds 0.5 --codec float32 --json" + network);
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  EXPECT_EQ(nlohmann::json::parse(recorded.out)["frames_skipped"], 0);
  kill(daemon, SIGKILL);
  wait(daemon);

  const Outcome again = run(program_ + " replay " + run_file + " --resimulate --json");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  const nlohmann::json report = nlohmann::json::parse(again.out);
  EXPECT_GT(report["frames"], 30);
  EXPECT_EQ(report["frames_different"], 0);
  EXPECT_EQ(report["inputs"], 8);
  EXPECT_NE(again.err.find("not closed"), std::string::npos) << "the daemon was killed: " << again.err;
  const Outcome no_source = run(program_ + " replay " + live + " --resimulate");
  EXPECT_EQ(no_source.exit_code, 2) << no_source.out;

  const Outcome check = run(program_ + " replay " + live + " --check --json");
  EXPECT_EQ(check.exit_code, 0) << check.err;
  EXPECT_EQ(nlohmann::json::parse(check.out)["frames_different"], 0);
  EXPECT_EQ(nlohmann::json::parse(check.out)["cut"], 0);

  start({program_, "replay", live, "--loop", "--domain", domain_}, "replay.txt");
  const std::string second = (folder_ / "second.rec").string();
  const Outcome copied = run(program_ + " record " + second + " --seconds 0.8 --json" + network);
  EXPECT_EQ(copied.exit_code, 0) << copied.err;
  EXPECT_GT(nlohmann::json::parse(copied.out)["frames"], 40);
  EXPECT_EQ(run(program_ + " ctl set speed 0.5" + network).exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl stop" + network).exit_code, 0);
}

// Recordings have no colliders, so the body's field is baked; here there is no cache for it. A small body,
// from a log.
TEST_F(RecordingPrograms, HairIsKeptOutOfTheBodyOfARecording) {
  if (!STRANDCAST_GL) GTEST_SKIP() << "built without OpenGL";
  StrandSet strands;
  strands.append(
      std::array<Vec3, 3>{Vec3(0.05f, 0.1f, 0.05f), Vec3(0.05f, 0.13f, 0.05f), Vec3(0.05f, 0.16f, 0.05f)});
  writeGroom(folder_ / "groom.tfx", strands);
  const std::string take = (folder_ / "take.rec").string(),
                    log = " --transport lcm --lcm-url 'file://" + (folder_ / "take.log").string();
  const Outcome recorded = run(program_ + " record " + take + " --groom " + (folder_ / "groom.tfx").string() +
                               " --body " + write("cube.obj", kCube).string() +
                               " --unit-meters 1 --body-contact spheres --backend reference --seconds 0.5");
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  const Outcome cast = run(program_ + " replay " + take + log + "?mode=w'");
  if (cast.err.find("LCM cannot") != std::string::npos || cast.err.find("LCM is not") != std::string::npos)
    GTEST_SKIP() << cast.err;
  ASSERT_EQ(cast.exit_code, 0) << cast.err;
  const Outcome drawn = run("env -u HOME -u XDG_CACHE_HOME " + program_ +
                            " render --keep-out on --frames 1 --width 48 --height 48 --hairs 300 --out " +
                            (folder_ / "pictures").string() + log + "?mode=r'");
  if (drawn.err.find("OpenGL") != std::string::npos) GTEST_SKIP() << drawn.err;
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_NE(drawn.err.find("bakes the body's field again"), std::string::npos) << drawn.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "pictures" / "frame_0000.png"));
}

TEST_F(RecordingPrograms, ATakeOutlivesARecordThatHearsNothing) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const std::filesystem::path take = write("take.rec", "an old take");
  const std::string record = program_ + " record " + take.string() + " --domain " + domain_;
  const Outcome silent = run(record + " --timeout 0.3");
  EXPECT_EQ(silent.exit_code, 2);
  EXPECT_NE(silent.err.find("no frame arrived"), std::string::npos) << silent.err;
  EXPECT_EQ(contents(take), "an old take");
  EXPECT_EQ(run("timeout -s INT 1 " + record).exit_code, 124) << "by timeout's own convention";
  EXPECT_EQ(contents(take), "an old take");
}

TEST_F(RecordingPrograms, WhatAStreamLacksIsSaid) {
  const std::string log = " --transport lcm --lcm-url 'file://" + (folder_ / "a.log").string();
  const Outcome cast = run(daemon_ +
                           " --scene straight --strands 20 --backend reference --body-contact "
                           "spheres --quiet --duration 0.5" +
                           log + "?mode=w'");
  if (cast.err.find("LCM cannot") != std::string::npos || cast.err.find("LCM is not") != std::string::npos)
    GTEST_SKIP() << cast.err;
  ASSERT_EQ(cast.exit_code, 0) << cast.err;
  const Outcome early = run(program_ + " record " + (folder_ / "a.rec").string() +
                            " --seconds 60 --timeout 2 --json" + log + "?mode=r&speed=4'");
  EXPECT_EQ(early.exit_code, 1) << early.err;
  EXPECT_NE(early.err.find("the stream ended after"), std::string::npos) << early.err;
  EXPECT_GT(nlohmann::json::parse(early.out)["frames"], 0) << "what came is kept";

  if (!std::filesystem::exists("/dev/full")) return;
  const Outcome lost = run(program_ + " replay " + (folder_ / "a.rec").string() +
                           " --speed 100 --transport lcm --lcm-url 'file:///dev/full?mode=w'");
  EXPECT_EQ(lost.exit_code, 1) << lost.err;
  EXPECT_NE(lost.err.find("the LCM log cannot be written"), std::string::npos) << lost.err;
}

TEST_F(RecordingPrograms, GridsOfARecordingAreDrawn) {
  if (!STRANDCAST_GL || !STRANDCAST_DDS) GTEST_SKIP() << "built without OpenGL or without DDS";
  const std::string file = (folder_ / "run.rec").string();
  std::filesystem::create_directory(folder_ / "elsewhere");
  const Outcome cast = run("cd " + (folder_ / "elsewhere").string() + " && " + daemon_ +
                           " --scene straight --strands 100 --vertices 8 --backend simd --motion shake "
                           "--set volume_stiffness=1 --duration 0.6 --quiet --record-grids 2 --record " +
                           file + " --domain " + domain_);
  ASSERT_EQ(cast.exit_code, 0) << cast.err;
  const std::string replay = "cd " + folder_.string() + " && " + program_ + " replay " + file +
                             " --json --fps 1000 --size 64 --out slices";
  const Outcome drawn = run(replay + " --resimulate --show density");
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  const nlohmann::json report = nlohmann::json::parse(drawn.out);
  EXPECT_EQ(report["frames_different"], 0) << "the grids are those of the recorded simulation";
  EXPECT_GT(report["full"], 0) << "kg/m^3";
  EXPECT_EQ(report["frames_drawn"], report["frames"]);
  const std::set<std::filesystem::path> pictures(std::filesystem::directory_iterator(folder_ / "slices"), {});
  ASSERT_EQ(report["frames"], pictures.size());
  EXPECT_NE(contents(*pictures.begin()), contents(*pictures.rbegin())) << "the head is shaken";
  const Outcome still = run(replay + " --resimulate --show wind");
  EXPECT_EQ(still.exit_code, 2);
  EXPECT_NE(still.err.find("record a run with --set wind_grid=1"), std::string::npos) << still.err;

  const nlohmann::json stored = nlohmann::json::parse(run(replay + " --show density").out);
  EXPECT_EQ(stored["frames_drawn"], (report["frames"].get<int>() + 1) / 2) << "of every second frame";
  EXPECT_GT(stored["full"], 0.5 * report["full"].get<double>()) << "where cells' middles are";
  EXPECT_LE(stored["full"], 1.001 * report["full"].get<double>());
  const Outcome none = run(replay + " --show wind");
  EXPECT_EQ(none.exit_code, 2) << "no wind was on a grid";
  EXPECT_NE(none.err.find("record a run with --set wind_grid=1"), std::string::npos) << none.err;
}

TEST_F(RecordingPrograms, FramesWhoseWindIsOnNoGridAreNotDrawn) {
  if (!STRANDCAST_GL || !STRANDCAST_DDS) GTEST_SKIP() << "built without OpenGL or without DDS";
  const std::string file = (folder_ / "run.rec").string(), network = " --domain " + domain_;
  const pid_t daemon =
      start({daemon_, "--scene",       "straight",       "--strands",   "60",       "--vertices",
             "8",     "--backend",     "simd",           "--domain",    domain_,    "--quiet",
             "--set", "wind=3,0,0",    "--set",          "wind_grid=1", "--set",    "volume_stiffness=1",
             "--set", "grid_cells=16", "--record-grids", "1",           "--record", file},
            "daemon.txt");
  // Recorded in turn: both grids, only the grid of forces between hairs, none, and the wind grid.
  for (const char* change : {"set wind_grid 0", "set volume_stiffness 0", "set wind_grid 1", "stop"}) {
    ASSERT_EQ(run(program_ + " ctl " + change + " --timeout 60" + network).exit_code, 0) << change;
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  EXPECT_EQ(wait(daemon), 0);

  const std::string replay = program_ + " replay " + file + " --json --fps 1000 --size 64 --out " +
                             (folder_ / "slices").string() + " --show ";
  const Outcome check = run(program_ + " replay " + file + " --check --json");
  ASSERT_EQ(check.exit_code, 0) << check.err;
  const nlohmann::json held = nlohmann::json::parse(check.out);
  for (const char* show : {"wind", "pressure"}) {
    const Outcome stored = run(replay + show);
    ASSERT_EQ(stored.exit_code, 0) << stored.err;
    const nlohmann::json report = nlohmann::json::parse(stored.out);
    const int without = report["frames_without"], drawn = report["frames_drawn"];
    EXPECT_GE(without, 1);
    EXPECT_EQ(drawn + without, held["grids"]) << "those after are drawn, too";
    const Outcome again = run(replay + show + " --resimulate");
    ASSERT_EQ(again.exit_code, 0) << again.err;
    const nlohmann::json simulated = nlohmann::json::parse(again.out);
    EXPECT_GE(simulated["frames_without"], without + 1) << "no old wind where nothing is on a grid";
    EXPECT_EQ(simulated["frames_drawn"], drawn);
    EXPECT_EQ(simulated["frames_different"], 0);
  }
}

TEST_F(RecordingPrograms, ASceneIsRecordedWithItsGrids) {
  if (!STRANDCAST_GL) GTEST_SKIP() << "built without OpenGL";
  const std::string file = (folder_ / "scene.rec").string();
  const std::string record = program_ + " record " + file +
                             " --scene straight --strands 60 --backend simd --set grid_cells=16 --json "
                             "--seconds 0.5";
  const Outcome plain = run(record);
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_GE(nlohmann::json::parse(plain.out)["frames"], 31) << "at 60 a second";
  const Outcome none = run(program_ + " replay " + file + " --show wind --out " + (folder_ / "no").string());
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("has no grids"), std::string::npos) << none.err;

  const Outcome with = run(record + " --set wind_grid=1 --set wind=3,0,0 --grids 10");
  ASSERT_EQ(with.exit_code, 0) << with.err;
  EXPECT_EQ(nlohmann::json::parse(with.out)["grids"], 4) << "of frames 0, 10, 20 and 30";
  const Outcome check = run(program_ + " replay " + file + " --check --json");
  EXPECT_EQ(check.exit_code, 0) << check.err;
  EXPECT_EQ(nlohmann::json::parse(check.out)["grids"], 4);
  const Outcome drawn = run(program_ + " replay " + file + " --show wind --size 64 --from 0.1 --json --out " +
                            (folder_ / "wind").string());
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_EQ(nlohmann::json::parse(drawn.out)["frames_drawn"], 3);
  EXPECT_GT(nlohmann::json::parse(drawn.out)["full"], 2.5) << "m/s";
  EXPECT_TRUE(std::filesystem::exists(folder_ / "wind" / "frame_0002.png"));

  const Outcome network = run(program_ + " record " + file + " --grids 10");
  EXPECT_EQ(network.exit_code, 2);
  EXPECT_NE(network.err.find("--record-grids"), std::string::npos) << network.err;
}

TEST_F(RecordingPrograms, ALogOfLcmsToolsIsDrawn) {
  if (std::system("command -v lcm-logger lcm-logplayer >/dev/null") != 0) GTEST_SKIP() << "no lcm-logger";
  const std::string log = (folder_ / "session.lcm").string(),
                    url = "udpm://239.255.76.67:" + std::to_string(7667 + std::stoi(domain_)) + "?ttl=0";
  const pid_t logger = start({"/usr/bin/env", "lcm-logger", "-q", "--lcm-url=" + url, log}, "logger.txt");
  // A small body: LCM's tools have small receive buffers, and lost parts are repeated only once a second.
  StrandSet strands;
  for (int i = 0; i < 40; ++i) {
    const float x = 0.0025f * static_cast<float>(i);
    strands.append(std::array<Vec3, 3>{Vec3(x, 0.1f, 0.05f), Vec3(x, 0.13f, 0.05f), Vec3(x, 0.16f, 0.05f)});
  }
  writeGroom(folder_ / "groom.tfx", strands);
  const Outcome cast = run(daemon_ + " --groom " + (folder_ / "groom.tfx").string() + " --body " +
                           write("cube.obj", kCube).string() +
                           " --unit-meters 1 --transport lcm --quiet --duration 2 --domain " + domain_);
  kill(logger, SIGINT);
  wait(logger);
  if (cast.err.find("LCM cannot") != std::string::npos || cast.err.find("LCM is not") != std::string::npos)
    GTEST_SKIP() << cast.err;
  ASSERT_EQ(cast.exit_code, 0) << cast.err;
  ASSERT_GT(std::filesystem::file_size(log), 30000u);

  const pid_t player = start({"/usr/bin/env", "lcm-logplayer", "--lcm-url=" + url, log}, "player.txt");
  const std::string network = " --transport lcm --domain " + domain_ + " --timeout 8";
  const Outcome drawn =
      run(program_ + " render --json --frames 3 --fps 10 --width 96 --height 64 --hairs 300 --out " +
          (folder_ / "pictures").string() + network);
  if (!STRANDCAST_GL || drawn.err.find("OpenGL") != std::string::npos) {
    kill(player, SIGKILL);
    GTEST_SKIP() << drawn.err;
  }
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_EQ(nlohmann::json::parse(drawn.out)["strands"], 40);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "pictures" / "frame_0002.png"));
}

}  // namespace
}  // namespace strandcast
