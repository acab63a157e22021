// What the programs refuse, at which point, and what is unchanged afterwards. No test here needs a network.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "io/groom_file.h"
#include "tests/apps/program_fixture.h"
#include "transport/recording/recorder.h"

namespace strandcast {
namespace {

class Refusals : public ProgramFixture {
 protected:
  /// Killed after this many seconds: a command that should be refused may never end.
  Outcome tryFor(int seconds, const std::string& command) {
    return run("timeout " + std::to_string(seconds) + " " + command);
  }
};

TEST_F(Refusals, ANumberThatIsNoneIsInNoRange) {
  const std::string absent = (folder_ / "absent").string();
  for (const std::string& command :
       {daemon_ + " --rate nan", daemon_ + " --duration nan", daemon_ + " --length nan",
        daemon_ + " --body-cell nan", daemon_ + " --codec-error nan", daemon_ + " --unit-meters nan",
        program_ + " record " + absent + " --seconds nan", program_ + " record " + absent + " --timeout nan",
        program_ + " replay " + absent + " --speed nan", program_ + " replay " + absent + " --from nan",
        program_ + " replay " + absent + " --to -nan", program_ + " replay " + absent + " --fps inf",
        program_ + " convert " + absent + " b.tfx --unit-meters nan",
        program_ + " info " + absent + " --unit-meters nan", program_ + " bake " + absent + " --cell nan",
        program_ + " ctl status --timeout nan"}) {
    const Outcome r = tryFor(10, command);
    EXPECT_EQ(r.exit_code, 2) << command << "\n" << r.err;
    EXPECT_NE(r.err.find("is not a number from"), std::string::npos) << command << "\n" << r.err;
  }
  if (!STRANDCAST_GL) return;
  for (const char* option : {" --fps nan", " --skip nan", " --timeout nan", " --light-intensity nan"}) {
    const Outcome r = tryFor(10, program_ + " render --out " + absent + option);
    EXPECT_EQ(r.exit_code, 2) << option << "\n" << r.err;
    EXPECT_NE(r.err.find("is not a number from"), std::string::npos) << option << "\n" << r.err;
  }
  EXPECT_FALSE(std::filesystem::exists(absent));
}

TEST_F(Refusals, ANumberThatIsEmptyIsNone) {
  for (const std::string& command :
       {program_ + " ctl wind '' 5 5", program_ + " ctl set air_drag ''", program_ + " ctl head 0 0 ''",
        program_ + " ctl wind 1 nan 5", program_ + " ctl collider add ball sphere 0 0 0 ''",
        daemon_ + " --claim '' --duration 0.1"}) {
    const Outcome r = tryFor(10, command);
    EXPECT_EQ(r.exit_code, 2) << command << "\n" << r.err;
    const bool is_told = r.err.find(" is not a number") != std::string::npos ||
                         r.err.find(" is not a whole number") != std::string::npos;
    EXPECT_TRUE(is_told) << command << "\n" << r.err;
  }
}

TEST_F(Refusals, ANumberBelowZeroNeedsNoWholePart) {
  // Accepted numbers lead to the next error: that of LCM, with or without LCM in the build.
  const std::string nowhere = " --transport lcm --lcm-url file:///absent/a.log?mode=r";
  const Outcome told = tryFor(10, program_ + " ctl wind -.5 0 -.5e1" + nowhere);
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_NE(told.err.find("error: LCM"), std::string::npos) << told.err;
  const Outcome unknown = tryFor(10, program_ + " ctl wind -.x 0 0" + nowhere);
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_EQ(unknown.err.find("error: LCM"), std::string::npos) << unknown.err;
}

TEST_F(Refusals, ACollidersSizeAndFrictionAreToMakeSense) {
  const std::string add = program_ + " ctl collider add ball ";
  for (const char* shape : {"sphere 0 0 0 0", "capsule 0 0 0 0 1 0 0", "tapered_capsule 0 0 0 0 1 0 0 0",
                            "ellipsoid 0 0 0 0.1 0 0.1", "box 0 0 0 0 0 0"}) {
    const Outcome r = tryFor(10, add + shape);
    EXPECT_EQ(r.exit_code, 2) << shape << "\n" << r.err;
    EXPECT_NE(r.err.find("ctl collider add; give "), std::string::npos) << shape << "\n" << r.err;
  }
  const Outcome slippery = tryFor(10, add + "sphere 0 0 0 1 --friction=-1");
  EXPECT_EQ(slippery.exit_code, 2);
  EXPECT_NE(slippery.err.find("'-1' is not a number from 0 to 10"), std::string::npos) << slippery.err;
}

TEST_F(Refusals, CommandsAreCheckedBeforeADaemonIsLookedFor) {
  for (const auto& [words, told] :
       {std::pair{"pull 1 2 3", "a pull takes 8 numbers, not 3"},
        {"pull 1 2 3 4 5 6 7", "a pull takes 8 numbers, not 7"},
        {"set wind 1", "parameter 'wind' takes 3 values, not 1"},
        {"set air_drag 1 2 3", "parameter 'air_drag' takes 1 value, not 3"},
        {"collider add b spere 0 0 0 1", "did you mean 'sphere'? choose one of sphere, capsule, plane,"},
        {"collider add b tapered-capsul 0 0 0 1", "did you mean 'tapered_capsule'?"},
        {"collider add b kone 0 0 0 1", "unknown shape 'kone'"},
        {"collider add b box 0 0 0 1", "a box takes 6 numbers, not 4"}}) {
    const Outcome r = tryFor(10, program_ + " ctl " + words);
    EXPECT_EQ(r.exit_code, 2) << words << "\n" << r.err;
    EXPECT_NE(r.err.find(told), std::string::npos) << words << "\n" << r.err;
  }
}

TEST_F(Refusals, AColliderFolderIsToBeThere) {
  const Outcome nameless = tryFor(10, daemon_ + " --collider-folder '' --duration 0.1");
  EXPECT_EQ(nameless.exit_code, 2);
  EXPECT_NE(nameless.err.find("has no name"), std::string::npos) << nameless.err;
  for (const std::filesystem::path& folder : {folder_ / "absent", write("file", "")}) {
    const Outcome r = tryFor(10, daemon_ + " --duration 0.1 --collider-folder " + folder.string());
    EXPECT_EQ(r.exit_code, 2);
    EXPECT_NE(r.err.find("the collider folder is not there: " + folder.string()), std::string::npos) << r.err;
  }
}

TEST_F(Refusals, AStreamIsNotToldWhatADaemonSimulates) {
  const std::filesystem::path take = write("take.rec", "an old take");
  for (const char* options : {" --strands 3", " --set wind=1,0,0", " --motion shake", " --rate 30",
                              " --no-sag-free", " --backend reference"}) {
    const Outcome r = tryFor(10, program_ + " record " + take.string() + " --timeout 0.1" + options);
    EXPECT_EQ(r.exit_code, 2) << options;
    EXPECT_NE(r.err.find("name a --scene"), std::string::npos) << options << "\n" << r.err;
  }
  EXPECT_EQ(contents(take), "an old take");
}

TEST_F(Refusals, BonesThatStayAndStiffenedStrandsAreReported) {
  const std::string record = program_ + " record " + (folder_ / "a.rec").string() +
                             " --backend reference --scene wavy --strands 20 --seconds 0.02 --config ";
  const std::filesystem::path neck = write("neck.toml", "[[pin]]\nbone = \"Neck\"\nto = 0.1\n");
  const std::filesystem::path head = write("head.toml", "[[pin]]\nbone = \"head\"\nto = 0.1\n");
  const Outcome warned = tryFor(20, record + neck.string());
  EXPECT_EQ(warned.exit_code, 0) << warned.err;
  EXPECT_NE(warned.err.find("bone 'Neck' does not move"), std::string::npos) << warned.err;
  const Outcome calm = tryFor(20, record + head.string());
  EXPECT_EQ(calm.exit_code, 0) << calm.err;
  EXPECT_EQ(calm.err.find("does not move"), std::string::npos) << calm.err;
  EXPECT_NE(calm.err.find(" strands stiffened to hold their shape under gravity (wavy "), std::string::npos)
      << calm.err;
  EXPECT_NE(calm.err.find(" of wavy\n"), std::string::npos) << calm.err;
}

TEST_F(Refusals, WhatWouldBeIgnoredIsRefused) {
  StrandSet strands;
  strands.append(std::vector<Vec3>{Vec3(0, 0, 0), Vec3(0, 0.1f, 0), Vec3(0, 0.2f, 0)});
  const std::filesystem::path hair = folder_ / "hair.tfx";
  writeGroom(hair, strands);
  write("hair.toml", "[groom]\nfiles = [\"hair.tfx\"]\n[body]\nfile = \"absent.obj\"\nclip = \"walk\"\n");
  write("curly.toml", "scene = \"curly\"\n[groom]\nlength = 0.1\n");
  const std::string record = program_ + " record " + (folder_ / "a.rec").string() +
                             " --backend reference --strands 20 --seconds 0.01 --json";
  const std::string hair_file = " --groom " + hair.string() + " --unit-meters 1";
  const auto config = [&](const char* name) { return " --config " + (folder_ / name).string(); };
  for (const auto& [options, advice] :
       {std::pair{std::string(" --body absent.obj"), "--groom"},
        std::pair{std::string(" --scene straight --body absent.obj"), "--groom"},
        std::pair{hair_file + " --scene straight", "leave one of them out"},
        std::pair{hair_file + " --length 0.5", "--length"},
        std::pair{std::string(" --config ''"), "has no name"},
        std::pair{std::string(" --motion ''"), "has no name"},
        std::pair{std::string(" --unit-meters 0.01"), "--groom"},
        std::pair{std::string(" --up z"), "--groom"},
        std::pair{hair_file + " --body-contact spheres", "give a --body"},
        std::pair{hair_file + " --body-cell 0.01", "give a --body"},
        std::pair{hair_file + " --body-unit-meters 0.01", "give a --body"},
        std::pair{hair_file + " --body-up z", "give a --body"},
        std::pair{hair_file + " --clip-unit-meters 0.01", "there is no .bvh clip"},
        std::pair{std::string(" --body-contact spheres --body-cell 0.01"), "--body-contact field"}}) {
    const Outcome r = tryFor(20, record + options);
    EXPECT_EQ(r.exit_code, 2) << options << r.out;
    EXPECT_NE(r.err.find(advice), std::string::npos) << options << "\n" << r.err;
  }
  if (STRANDCAST_GL) {
    EXPECT_NE(run(program_ + " bake a.obj --slices ''").err.find("name a folder"), std::string::npos);
  }
  for (const auto& [options, told] :
       {std::pair{" --set wind=1,2,3,", "'' is not a number"},
        std::pair{" --set air_drag=", "is not a number"},
        std::pair{" --material all:radius=5e-5,", "'' is not NAME=VALUE"},
        std::pair{" --material all:radius_curve=0:1/", "is not a number"},
        std::pair{" --seed 1e16", "'1e16' is not a whole number from 0 to 1000000000000000"},
        std::pair{" --seed -1", "is not a whole"}, std::pair{" --seed 1000000000000001", "is not a whole"}}) {
    const Outcome r = tryFor(20, record + " --scene straight" + options);
    EXPECT_EQ(r.exit_code, 2) << options << r.out;
    EXPECT_NE(r.err.find(told), std::string::npos) << options << "\n" << r.err;
  }
  const std::string url = " --lcm-url udpm://239.255.76.67:7667";
  for (const auto& [command, advice] :
       {std::pair{daemon_ + url, "--transport lcm"},
        std::pair{program_ + " ctl list" + url, "--transport lcm"},
        std::pair{program_ + " ctl list --transport lcm --peers 10.0.0.1", "--lcm-url"},
        std::pair{program_ + " replay a.rec --check --from 1", "--check"},
        std::pair{program_ + " replay a.rec --from 1.5 --to 0.5", "give a later --to"},
        std::pair{program_ + " replay a.rec --from 1 --to 1", "give a later --to"},
        std::pair{program_ + " replay a.rec --speed 1e-9", "too slow"},
        std::pair{program_ + " replay a.rec --resimulate --loop", "--resimulate"},
        std::pair{program_ + " replay a.rec --slice x", "--show"},
        std::pair{program_ + " replay a.rec --check --codec oct12", "--check"},
        std::pair{program_ + " info a.tfx --backends", "--backends"},
        std::pair{daemon_ + " --claim 1 --transport lcm", "share a groom over LCM"},
        std::pair{daemon_ + " --colector-folder a", "did you mean '--collider-folder'?"},
        std::pair{program_ + " ctl colider add", "did you mean 'collider'?"}}) {
    const Outcome r = tryFor(20, command);
    EXPECT_EQ(r.exit_code, 2) << command << r.out;
    EXPECT_NE(r.err.find(advice), std::string::npos) << command << "\n" << r.err;
  }
  for (const std::string& options :
       {hair_file, " --scene straight" + config("hair.toml"), hair_file + config("curly.toml")}) {
    const Outcome r = tryFor(60, record + options);
    EXPECT_EQ(r.exit_code, 0) << options << "\n" << r.err << "what only a file says gives way";
  }
}

TEST_F(Refusals, ARecordingThatIsNotWholeDoesNotPassItsCheck) {
  const std::filesystem::path file = folder_ / "a.rec", empty = folder_ / "empty.rec";
  ASSERT_EQ(run(program_ + " record " + file.string() +
                " --scene straight --strands 20 --backend reference --seconds 0.05")
                .exit_code,
            0);
  const auto check = [&](const std::filesystem::path& recording) {
    return run(program_ + " replay " + recording.string() + " --check --json");
  };
  EXPECT_EQ(check(file).exit_code, 0);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 10);
  const Outcome cut = check(file);
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_NE(cut.err.find("is truncated"), std::string::npos) << cut.err;
  EXPECT_EQ(nlohmann::json::parse(cut.out)["frames_damaged"], 0);

  Recorder(empty, {.groom_id = 1, .codec = {}, .source = "{}"}).close();
  const Outcome none = check(empty);
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_EQ(nlohmann::json::parse(none.out)["can_resimulate"], 0) << "--resimulate would not start";
  EXPECT_EQ(run(program_ + " replay " + empty.string() + " --resimulate").exit_code, 2);
}

TEST_F(Refusals, OutputThatCannotBeWrittenIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const auto outcome = [&](const std::string& command) { return run("sh -c '" + command + "'"); };
  for (const char* words :
       {" info --backends", " info --backends --json", " --help", " validate physics --list"}) {
    const Outcome r = outcome(program_ + words + " >/dev/full");
    EXPECT_EQ(r.exit_code, 2) << words;
    EXPECT_NE(r.err.find("error: standard output"), std::string::npos) << words << r.err;
  }
  EXPECT_EQ(outcome(daemon_ + " --help >/dev/full").exit_code, 2);
  const Outcome full = outcome(program_ +
                               " record /dev/full --scene straight --strands 20 --backend reference "
                               "--body-contact spheres --seconds 0.1");
  EXPECT_NE(full.err.find("is the disk full?"), std::string::npos) << full.err;
  EXPECT_EQ(full.err.find("publishing"), std::string::npos) << "nothing is cast: " << full.err;
  for (const char* ignoring : {"", "trap \"\" PIPE; "}) {
    for (const char* words : {" info --backends", " validate physics --list"}) {
      const Outcome left = outcome(ignoring + program_ + words + " | :");
      EXPECT_EQ(left.err, "") << words << ": nobody reads on, no failure";
    }
  }
}

}  // namespace
}  // namespace strandcast
