// Settings that others make void, given by options and by files.
#include "options/settings.h"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>

#include "tests/expect_error.h"
#include "tests/io/scratch_folder.h"

namespace strandcast {
namespace {

class UnusedSettings : public ::testing::Test {
 protected:
  void SetUp() override { spdlog::set_level(spdlog::level::off); }
  void TearDown() override { spdlog::set_level(spdlog::level::info); }

  /// Resolves this text as --config, if any, and these options.
  Settings resolved(const std::string& options, const std::string& config = "",
                    SettingsUse use = SettingsUse::kServe) {
    CLI::App app;
    SettingsOptions settings(app, use);
    std::string words = options;
    if (!config.empty()) {
      std::ofstream(folder_ / "hair.toml") << config;
      words += " --config " + (folder_ / "hair.toml").string();
    }
    app.parse(words);
    return settings.resolve();
  }
  std::string refused(const std::string& options, const std::string& config = "") {
    const std::string error = errorOf([&] { resolved(options, config); });
    const size_t at = error.find(folder_.string());
    return at == std::string::npos ? error : error.substr(0, at) + error.substr(at + folder_.string().size());
  }
  bool isReported(const std::string& text, const std::string& options, const std::string& config = "",
                  SettingsUse use = SettingsUse::kServe) {
    const std::vector<std::string> told = resolved(options, config, use).warnings;
    return std::any_of(told.begin(), told.end(),
                       [&](const std::string& line) { return line.find(text) != std::string::npos; });
  }

  const ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_ / "";
};

TEST_F(UnusedSettings, ThatContradictEachOtherAreRefusedWithTheirPlace) {
  EXPECT_EQ(refused("", "scene = \"curly\"\n[groom]\nfiles = \"a.tfx\"\n"),
            "a procedural scene and a groom cannot be simulated together: hair.toml line 1, scene; leave one "
            "of them out");
  EXPECT_EQ(
      refused("", "[groom]\nunit_meters = 0.01\n"),
      "procedural hair is in metres: hair.toml line 2, groom.unit_meters; leave it out, or give a --groom");
  for (const auto& [options, told] :
       {std::pair{"--groom a.tfx --length 0.2", "--length"},
        std::pair{"--unit-meters 0.01", "procedural hair is in metres"},
        std::pair{"--up z", "procedural hair has Y up"},
        std::pair{"--groom a.tfx --body-cell 0.01", "there is no body"},
        std::pair{"--groom a.tfx --body b.obj --body-contact spheres --body-cell 0.01",
                  "spheres have no cells"},
        std::pair{"--codec float32 --codec-error 0.1", "float32 has no error"},
        std::pair{"--codec tangent --zstd", "zstd is for"},
        std::pair{"--codec oct12 --key-interval 5", "only the temporal codec"},
        std::pair{"--lcm-url udpm://239.255.76.67:7667", "--transport lcm"},
        std::pair{"--transport lcm --lcm-url udpm://239.255.76.67:7667 --domain 3", "gives the port"},
        std::pair{"--transport lcm --profile secure", "LCM has no security"},
        std::pair{"--transport lcm --peers 10.0.0.1", "LCM has no discovery"},
        std::pair{"--keys KEYS", "give --profile secure too"},
        std::pair{"--set air_drag=1 --set air_drag=2", "set twice"},
        std::pair{"--material all:radius=4e-5,radius=5e-5", "set twice"}}) {
    const std::string error = refused(options);
    EXPECT_NE(error.find(told), std::string::npos) << options << ": " << error;
  }
  Settings shared;
  shared.transport = "lcm";
  shared.given["claim"] = "--claim";
  EXPECT_EQ(errorOf([&] { checkUnusedNetworkSettings(shared); }),
            "daemons cannot share a groom over LCM: --claim; use --transport dds");
}

TEST_F(UnusedSettings, ThatOthersLeaveSomethingToDoAreTaken) {
  for (const char* options :
       {"--groom a.tfx --unit-meters 0.01 --up z", "--groom a.tfx --body b.obj --body-cell 0.01",
        "--unit-meters 0.01 --collider-folder props", "--codec temporal --key-interval 5",
        "--codec delta16 --zstd --codec-error 0.1", "--profile secure --keys KEYS",
        "--transport lcm --domain 3", "--set air_drag=1 --set air_drag=1",
        "--solver gauss_seidel --set shape_rate=20 --material all:tether=1.1"})
    EXPECT_EQ(refused(options), "") << options;
  const std::string with_mesh =
      "[groom]\nunit_meters = 0.01\n[[body.primitives]]\nkind = \"mesh\"\nfile = \"chair.obj\"\n";
  EXPECT_EQ(refused("", with_mesh), "") << "the chair has a unit";
}

TEST_F(UnusedSettings, ThatDoNothingAreReported) {
  EXPECT_TRUE(isReported("--material all:tether=1.1 is not used: the rod is inextensible",
                         "--material all:tether=1.1"));
  EXPECT_TRUE(isReported("line 2, material.tether is not used", "", "[[material]]\ntether = 1.1\n"));
  EXPECT_TRUE(isReported("only the rod", "--solver gauss_seidel --sag-free"));
  EXPECT_TRUE(isReported("has no elasticity", "--solver gauss_seidel --material all:youngs_modulus=3e9"));
  EXPECT_TRUE(isReported("groom files use no random numbers", "--groom a.tfx --seed 3"));
  EXPECT_TRUE(isReported("published twice", "--rate 120"));
  EXPECT_TRUE(isReported("consists of shapes", "--body-contact spheres"));
  EXPECT_TRUE(
      isReported("--set shape_rate=7 is not used: only --solver gauss_seidel uses it", "--set shape_rate=7"));
  EXPECT_TRUE(isReported("it needs wind_grid=1", "--set mac_cormack=1"));
  EXPECT_TRUE(isReported("it needs a wind", "--set gust=1"));
  EXPECT_TRUE(
      isReported("line 2, parameters.volume_hold is not used", "", "[parameters]\nvolume_hold = 2\n"));
  EXPECT_TRUE(isReported("line 4, body.primitives.extent is not used", "",
                         "[[body.primitives]]\nkind = \"sphere\"\nradius = 0.1\nextent = [1, 1, 1]\n"));
  EXPECT_TRUE(isReported("wind: direction, swirl is not used: a sphere has none", "",
                         "[[wind]]\nkind = \"sphere\"\ndirection = [1, 0, 0]\nradius = 1\nswirl = 3\n"));
  for (const char* options : {"--set wind_grid=1 --set mac_cormack=1", "--set wind=1,0,0 --set gust=1",
                              "--set hair_friction=1 --set grid_cells=48", "--rate 60",
                              "--set shape_rate=400", "--set time_step=0.004 --rate 120"})
    EXPECT_TRUE(resolved(options).warnings.empty()) << options << ": " << resolved(options).warnings.front();
  EXPECT_FALSE(isReported("gauss_seidel", "--set shape_rate=7", "", SettingsUse::kCompare))
      << "both solvers run";
}

TEST_F(UnusedSettings, OfAFileGiveWayToOptions) {
  const std::string groom = "[groom]\nfiles = \"a.tfx\"\nunit_meters = 0.01\n";
  const Settings grown = resolved("--scene curly", groom);
  EXPECT_TRUE(grown.scene.groom.empty());
  ASSERT_EQ(grown.notes.size(), 2u);
  EXPECT_NE(grown.notes[0].find("hair.toml line 2, groom.files is overridden by --scene"), std::string::npos)
      << grown.notes[0];
  const std::string exact = "[transport]\ncodec_error_mm = 0.05\n";
  EXPECT_TRUE(isReported("line 2, transport.codec_error_mm is not used", "--codec float32", exact));
  EXPECT_EQ(refused("--groom a.tfx", "scene = \"curly\"\n[groom]\nlength = 0.1\n"), "");
}

TEST_F(UnusedSettings, WhatRanOnceIsSimulatedAgain) {
  CLI::App app;
  const SettingsOptions settings(app, SettingsUse::kServe);
  app.parse("--codec float32 --codec-error 0.1");
  EXPECT_EQ(settings.resolve("").codec.codec, Codec::kFloat32);
}

TEST(VoidParameters, AreExplained) {
  Parameters parameters;
  EXPECT_EQ(unmetConditionOf(parameters, "mac_cormack"), "it needs wind_grid=1");
  parameters.wind_grid = 1;
  EXPECT_EQ(unmetConditionOf(parameters, "mac_cormack"), "");
  EXPECT_EQ(unmetConditionOf(parameters, "damping_time"), "");
  parameters.solver = SolverKind::kGaussSeidel;
  EXPECT_EQ(unmetConditionOf(parameters, "damping_time"), "only --solver rod uses it");
  EXPECT_EQ(unmetConditionOf(parameters, "iterations"), "");
  EXPECT_EQ(conditionOf("mac_cormack"), "it needs wind_grid=1") << "whatever the others are";
  EXPECT_EQ(conditionOf("gravity"), "");
}

}  // namespace
}  // namespace strandcast
