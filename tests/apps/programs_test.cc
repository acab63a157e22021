// The programs as a user runs them, each on its own: exit codes, one-line errors, files and pictures.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "io/distance_field_file.h"
#include "io/file_bytes.h"
#include "io/groom_file.h"
#include "tests/apps/program_fixture.h"
#include "tests/io/sample_files.h"

namespace strandcast {
namespace {

using Programs = ProgramFixture;

TEST_F(Programs, HelpTeachesAndExitsWithZero) {
  for (const char* words : {" --help", " info --help", " convert --help", " check --help", " bake --help",
                            " render --help", " compare --help", " ctl --help", " record --help",
                            " replay --help", " keys --help", " validate --help"}) {
    const Outcome r = run(program_ + words);
    EXPECT_EQ(r.exit_code, 0) << words << r.err;
    EXPECT_GT(r.out.size(), 200u) << words;
  }
  const Outcome r = run(daemon_ + " --help");
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_NE(r.out.find("air_drag"), std::string::npos) << "parameters are named with their units";
}

TEST_F(Programs, BadInputIsOneLineAndExitCodeTwo) {
  write("empty.tfx", "");
  write("short.tfx", std::string("\0\0\x80\x40", 4));
  write("noise.hair", "HAIRHAIRHAIRHAIR");
  write("nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n");
  write("points.obj", "v 0 0 0\nv 1 0 0\n");
  write("cube.obj", kCube);
  write("bad.toml", "[daemon]\nspeed = 3\n");
  for (const std::string& command :
       {program_ + " info " + (folder_ / "empty.tfx").string(),
        program_ + " info " + (folder_ / "short.tfx").string(),
        program_ + " info " + (folder_ / "noise.hair").string(),
        program_ + " info " + (folder_ / "absent.tfx").string(),
        program_ + " info " + folder_.string(),
        program_ + " info",
        program_ + " bake " + (folder_ / "absent.obj").string(),
        program_ + " bake " + (folder_ / "nan.obj").string() + " --no-cache",
        program_ + " bake " + (folder_ / "points.obj").string() + " --no-cache",
        program_ + " bake " + (folder_ / "cube.obj").string() + " --no-cache --unit-meters 1 --cell 1e-5",
        program_ + " bake " + (folder_ / "cube.obj").string() + " --no-cache --unit-meters 1 --memory 1",
        program_ + " check",
        program_ + " check " + (folder_ / "empty.tfx").string() + " " + (folder_ / "cube.obj").string(),
        program_ + " check a.tfx b.tfx",
        program_ + " check a.tfx head.obj other.obj",
        program_ + " check a.tfx head.obj walk more",
        program_ + " check a.tfx head.obj --groom b.tfx",
        program_ + " check a.tfx head.obj --picture check.jpg",
        program_ + " validate chemistry",
        program_ + " replay " + (folder_ / "absent.rec").string(),
        program_ + " replay " + (folder_ / "cube.obj").string() + " --check",
        program_ + " validate physics --only 'no such case'",
        program_ + " validate cantilever --solver magic --backend reference",
        program_ + " convert " + (folder_ / "empty.tfx").string() + " " + (folder_ / "x.hair").string(),
        daemon_ + " --config " + (folder_ / "bad.toml").string(),
        program_ + " keys " + folder_.string(),
        program_ + " keys ''",
        program_ + " ctl stop --keys " + folder_.string(),
        program_ + " ctl stop --profile secure",
        program_ + " ctl stop --profile secure --transport lcm",
        program_ + " ctl stop --profile secure --keys " + folder_.string(),
        daemon_ + " --scene bald",
        daemon_ + " --groom " + (folder_ / "short.tfx").string(),
        daemon_ + " --set air_drag=fast",
        daemon_ + " --set air_darg=1",
        daemon_ + " --motion moonwalk --duration 1",
        program_ + " render --transport lcm --lcm-url 'file://" + (folder_ / "empty.tfx").string() +
            "?mode=w'",
        daemon_ + " --scene straight --strands 20 --record '' --record-grids 1 --duration 1"}) {
    const Outcome r = run(command);
    EXPECT_EQ(r.exit_code, 2) << command << "\n" << r.err;
    EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << command << "\n" << r.err;
    EXPECT_EQ(r.err.rfind("error: ", 0), 0u) << r.err;
  }
  EXPECT_EQ(run(program_ + " fly").exit_code, 2);
  EXPECT_EQ(run(daemon_ + " --rate zero").exit_code, 2);
}

TEST_F(Programs, CheckSaysWhetherAShowIsReady) {
  write("cube.obj", kCube);
  std::string hair, lines;
  for (int s = 0; s < 12; ++s) {  // on the top of the cube
    lines += "l";
    for (int i = 0; i < 5; ++i) {
      hair += "v " + std::to_string(0.02 + 0.02 * (s % 4)) + ' ' + std::to_string(0.1 + 0.02 * i) + ' ' +
              std::to_string(0.03 + 0.02 * (s / 4)) + '\n';
      lines += ' ' + std::to_string(5 * s + i + 1);
    }
    lines += '\n';
  }
  write("hair.obj", hair + lines);
  const std::string command = "XDG_CACHE_HOME=" + folder_.string() + " " + program_ + " check " +
                              (folder_ / "hair.obj").string() + " ";
  const std::string cube = (folder_ / "cube.obj").string(), as_said = " --unit-meters 1 --backend simd";
  const Outcome good = run(command + cube + as_said + " --json");
  ASSERT_EQ(good.exit_code, 0) << good.out << good.err;
  const nlohmann::json report = nlohmann::json::parse(good.out);
  EXPECT_EQ(report["faults"], 0);
  EXPECT_NE(report["verdict"], "not ready");
  EXPECT_EQ(report["body"], cube);
  EXPECT_EQ(report["cost"]["strands"], 12);
  EXPECT_GT(report["cost"]["bytes_per_frame"], 0);
  EXPECT_TRUE(report["picture"].is_null());
  for (const char* key : {"check", "severity", "what", "number", "unit", "where", "remedy"})
    EXPECT_TRUE(report["results"][0].contains(key)) << key;

  // The body a hundredth as large: not ready, with the option that helps. Nothing is simulated.
  const Outcome bad = run(command + "--body " + cube + as_said + " --body-unit-meters 0.01 --json");
  ASSERT_EQ(bad.exit_code, 1) << bad.out << bad.err;
  const nlohmann::json faulty = nlohmann::json::parse(bad.out);
  EXPECT_EQ(faulty["verdict"], "not ready");
  EXPECT_TRUE(faulty["cost"].is_null());
  bool is_answered = false;
  for (const nlohmann::json& row : faulty["results"])
    is_answered |= row["check"] == "scale" &&
                   row["remedy"].get<std::string>().find("--body-unit-meters 1?") != std::string::npos;
  EXPECT_TRUE(is_answered) << bad.out;

  // A table, without a body, and a picture where there is OpenGL.
  const Outcome alone =
      run(command + "--unit-meters 1 --no-cost --picture " + (folder_ / "check.png").string());
  EXPECT_EQ(alone.exit_code, 0) << alone.err;
  EXPECT_NE(alone.out.find("verdict: ready with warnings"), std::string::npos) << alone.out;
  EXPECT_EQ(std::filesystem::exists(folder_ / "check.png"), alone.err.find("no picture") == std::string::npos)
      << alone.err;
}

TEST_F(Programs, ValidateExitsWithOneWhenACaseFails) {
  const std::string command =
      program_ + " validate cantilever --backend reference --only 'gamma=10 vertices=32 rate' --json";
  const Outcome good = run(command);
  EXPECT_EQ(good.exit_code, 0) << good.err;
  const nlohmann::json rod = nlohmann::json::parse(good.out);
  EXPECT_EQ(rod["solver"], "rod");
  EXPECT_EQ(rod["name"], "cantilever");
  EXPECT_EQ(rod["pass"], true);
  EXPECT_EQ(rod["passed"], rod["results"].size());
  for (const char* key : {"case", "value", "truth", "error", "limit", "unit", "pass"})
    EXPECT_TRUE(rod["results"][0].contains(key)) << key;
  const Outcome bad = run(command + " --solver gauss_seidel");
  EXPECT_EQ(bad.exit_code, 1) << bad.err;
  EXPECT_GT(nlohmann::json::parse(bad.out)["failed"], 0);
  const Outcome own =
      run(program_ + " validate cantilever --backend reference --gamma 3.7 --vertices 40 --dt 0.002 --json");
  EXPECT_EQ(own.exit_code, 0) << own.err;
  EXPECT_EQ(nlohmann::json::parse(own.out)["results"][0]["case"], "gamma=3.7 vertices=40");
  EXPECT_EQ(run(program_ + " validate cantilever --gamma -1").exit_code, 2);
  EXPECT_EQ(run(program_ + " validate physics --gamma 1").exit_code, 2);
  const Outcome list = run(program_ + " validate physics --list");
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_NE(list.out.find("hung helix"), std::string::npos);
}

TEST_F(Programs, CompareTellsTheSolversApart) {
  if (!STRANDCAST_GL) GTEST_SKIP() << "built without OpenGL";
  const std::string command = program_ +
                              " compare --scene straight --strands 60 --backend simd --set air_drag=5"
                              " --out " +
                              (folder_ / "film").string();
  const Outcome r = run(command + " --no-pictures --json");
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const nlohmann::json report = nlohmann::json::parse(r.out);
  EXPECT_EQ(report["strands"], 60);
  const nlohmann::json rod = report["solvers"].at(0), other = report["solvers"].at(1);
  EXPECT_EQ(rod["solver"], "rod");
  EXPECT_EQ(other["solver"], "gauss_seidel");
  EXPECT_LT(rod["max_stretch_percent"], 0.01);
  EXPECT_GT(other["mean_stretch_percent"], 0.1);
  EXPECT_LT(rod["style_rms_mm"].get<double>(), 0.2 * other["style_rms_mm"].get<double>());
  EXPECT_GE(rod["style_max_mm"], rod["style_rms_mm"]);
  EXPECT_GT(rod["rest_speed_mm_s"], 0);
  EXPECT_EQ(rod["strands_reset"], 0);
  EXPECT_GT(rod["step_ms_median"], 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "film"));

  const Outcome table = run(command + " --no-pictures --solvers gauss_seidel --rest 0.5");
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_NE(table.out.find("gauss_seidel"), std::string::npos) << table.out;
  EXPECT_EQ(table.out.find("rod"), std::string::npos) << table.out;

  const std::string small =
      " --shake 0.3 --rest 0.3 --frames 2 --width 96 --height 64 --hairs 300 --segments 8 --samples 1 --json";
  const Outcome drawn = run(command + small);
  if (drawn.err.find("OpenGL") != std::string::npos) GTEST_SKIP() << drawn.err;
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "film" / "frame_0001.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "film" / "frame_0002.png"));
  const std::string png = contents(folder_ / "film" / "frame_0000.png");
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\0\xc0\0\0\0\x40", 8)) << "192 x 64: one beside the other";
  ASSERT_EQ(run(command + small + " --mark-collided on").exit_code, 0);
  EXPECT_NE(contents(folder_ / "film" / "frame_0000.png"), png) << "roots are in the skin";
}

TEST_F(Programs, InterruptEndsACompareWithoutNumbers) {
  if (!STRANDCAST_GL) GTEST_SKIP() << "built without OpenGL";
  const pid_t child = start(
      {program_, "compare", "--scene", "straight", "--strands", "60", "--no-pictures", "--rest", "3600"},
      "compare.txt");
  std::this_thread::sleep_for(std::chrono::seconds(1));
  interrupt(child);
  EXPECT_EQ(wait(child), 130);
  EXPECT_EQ(contents(folder_ / "compare.txt"), "");
}

TEST_F(Programs, ConvertKeepsEveryBitOfThePositions) {
  StrandSet strands;
  for (int s = 0; s < 7; ++s) {
    std::vector<Vec3> points;
    for (int i = 0; i < 5; ++i) points.emplace_back(0.1f * s, -0.3f * i, std::sin(static_cast<float>(s + i)));
    strands.append(points);
  }
  const auto a = folder_ / "a.tfx", b = folder_ / "b.hair", c = folder_ / "c.tfx";
  writeGroom(a, strands);
  ASSERT_EQ(run(program_ + " convert " + a.string() + " " + b.string()).exit_code, 0);
  EXPECT_EQ(readRawGroom(b).strands.positions[1], Vec3(0, -std::sin(1.0f), -0.3f)) << "Z is up in .hair";
  ASSERT_EQ(run(program_ + " convert " + b.string() + " " + c.string()).exit_code, 0);
  const RawGroom back = readRawGroom(c);
  ASSERT_EQ(back.strands.positions.size(), strands.positions.size());
  for (size_t i = 0; i < strands.positions.size(); ++i)
    EXPECT_EQ(back.strands.positions[i], strands.positions[i]);
}

TEST_F(Programs, ConvertSaysWhatTheOtherFormatHasNoPlaceFor) {
  StrandSet strands;
  strands.append(std::vector<Vec3>{{0, 0, 0}, {0, 0.1f, 0}, {0, 0.2f, 0}, {0, 0.3f, 0}});
  strands.pinned = {1, 1, 0, 0};
  const std::string tfx = (folder_ / "a.tfx").string(), hair = (folder_ / "a.hair").string();
  const auto converted = [&](const std::string& from, const std::string& to) {
    const auto r = run(program_ + " convert " + from + " " + to);
    EXPECT_EQ(r.exit_code, 0);
    return r.err;
  };
  writeGroom(tfx, strands);
  EXPECT_EQ(converted(tfx, hair), "") << "its second vertex is clamped as all hair's";
  strands.pinned = {1, 1, 0, 1};
  strands.uvs = {Vec2(0.5f, 0.25f)};
  writeGroom(tfx, strands);
  EXPECT_NE(converted(tfx, hair).find("no pins and no UVs"), std::string::npos);
  EXPECT_EQ(converted(tfx, tfx + ".tfx"), "");
  strands.radii.assign(4, 4e-5f);
  writeGroom(hair, strands);
  EXPECT_NE(converted(hair, tfx).find("no radii"), std::string::npos);
  writeFileBytes(hair, samples::hair());
  EXPECT_NE(converted(hair, hair + ".hair").find("without the transparency, colours of"), std::string::npos);
  EXPECT_EQ(converted(hair + ".hair", hair), "") << "they are gone";
}

TEST_F(Programs, ConvertSaysWhatCleaningDoesAndKeepsPins) {
  StrandSet strands;
  strands.append(std::vector<Vec3>{{0, 0, 0}, {0, 10, 0}, {0, 20, 0}, {0, 30, 0}});
  strands.append(std::vector<Vec3>{{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}});
  strands.pinned = {1, 1, 0, 0, 1, 1, 0, 0};
  const std::string in = (folder_ / "in.tfx").string(), out = (folder_ / "out.tfx").string();
  writeGroom(in, strands);
  const Outcome r = run(program_ + " convert --clean " + in + " " + out);
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_NE(r.err.find("the unit is guessed: 0.01 m"), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("1 strands dropped"), std::string::npos) << r.err;
  EXPECT_EQ(readRawGroom(out).strands.pinned, (std::vector<uint8_t>{1, 1, 0, 0}));
}

TEST_F(Programs, ConvertCleansWhatResamplingGetsIntoOnePlace) {
  StrandSet strands;
  strands.append(std::vector<Vec3>{{0, 0, 0}, {0, 0.1f, 0}, {0, 0, 0}});
  strands.append(std::vector<Vec3>{{0.1f, 0, 0}, {0.1f, 0.1f, 0}, {0.1f, 0.3f, 0}});
  const std::string in = (folder_ / "in.tfx").string(), hair = (folder_ / "out.hair").string();
  writeGroom(in, strands);
  const auto r = run(program_ + " convert --vertices 4 " + in + " " + hair);
  EXPECT_NE(r.err.find("1 vertices at the position of a neighbour and 0 strands"), std::string::npos)
      << r.err;
  EXPECT_EQ(readRawGroom(hair).strands.offsets, (std::vector<uint32_t>{0, 3, 7}));
  const auto kept = run(program_ + " convert --vertices 4 " + in + " " + in + ".tfx");
  EXPECT_NE(kept.err.find("are kept"), std::string::npos) << kept.err;
  EXPECT_EQ(readRawGroom(in + ".tfx").strands.offsets, (std::vector<uint32_t>{0, 4, 8}));
}

TEST_F(Programs, BakeWritesAFieldSaysHowGoodItIsAndFindsItAgain) {
  const std::filesystem::path cube = write("cube.obj", kCube), out = folder_ / "cube.sdf";
  const std::string command = program_ + " bake " + cube.string() + " --unit-meters 1 --cell 0.002 --out " +
                              out.string() + " --cache " + (folder_ / "cache").string() + " --json";
  const Outcome first = run(command);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_NE(first.err.find("bricks"), std::string::npos) << "what it takes is said first: " << first.err;
  const nlohmann::json report = nlohmann::json::parse(first.out);
  EXPECT_EQ(report["triangles"], 12);
  EXPECT_EQ(report["open_edges"], 0);
  EXPECT_EQ(report["from_cache"], 0);
  EXPECT_EQ(report["points"], 10000);
  EXPECT_EQ(report["wrong_side"], 0);
  EXPECT_LT(report["error_worst_mm"], 1);
  const StoredField stored = loadDistanceField(out);
  EXPECT_EQ(report["bricks"], stored.field.storedBricks());
  EXPECT_NEAR(stored.field.at({0.05f, 0.05f, 0.004f}).distance, -0.004f, 1e-5);
  std::filesystem::remove(out);
  const Outcome second = run(command);
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_EQ(nlohmann::json::parse(second.out)["from_cache"], 1);
  EXPECT_EQ(loadDistanceField(out).field.samples, stored.field.samples);
  if (!STRANDCAST_GL) return;
  const Outcome sliced = run(command + " --slices " + (folder_ / "slices").string());
  ASSERT_EQ(sliced.exit_code, 0) << sliced.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "slices" / "y_50.png"));
}

TEST_F(Programs, ABakeThatCouldNotBeWrittenIsNotBegun) {
  const std::string bake =
      program_ + " bake " + write("cube.obj", kCube).string() + " --unit-meters 1 --no-cache";
  const std::string out = (folder_ / "cube.sdf").string(), file = write("file", "").string();
  std::vector<std::string> refused = {" --out " + (folder_ / "absent" / "cube.sdf").string(),
                                      " --out " + folder_.string(), " --out " + file + "/cube.sdf"};
  if (STRANDCAST_GL) refused.push_back(" --out " + out + " --slices " + file);
  for (const std::string& options : refused) {
    const Outcome r = run(bake + options);
    EXPECT_EQ(r.exit_code, 2) << options;
    EXPECT_EQ(r.err.find("bricks"), std::string::npos) << r.err;
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(Programs, InterruptStopsABakeAndLeavesNoFile) {
  const std::filesystem::path cube = write("cube.obj", kCube), out = folder_ / "cube.sdf";
  const pid_t child = start({program_, "bake", cube.string(), "--unit-meters", "1", "--cell", "0.0002",
                             "--threads", "1", "--no-cache", "--out", out.string()},
                            "bake.txt");
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  interrupt(child);
  EXPECT_EQ(wait(child), 130);
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(Programs, ASceneSaysOnNoTerminalWhatABakeTakesBeforeItBegins) {
  write("cube.obj", kCube);
  const std::string config = write("bodies.toml",
                                   "[[body.primitives]]\nkind = \"mesh\"\nfile = \"cube.obj\"\n"
                                   "a = [0, 0, 5]\ncell = 0.0002\nfollows_head = false\n")
                                 .string();
  const std::filesystem::path err = folder_ / "err.txt";
  const pid_t child = start({"/bin/sh", "-c",
                             "exec " + program_ + " record " + (folder_ / "never.rec").string() +
                                 " --strands 50 --seconds 0.1 --config " + config + " 2>" + err.string()},
                            "record.txt");
  const auto isSaid = [&] { return contents(err).find("cube.obj: baking") != std::string::npos; };
  for (int i = 0; i < 600 && !isSaid() && isRunning(child); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  interrupt(child);
  EXPECT_EQ(wait(child), 130) << "it was baking still";
  const std::string said = contents(err);
  EXPECT_NE(said.find(" s, "), std::string::npos) << said;
  EXPECT_NE(said.find(" MiB"), std::string::npos) << said;
  EXPECT_EQ(said.find("bricks"), std::string::npos) << said;
}

TEST_F(Programs, ABakeThatIsStoppedWhileItMeasuresSaysWhatIsKept) {
  const std::filesystem::path cube = write("cube.obj", kCube), out = folder_ / "cube.sdf",
                              cache = folder_ / "cache";
  int exit_code = 0;
  for (int tries = 0; tries < 8 && exit_code == 0; ++tries) {  // it measures for only a tenth of a second
    std::filesystem::remove_all(cache);
    std::filesystem::remove(out);
    const pid_t child = start({"/bin/sh", "-c",
                               "exec " + program_ + " bake " + cube.string() +
                                   " --unit-meters 1 --cell 0.005 --threads 1 --cache " + cache.string() +
                                   " --out " + out.string() + " 2>err.txt"},
                              "bake.txt");
    const auto isKept = [&] {
      std::error_code none;
      for (const auto& entry : std::filesystem::directory_iterator(cache, none))
        if (entry.path().extension() == ".sdf") return true;
      return false;
    };
    while (!isKept() && isRunning(child)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(child, SIGINT);
    exit_code = wait(child);
  }
  ASSERT_EQ(exit_code, 130);
  EXPECT_FALSE(std::filesystem::exists(out));
  const std::string err = contents(folder_ / "err.txt");
  EXPECT_NE(err.find("the field is in the cache"), std::string::npos) << err;
  EXPECT_EQ(err.find("nothing was written"), std::string::npos) << err;
}

TEST_F(Programs, InfoTellsCountsAsJson) {
  StrandSet strands;
  strands.append(std::array<Vec3, 3>{Vec3(0, 0, 0), Vec3(0, -0.1f, 0), Vec3(0, -0.2f, 0)});
  strands.append(std::array<Vec3, 3>{Vec3(1, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 0)});
  strands.append(std::array<Vec3, 3>{Vec3(2, 0, 0), Vec3(2, -0.1f, 0), Vec3(2, -0.2f, 0)});
  writeGroom(folder_ / "g.tfx", strands);
  const Outcome r = run(program_ + " info " + (folder_ / "g.tfx").string() + " --json --unit-meters 1");
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const nlohmann::json info = nlohmann::json::parse(r.out);
  EXPECT_EQ(info["strands"], 3);
  EXPECT_EQ(info["vertices"], 9);
  EXPECT_EQ(info["vertices_min"], 3);
  EXPECT_EQ(info["vertices_max"], 3);
  EXPECT_EQ(info["degenerate_strands"], 1);
  EXPECT_TRUE(info["width_min"].is_null()) << "such files have none";
  strands.radii.assign(9, 4e-5f);
  strands.radii[1] = 1e-5f;
  writeGroom(folder_ / "g.hair", strands);
  const std::string widths = program_ + " info " + (folder_ / "g.hair").string() + " --unit-meters 1";
  const nlohmann::json thick = nlohmann::json::parse(run(widths + " --json").out);
  EXPECT_FLOAT_EQ(thick["width_min"].get<float>(), 2e-5f);
  EXPECT_FLOAT_EQ(thick["width_max"].get<float>(), 8e-5f);
  EXPECT_NE(run(widths).out.find("0.02 to 0.08 mm; not simulated"), std::string::npos);
  EXPECT_FLOAT_EQ(info["bounds_max"][0].get<float>(), 2);
  EXPECT_FLOAT_EQ(info["length_max"].get<float>(), 0.2f);
  EXPECT_TRUE(nlohmann::json::parse(run(program_ + " info --backends --json").out)["backends"].is_array());
}

TEST_F(Programs, InfoTellsLabelsOfStrandsAndConvertKeepsThem) {
  const std::string usda = (folder_ / "g.usda").string(), copy = (folder_ / "copy.usda").string();
  writeFileBytes(usda, samples::usdaLabels());
  const nlohmann::json info = nlohmann::json::parse(run(program_ + " info --json " + usda).out);
  EXPECT_EQ(info["guides"], 1);
  EXPECT_EQ(info["ids"], 3);
  EXPECT_EQ(info["colours"], 3);
  ASSERT_EQ(info["groups"].size(), 3u);
  EXPECT_EQ(info["groups"][0]["id"], -1);
  EXPECT_EQ(info["groups"][0]["name"], "a \"b\"");
  EXPECT_EQ(info["groups"][0]["strands"], 1);
  const std::string text = run(program_ + " info " + usda).out;
  EXPECT_NE(text.find("3: -1 a \"b\" (1 strands), 3 c? (1 strands), 0 (1 strands)"), std::string::npos)
      << text;
  ASSERT_EQ(run(program_ + " convert " + usda + " " + copy).exit_code, 0);
  const nlohmann::json again = nlohmann::json::parse(run(program_ + " info --json " + copy).out);
  for (const char* key : {"guides", "ids", "colours", "groups"}) EXPECT_EQ(again[key], info[key]) << key;
  EXPECT_NE(run(program_ + " convert " + usda + " " + copy + ".hair")
                .err.find("no guide marks and no ids and no groups and no colours"),
            std::string::npos);
}

TEST_F(Programs, SeveralLightsAreDrawn) {
  if (run(program_ + " render --help").exit_code != 0) GTEST_SKIP() << "made without render";
  const auto picture = [&](const std::string& lights) {
    const auto out = folder_ / "lit";
    const Outcome r =
        run(program_ +
            " render --scene straight --strands 60 --backend reference --motion still --frames 1 "
            "--width 48 --height 48 --hairs 300 --out " +
            out.string() + lights);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    return contents(out / "frame_0000.png");
  };
  const std::string two = " --light spot --light-color 1 0.2 0.1 --light point --light-color 0.1 0.2 1";
  const std::string lit = picture(two);
  EXPECT_NE(lit, picture(" --light spot --light-color 1 0.2 0.1"));
  write("two.toml",
        "[[light]]\nkind = \"spot\"\ncolor = [1, 0.2, 0.1]\n[[light]]\nkind = \"point\"\ncolor = [0.1, 0.2, "
        "1]\n");
  EXPECT_EQ(lit, picture(" --preset " + (folder_ / "two.toml").string()));
  const Outcome many = run(program_ + " render --scene straight" + two + two + " --light spot");
  EXPECT_EQ(many.exit_code, 2);
  EXPECT_NE(many.err.find("at most 4 lights"), std::string::npos) << many.err;
}

TEST_F(Programs, SlicesThroughTheAirAreDrawn) {
  if (run(program_ + " render --help").exit_code != 0) GTEST_SKIP() << "made without render";
  const std::string scene =
      program_ +
      " render --scene straight --strands 60 --backend simd --set grid_cells=16 --frames 1 --json "
      "--width 64 --height 64 --out " +
      (folder_ / "air").string();
  const Outcome drawn = run(scene + " --set wind_grid=1 --set wind=3,0,0 --show wind");
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_GT(nlohmann::json::parse(drawn.out)["full"], 2.5) << "m/s";
  EXPECT_TRUE(std::filesystem::exists(folder_ / "air" / "frame_0000.png"));
  const Outcome no_grid = run(scene + " --set wind=3,0,0 --set gust=0.5 --show wind");
  EXPECT_EQ(no_grid.exit_code, 2);
  EXPECT_NE(no_grid.err.find("wind_grid=1"), std::string::npos) << no_grid.err;
  EXPECT_EQ(run(program_ + " render --show density --out " + (folder_ / "air").string()).exit_code, 2)
      << "a daemon's grids are not cast";
}

}  // namespace
}  // namespace strandcast
