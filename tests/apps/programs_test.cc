// The programs as a user runs them: exit codes, one-line errors, and daemon and renderer as two processes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "groom/distance_field_file.h"
#include "groom/file_bytes.h"
#include "groom/groom_file.h"
#include "tests/apps/program_fixture.h"
#include "tests/groom/sample_files.h"
#include "tests/transport/dds_domain.h"

namespace strandcast {
namespace {

const std::string kCube =
    "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nv 0 0 0.1\nv 0.1 0 0.1\nv 0.1 0.1 0.1\nv 0 0.1 0.1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";

class Programs : public ProgramFixture {
 protected:
  const std::string domain_ = std::to_string(testDomain(0));
};

TEST_F(Programs, HelpTeachesAndExitsWithZero) {
  for (const char* words :
       {" --help", " info --help", " convert --help", " bake --help", " render --help", " compare --help",
        " ctl --help", " record --help", " replay --help", " keys --help", " validate --help"}) {
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

/// Processes that `parent` started and that have not ended.
std::vector<pid_t> childrenOf(pid_t parent) {
  std::vector<pid_t> children;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::ifstream stat(entry.path() / "stat");
    pid_t child = 0, of = 0;
    std::string name, state;
    if (stat >> child >> name >> state >> of && of == parent && state != "Z") children.push_back(child);
  }
  return children;
}

TEST_F(Programs, ValidateWireMeasuresBetweenTwoProcesses) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const Outcome r = run(program_ + " validate wire --only 'dds delta16 1000x32 120 Hz' --json");
  ASSERT_LE(r.exit_code, 1) << r.err;  // latency has a limit that a busy machine may miss
  const nlohmann::json results = nlohmann::json::parse(r.out)["results"];
  ASSERT_EQ(results.size(), 7u) << r.out;
  EXPECT_GT(results[0]["value"], 1);
  EXPECT_LE(results[0]["value"], 4);
  EXPECT_GT(results[1]["value"], 0) << "what came is compared with what was sent";
  EXPECT_LE(results[1]["value"], 0.0100001);
  EXPECT_LT(results[2]["value"], 60) << "of 240 frames";
  EXPECT_GT(results[3]["value"], 0);
  EXPECT_GE(results[4]["value"], results[3]["value"]);
  EXPECT_GT(results[5]["value"], 0);
  EXPECT_GT(results[6]["value"], 0);
}

TEST_F(Programs, ValidateWireOutlivesItsReader) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  for (const auto& [signal, end] : {std::pair{SIGKILL, "signal 9"}, std::pair{SIGSTOP, "still running"}}) {
    const pid_t validate =
        start({program_, "validate", "wire", "--only", "dds delta16 1000x32 120 Hz", "--json"}, "wire.json");
    std::set<pid_t> readers;  // the first is that of next to nothing
    while (readers.size() < 2 && isRunning(validate)) {
      for (const pid_t child : childrenOf(validate)) readers.insert(child);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ASSERT_EQ(readers.size(), 2u);
    std::this_thread::sleep_for(std::chrono::seconds(1));
    for (const pid_t reader : childrenOf(validate)) kill(reader, signal);
    EXPECT_EQ(wait(validate), 1);
    const nlohmann::json report = nlohmann::json::parse(contents(folder_ / "wire.json"));
    EXPECT_EQ(report["failed"], 7) << report;
    EXPECT_NE(report["results"][0]["note"].get<std::string>().find(end), std::string::npos) << report;
    EXPECT_TRUE(report["results"][0]["value"].is_null()) << report;
  }
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
  EXPECT_NE(r.err.find("1 vertices in the place of a neighbour and 0 strands"), std::string::npos) << r.err;
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
  for (int tries = 0; tries < 8 && exit_code == 0; ++tries) {  // it measures for a tenth of a second only
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
  EXPECT_FLOAT_EQ(info["bounds_max"][0].get<float>(), 2);
  EXPECT_FLOAT_EQ(info["length_max"].get<float>(), 0.2f);
  EXPECT_TRUE(nlohmann::json::parse(run(program_ + " info --backends --json").out)["backends"].is_array());
}

TEST_F(Programs, DaemonCastsToARendererAndObeys) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const std::vector<std::string> words{daemon_, "--scene", "straight", "--strands",  "200", "--domain",
                                       domain_, "--json",  "--quiet",  "--duration", "120"};
  const pid_t first = start(words, "daemon.json");
  const std::string network = " --domain " + domain_;
  ASSERT_EQ(run(program_ + " ctl wind 3 0 0" + network + " --timeout 60").exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl motion nod" + network).exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl head 0 0.01 0 20" + network).exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl reset" + network).exit_code, 0);
  const Outcome refused = run(program_ + " ctl set air_drag -5" + network);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("air_drag"), std::string::npos) << refused.err;
  const std::string fan = program_ + " ctl fan ";
  EXPECT_EQ(run(fan + "add spot cone 0 0.2 -0.6 --direction 0 0 1 --speed -2" + network).exit_code, 0);
  EXPECT_EQ(run(fan + "move spot --direction 0 -1 0 --angle 30" + network).exit_code, 0);
  const Outcome unknown = run(fan + "move spat 0 0 0" + network);
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("did you mean 'spot'?"), std::string::npos) << unknown.err;
  for (const char* bad :
       {"move spot", "move spot 0 0", "move spot --speed 101", "move spot --direction 0 0 0",
        "add s storm 0 0 0", "add s cone 0 0", "move spot --seconds 1"})
    EXPECT_EQ(run(fan + bad + network).exit_code, 2) << bad;
  const Outcome fans = run(fan + "list --json" + network);
  EXPECT_EQ(fans.exit_code, 0) << fans.err;
  const nlohmann::json spot = nlohmann::json::parse(fans.out)["fans"].at(0);
  EXPECT_EQ(spot["name"], "spot");
  EXPECT_EQ(spot["kind"], "cone");
  EXPECT_EQ(spot["position"], nlohmann::json::parse("[0.0, 0.2, -0.6]"));
  EXPECT_EQ(spot["speed"], -2.0);
  const Outcome table = run(fan + "list" + network);
  EXPECT_NE(table.out.find("spot"), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("speed -2 m/s"), std::string::npos) << table.out;
  EXPECT_EQ(run(fan + "remove spot" + network).exit_code, 0);
  EXPECT_EQ(run(fan + "list" + network).out, "no sources of wind\n");
  const std::string collider = program_ + " ctl collider ";
  EXPECT_EQ(run(collider + "add 'a ball' sphere 0 0.1 0.75 0.05" + network).exit_code, 0);
  const nlohmann::json listed =
      nlohmann::json::parse(run(collider + "list --json" + network).out)["colliders"];
  ASSERT_EQ(listed.size(), 3u) << listed;
  EXPECT_TRUE(listed[0]["name"].is_null()) << "the scene's";
  EXPECT_EQ(listed[0]["follows_head"], true);
  EXPECT_EQ(listed[2]["name"], "a ball");
  EXPECT_EQ(listed[2]["shapes"], nlohmann::json::parse("[\"sphere\"]"));
  EXPECT_EQ(listed[2]["position"], nlohmann::json::parse("[0.0, 0.1, 0.75]"));
  const Outcome balls = run(collider + "list" + network);
  EXPECT_NE(balls.out.find("at 0 0.1 0.75"), std::string::npos) << balls.out;
  EXPECT_EQ(run(collider + "remove 'a ball'" + network).exit_code, 0);
  const Outcome far = run(program_ + " ctl head 2000 0 0" + network);
  EXPECT_EQ(far.exit_code, 2);
  EXPECT_NE(far.err.find("within 1000"), std::string::npos) << far.err;
  // Nobody on the network has the daemon open its files.
  const Outcome file = run(program_ + " ctl motion " + write("walk.bvh", "HIERARCHY").string() + network);
  EXPECT_EQ(file.exit_code, 2);
  EXPECT_NE(file.err.find("still"), std::string::npos) << file.err;
#ifdef STRANDCAST_EXAMPLE_READER
  const Outcome read = run(std::string(STRANDCAST_EXAMPLE_READER) + " " + domain_ + " 5");
  EXPECT_EQ(read.exit_code, 0) << read.err;
  EXPECT_NE(read.out.find("200 strands"), std::string::npos) << read.out;
  EXPECT_NE(read.out.find("0 lost"), std::string::npos) << read.out;
#endif
  const Outcome told = run(program_ + " ctl status --json" + network);
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const nlohmann::json parameters = nlohmann::json::parse(told.out)["parameters"];
  EXPECT_EQ(parameters["wind"], (std::vector<double>{3, 0, 0}));
  EXPECT_EQ(parameters["air_drag"], 5) << "of the scene";
  EXPECT_NE(run(program_ + " ctl status" + network).out.find("    wind               3 0 0 m/s\n"),
            std::string::npos);

  const Outcome rival = run(daemon_ + " --scene straight --strands 20 --quiet" + network);
  EXPECT_EQ(rival.exit_code, 2);
  EXPECT_NE(rival.err.find("another daemon"), std::string::npos) << rival.err;

  const Outcome drawn =
      run(program_ + " render --json --frames 3 --width 160 --height 120 --hairs 2000 --out " +
          (folder_ / "pictures").string() + network);
  if (drawn.err.find("OpenGL") == std::string::npos) {
    ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
    const nlohmann::json report = nlohmann::json::parse(drawn.out);
    EXPECT_EQ(report["frames_drawn"], 3);
    EXPECT_EQ(report["frames_lost"], 0);
    EXPECT_EQ(report["strands"], 200);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "pictures" / "frame_0002.png"));
  }
  // Of a daemon that is paused there is one moment to record, not a film of it.
  EXPECT_EQ(run(program_ + " ctl pause" + network).exit_code, 0);
  const std::filesystem::path take = folder_ / "paused.rec";
  const pid_t record = start(
      {program_, "record", take.string(), "--timeout", "4", "--json", "--domain", domain_}, "record.json");
  for (int i = 0; i < 300 && !std::filesystem::exists(take) && isRunning(record); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::this_thread::sleep_for(std::chrono::seconds(5));
  ASSERT_TRUE(isRunning(record)) << "it is no silence";
  interrupt(record);
  EXPECT_EQ(wait(record), 130);
  EXPECT_LE(nlohmann::json::parse(contents(folder_ / "record.json"))["frames"], 2);
  EXPECT_EQ(run(program_ + " ctl stop" + network).exit_code, 0);
  EXPECT_EQ(wait(first), 0);
  const nlohmann::json summary = nlohmann::json::parse(contents(folder_ / "daemon.json"));
  EXPECT_GT(summary["frames_published"], 10);
  EXPECT_EQ(summary["non_finite"], 0);
}

TEST_F(Programs, AStrongerDaemonJoinsOneThatCastsTheirGroomAndLeavesItAgain) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const auto claims = [&](const char* strength, const char* strands) {
    return start({daemon_, "--scene", "straight", "--strands", strands, "--domain", domain_, "--quiet",
                  "--duration", "120", "--body-contact", "spheres", "--claim", strength},
                 std::string("daemon") + strength);
  };
  const auto becomes = [&](int strands) {  // who casts
    for (int i = 0; i < 60; ++i) {
      const Outcome told = run(program_ + " ctl status --json --timeout 30 --domain " + domain_);
      if (told.exit_code == 0 && nlohmann::json::parse(told.out)["strands"] == strands) return true;
    }
    return false;
  };
  const pid_t weaker = claims("1", "20");
  ASSERT_TRUE(becomes(20));
  const pid_t stronger = claims("2", "30");
  ASSERT_TRUE(becomes(30));
  // What a sender tells who casts, the standby obeys too.
  const std::string network = " --domain " + domain_;
  for (int i = 0; i < 4; ++i) {
    const std::string place = " 0 " + std::to_string(i) + " 1 0.05";
    EXPECT_EQ(
        run(program_ + " ctl collider add ball" + std::to_string(i) + " sphere" + place + network).exit_code,
        0);
  }
  kill(stronger, SIGKILL);
  wait(stronger);
  EXPECT_TRUE(becomes(20)) << "the standby takes over";
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(run(program_ + " ctl collider remove ball" + std::to_string(i) + network).exit_code, 0) << i;
  EXPECT_EQ(run(program_ + " ctl stop --domain " + domain_).exit_code, 0);
  EXPECT_EQ(wait(weaker), 0);
}

TEST_F(Programs, StepsWaitForThoseThatOthersAskedFor) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const std::string network = " --domain " + domain_;
  const pid_t daemon = start({daemon_, "--scene", "wavy", "--strands", "300", "--backend", "simd",
                              "--threads", "1", "--set", "substeps=32", "--domain", domain_, "--quiet"},
                             "daemon.txt");
  ASSERT_EQ(run(program_ + " ctl pause --timeout 60" + network).exit_code, 0);
  const pid_t others = start({program_, "ctl", "step", "150", "--domain", domain_}, "others.txt");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const Outcome own = run(program_ + " ctl step 1 --timeout 1" + network);
  EXPECT_EQ(own.exit_code, 0) << own.err;
  EXPECT_EQ(wait(others), 0);
  EXPECT_EQ(run(program_ + " ctl stop" + network).exit_code, 0);
  EXPECT_EQ(wait(daemon), 0);
}

TEST_F(Programs, ARunIsRecordedReplayedAndRepeatedBitForBit) {
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
  // Recordings have no colliders: the field of the body is baked, and here it cannot be kept.
  const Outcome drawn = run("env -u HOME -u XDG_CACHE_HOME " + program_ +
                            " render --keep-out on --frames 1 --width 48 --height 48 --hairs 300 --out " +
                            (folder_ / "pictures").string() + network);
  if (STRANDCAST_GL && drawn.err.find("OpenGL") == std::string::npos) {
    EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
    EXPECT_NE(drawn.err.find("bakes the body anew"), std::string::npos) << drawn.err;
  }
  EXPECT_EQ(run(program_ + " ctl set speed 0.5" + network).exit_code, 0);
  EXPECT_EQ(run(program_ + " ctl stop" + network).exit_code, 0);
}

TEST_F(Programs, ATakeOutlivesARecordThatHearsNothing) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const std::filesystem::path take = write("take.rec", "an old take");
  const std::string record = program_ + " record " + take.string() + " --domain " + domain_;
  const Outcome silent = run(record + " --timeout 0.3");
  EXPECT_EQ(silent.exit_code, 2);
  EXPECT_NE(silent.err.find("no frame came"), std::string::npos) << silent.err;
  EXPECT_EQ(contents(take), "an old take");
  EXPECT_EQ(run("timeout -s INT 1 " + record).exit_code, 124) << "by timeout's own convention";
  EXPECT_EQ(contents(take), "an old take");
}

TEST_F(Programs, WhatAStreamLacksIsSaid) {
  const std::string log = " --transport lcm --lcm-url 'file://" + (folder_ / "a.log").string();
  const Outcome cast = run(daemon_ +
                           " --scene straight --strands 20 --backend reference --body-contact "
                           "spheres --quiet --duration 0.5" +
                           log + "?mode=w'");
  if (cast.err.find("LCM cannot") != std::string::npos || cast.err.find("LCM is not") != std::string::npos)
    GTEST_SKIP() << cast.err;
  ASSERT_EQ(cast.exit_code, 0) << cast.err;
  // The daemon has listened for others before it cast.
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

TEST_F(Programs, AnInterruptWhileADaemonListensForOthersEndsItAtOnce) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const std::filesystem::path take = write("take.rec", "an old take");
  const pid_t daemon =
      start({daemon_, "--scene", "straight", "--strands", "20", "--body-contact", "spheres", "--backend",
             "reference", "--domain", domain_, "--claim", "1", "--quiet", "--record", take.string()},
            "daemon.txt");
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  ASSERT_TRUE(isRunning(daemon));
  interrupt(daemon);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(wait(daemon), 130);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3)) << "it would listen for 6 s";
  EXPECT_EQ(contents(take), "an old take");
}

TEST_F(Programs, CtlWaitsNoLongerThanItIsToldTo) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const auto seconds = [&](const std::string& command, int exit_code) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome r = run(command);
    EXPECT_EQ(r.exit_code, exit_code) << command << "\n" << r.out << r.err;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const std::string ctl = program_ + " ctl wind 1 0 0 --domain " + domain_;
  EXPECT_LT(seconds(ctl + " --timeout 0.1", 2), 1.5);
  for (const char* verb : {"wind 1 0 0", "status", "list"}) {
    const pid_t child = ProgramFixture::start(
        {"sh", "-c", "exec " + program_ + " ctl " + verb + " --domain " + domain_}, "ctl.txt");
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    interrupt(child);
    EXPECT_EQ(wait(child), 130) << verb;
    EXPECT_EQ(contents(folder_ / "ctl.txt"), "") << verb;
  }
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

TEST_F(Programs, DaemonCastsOverLcm) {
  const std::string network = " --transport lcm --domain " + domain_;
  const pid_t daemon = start({daemon_, "--scene", "straight", "--strands", "200", "--transport", "lcm",
                              "--domain", domain_, "--codec", "oct12", "--quiet", "--duration", "120"},
                             "daemon.txt");
  const Outcome wind = run(program_ + " ctl wind 1 0 0 --timeout 60" + network);
  if (wind.err.find("LCM cannot") != std::string::npos || wind.err.find("LCM is not") != std::string::npos) {
    kill(daemon, SIGKILL);
    GTEST_SKIP() << wind.err;
  }
  ASSERT_EQ(wind.exit_code, 0) << wind.err;
  nlohmann::json status;
  for (int i = 0; i < 100 && (i == 0 || status["bytes_per_frame"] == 0);
       ++i) {  // the first status has no frame yet
    const Outcome r = run(program_ + " ctl status --json --timeout 60" + network);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    status = nlohmann::json::parse(r.out);
  }
  EXPECT_EQ(status["codec"], "oct12");
  EXPECT_EQ(status["parameters"]["wind"], (std::vector<double>{1, 0, 0}));
  EXPECT_GT(status["bytes_per_vertex"], 1);
  EXPECT_LT(status["bytes_per_vertex"], 5);
  EXPECT_LE(status["codec_worst_error_mm"], 0.0100001);
  EXPECT_EQ(run(program_ + " ctl stop --timeout 60" + network).exit_code, 0);
  EXPECT_EQ(wait(daemon), 0);

  const Outcome refused = run(daemon_ + " --scene straight --strands 20 --quiet --codec temporal" + network);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("loses nothing"), std::string::npos) << refused.err;
}

TEST_F(Programs, GridsOfARecordingAreDrawn) {
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

TEST_F(Programs, FramesWhoseWindIsOnNoGridAreNotDrawn) {
  if (!STRANDCAST_GL || !STRANDCAST_DDS) GTEST_SKIP() << "built without OpenGL or without DDS";
  const std::string file = (folder_ / "run.rec").string(), network = " --domain " + domain_;
  const pid_t daemon =
      start({daemon_, "--scene",       "straight",       "--strands",   "60",       "--vertices",
             "8",     "--backend",     "simd",           "--domain",    domain_,    "--quiet",
             "--set", "wind=3,0,0",    "--set",          "wind_grid=1", "--set",    "volume_stiffness=1",
             "--set", "grid_cells=16", "--record-grids", "1",           "--record", file},
            "daemon.txt");
  // With forces between hairs, whose grid is recorded without the wind's, and without, when none is.
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

TEST_F(Programs, ASceneIsRecordedWithItsGrids) {
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
  EXPECT_NE(none.err.find("holds no grids"), std::string::npos) << none.err;

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

TEST_F(Programs, ALogOfLcmsToolsIsDrawn) {
  if (std::system("command -v lcm-logger lcm-logplayer >/dev/null") != 0) GTEST_SKIP() << "no lcm-logger";
  const std::string log = (folder_ / "session.lcm").string(),
                    url = "udpm://239.255.76.67:" + std::to_string(7667 + std::stoi(domain_)) + "?ttl=0";
  const pid_t logger = start({"/usr/bin/env", "lcm-logger", "-q", "--lcm-url=" + url, log}, "logger.txt");
  // A small body: LCM's tools have small receive buffers, and what they miss comes but once a second.
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

TEST_F(Programs, OfTwoDaemonsStartedAtOnceOneCasts) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const std::vector<std::string> words{daemon_,    "--scene", "straight", "--strands",  "20",
                                       "--domain", domain_,   "--quiet",  "--duration", "120"};
  const pid_t daemons[] = {start(words, "one.txt"), start(words, "two.txt")};
  const std::string network = " --domain " + domain_;
  ASSERT_EQ(run(program_ + " ctl wind 1 0 0 --timeout 60" + network).exit_code, 0);
  const size_t who_casts = isRunning(daemons[0]) ? 0 : 1;
  EXPECT_FALSE(isRunning(daemons[1 - who_casts]));
  EXPECT_EQ(run(program_ + " ctl stop" + network).exit_code, 0);
  EXPECT_EQ(wait(daemons[who_casts]), 0);
  EXPECT_EQ(wait(daemons[1 - who_casts]), 2);
}

TEST_F(Programs, InterruptEndsTheDaemonCleanly) {
  if (!STRANDCAST_DDS) GTEST_SKIP() << "built without DDS";
  const pid_t child =
      start({daemon_, "--scene", "straight", "--strands", "50", "--domain", domain_, "--json", "--quiet"},
            "daemon.json");
  ASSERT_EQ(run(program_ + " ctl wind 1 0 0 --timeout 60 --domain " + domain_).exit_code, 0);
  interrupt(child);
  EXPECT_EQ(wait(child), 130);
  EXPECT_TRUE(nlohmann::json::accept(contents(folder_ / "daemon.json")));
}

}  // namespace
}  // namespace strandcast
