#include "options/presets.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "options/picture_options.h"
#include "tests/expect_error.h"
#include "tests/full_disk.h"
#include "tests/io/scratch_folder.h"

namespace strandcast {
namespace {

TEST(PictureSettings, HaveNamesOfTheirOwnUnitsOrRangesAndHelp) {
  std::set<std::string> names;
  for (const PictureSetting& setting : pictureSettings()) {
    EXPECT_TRUE(names.insert(setting.info.name).second) << setting.info.name;
    EXPECT_GT(setting.info.help.size(), 5u) << setting.info.name;
    if (setting.file != nullptr) continue;
    PictureOptions options;
    const std::vector<double> usual = setting.get(options);
    EXPECT_NO_THROW(setPicture(options, setting, usual, "test")) << "the default is in range";
    EXPECT_EQ(setting.get(options), usual) << setting.info.name;
    const std::vector<double> low(usual.size(), setting.info.low), high(usual.size(), setting.info.high);
    for (const auto& values : {low, high}) {
      setPicture(options, setting, values, "test");
      for (size_t i = 0; i < values.size(); ++i)
        EXPECT_FLOAT_EQ(static_cast<float>(setting.get(options)[i]), static_cast<float>(values[i]))
            << setting.info.name;
    }
    EXPECT_THROW(setPicture(options, setting, std::vector<double>(usual.size(), setting.info.high + 1), "t"),
                 Error);
    EXPECT_THROW(setPicture(options, setting, {}, "t"), Error);
  }
}

TEST(PictureSettings, RefuseALightThatGoesNowhere) {
  PictureOptions options;
  const PictureSetting& setting = pictureSetting("light-direction", "test");
  EXPECT_THROW(setPicture(options, setting, {0, 0, 0}, "test"), Error);
  EXPECT_EQ(options.settings.lights[0].direction, Light{}.direction);
  EXPECT_NO_THROW(setPicture(options, setting, {0, 0, -0.1}, "test"));
}

TEST(PictureSettings, RendererKeepsEveryValueThatTheyAllow) {
  for (const PictureSetting& setting : pictureSettings()) {
    if (setting.file != nullptr || setting.info.name == "light-direction") continue;  // is normalised
    for (const double end : {setting.info.low, setting.info.high}) {
      PictureOptions options;
      setPicture(options, setting, std::vector<double>(setting.get(options).size(), end), "test");
      PictureOptions kept = options;
      kept.settings = clipped(options.settings);
      EXPECT_EQ(setting.get(kept), setting.get(options)) << setting.info.name << " " << end;
    }
  }
}

TEST(VoidPictureOptions, AreReportedWithTheReason) {
  PictureOptions options;
  PictureArguments arguments(options);
  const auto set = [&](const char* name, const std::vector<double>& values) {
    arguments.set(pictureSetting(name, "test"), values);
  };
  EXPECT_TRUE(unusedPictureOptions(options).empty());
  set("light-cone", {30});
  EXPECT_EQ(unusedPictureOptions(options),
            std::vector<std::string>{"--light-cone is not used: the light is no spot"});
  set("light", {2});  // a spot, set after its cone
  set("light-cone", {40});
  set("zoom", {2});
  set("shadow-map", {64});
  EXPECT_TRUE(unusedPictureOptions(options).empty()) << "it is a spot now";
  set("shadows", {0});
  EXPECT_EQ(unusedPictureOptions(options).back(), "--shadow-map is not used: --shadows is off");
  set("clearance", {0.001});
  EXPECT_EQ(unusedPictureOptions(options).back(), "--clearance is not used: --keep-out is off");
  set("keep-out", {1});
  set("curl-strand", {3});
  EXPECT_EQ(unusedPictureOptions(options).back(), "--curl-strand is not used: there is no --curl-example");
}

TEST(Presets, WhatIsWrittenIsRead) {
  PictureOptions picture;
  picture.settings.hair_width = 1.23456789e-4f;
  picture.settings.growth.interpolation = Interpolation::kSingleStrand;
  picture.settings.background = Vec3(0.1f, 0.2f, 0.3f);
  picture.settings.keep_out = true;
  picture.zoom = 2.5;
  addLight(picture, "test");
  picture.settings.lights[0].kind = LightKind::kSpot;
  picture.settings.lights[0].cone = 0.3f;
  picture.settings.lights[1].color = Vec3(1, 0.5f, 0.25f);
  picture.settings.lights[1].casts_shadow = false;
  picture.density_map = "a \"map\" \\ of.png";
  std::swap(picture.settings.passes[4], picture.settings.passes[7]);
  picture.settings.passes.erase(picture.settings.passes.begin() + 6);
  const NamedValues parameters{{"air_drag", {2.5}}, {"wind", {1, 0, -3}}};
  const std::string text = presetText(parameters, picture);
  PictureOptions read;
  EXPECT_EQ(readPresetText(text, "preset", read), parameters);
  EXPECT_EQ(presetText(parameters, read), text);
  EXPECT_EQ(read.settings.hair_width, picture.settings.hair_width);
  EXPECT_EQ(read.settings.passes, picture.settings.passes);
  EXPECT_EQ(read.density_map, picture.density_map);
  ASSERT_EQ(read.settings.lights.size(), 2u);
  EXPECT_EQ(read.settings.lights[0].kind, LightKind::kSpot);
  EXPECT_EQ(read.settings.lights[1], picture.settings.lights[1]);
}

TEST(Presets, AFullDiskLeavesTheOldOne) {
  const ScratchFolder folder;
  const NamedValues parameters{{"air_drag", {2.5}}};
  PictureOptions picture;
  writePreset(folder / "p.toml", parameters, picture);
  {
    const FullDisk disk(100);
    EXPECT_THROW(writePreset(folder / "p.toml", {}, picture), Error);
  }
  EXPECT_EQ(readPreset(folder / "p.toml", picture), parameters);
}

TEST(Presets, LightsTakeThePlaceOfThoseBeforeOrStay) {
  PictureOptions picture;
  addLight(picture, "test");
  const std::vector<Light> two = picture.settings.lights;
  readPresetText("[picture]\nsamples = 2\n", "preset", picture);
  EXPECT_EQ(picture.settings.lights, two);
  readPresetText("[[light]]\nkind = \"point\"\n[[light]]\nintensity = 2\n[[light]]\n", "preset", picture);
  ASSERT_EQ(picture.settings.lights.size(), 3u);
  EXPECT_EQ(picture.settings.lights[0].kind, LightKind::kPoint);
  EXPECT_EQ(picture.settings.lights[1].intensity, 2);
  EXPECT_EQ(picture.settings.lights[2], Light());
  EXPECT_EQ(picture.light, 0u);
  // The format of presets before pictures could have several lights.
  readPresetText("[picture]\nlight = \"spot\"\nlight-cone = 30\n", "preset", picture);
  ASSERT_EQ(picture.settings.lights.size(), 1u);
  EXPECT_EQ(picture.settings.lights[0].kind, LightKind::kSpot);
}

TEST(Presets, WhatIsNotNamedStays) {
  PictureOptions picture;
  picture.zoom = 3;
  readPresetText("[picture]\nsamples = 2\n", "preset", picture);
  EXPECT_EQ(picture.zoom, 3);
  EXPECT_EQ(picture.settings.samples, 2);
}

TEST(PictureArguments, SettingsOfLightsAreOfTheOneNamedLast) {
  const auto set = [](PictureArguments& arguments, const char* name, const std::vector<double>& values) {
    arguments.set(pictureSetting(name, "test"), values);
  };
  PictureOptions options;
  PictureArguments arguments(options);
  const std::vector<Light>& lights = options.settings.lights;
  set(arguments, "light-intensity", {0.5});
  EXPECT_EQ(lights.size(), 1u);
  set(arguments, "light", {1});
  ASSERT_EQ(lights.size(), 1u);
  EXPECT_EQ(lights[0].kind, LightKind::kPoint);
  EXPECT_EQ(lights[0].intensity, 0.5f) << "what is said before it stays";
  set(arguments, "light", {2});
  set(arguments, "light-color", {1, 0.5, 0});
  set(arguments, "samples", {2});
  set(arguments, "light", {0});
  set(arguments, "light-shadow", {0});
  ASSERT_EQ(lights.size(), 3u);
  EXPECT_EQ(lights[1].kind, LightKind::kSpot);
  EXPECT_EQ(lights[1].color, Vec3(1, 0.5f, 0));
  EXPECT_EQ(lights[1].intensity, 1);
  EXPECT_TRUE(lights[1].casts_shadow);
  EXPECT_FALSE(lights[2].casts_shadow);
  EXPECT_EQ(options.light, 0u);
  const std::vector<Light> given = lights;

  // A preset with two lights, given after the options: the options override it.
  const ScratchFolder folder;
  PictureOptions preset;
  addLight(preset, "test");
  preset.settings.lights[0].cone_edge = 0.75f;
  preset.zoom = 3;
  writePreset(folder / "p.toml", {}, preset);
  arguments.readPreset((folder / "p.toml").string());
  ASSERT_EQ(lights.size(), 3u);
  EXPECT_EQ(options.zoom, 3);
  EXPECT_EQ(lights[0].cone_edge, 0.75f) << "what no option says is the preset's";
  EXPECT_EQ(lights[0].kind, LightKind::kPoint);
  EXPECT_EQ(lights[1], given[1]);

  // Without the option --light, the preset's lights are kept.
  PictureOptions others;
  PictureArguments few(others);
  set(few, "light-intensity", {0.25});
  few.readPreset((folder / "p.toml").string());
  ASSERT_EQ(others.settings.lights.size(), 2u);
  EXPECT_EQ(others.settings.lights[0].intensity, 0.25f);
  EXPECT_EQ(others.settings.lights[1], Light());

  set(arguments, "light", {0});
  EXPECT_NE(errorOf([&] { set(arguments, "light", {0}); }).find("at most 4 lights: --light"),
            std::string::npos);
}

TEST(Presets, MistakesAreSaidWithTheirLineAndChangeNothing) {
  for (const auto& [text, says] : std::vector<std::pair<std::string, std::string>>{
           {"[picture]\nsamples = 2\nsampels = 2\n",
            "preset line 3, picture.sampels; did you mean 'samples'"},
           {"[picture]\nsamples = 99\n", "out of range"},
           {"[picture]\nsamples = 'many'\n", "not a number"},
           {"[picture]\ngeometry = \"tubes\"\n", "choose one of"},
           {"[picture]\npasses = [\"hair\", \"teeth\"]\n", "unknown pass 'teeth'"},
           {"[picture]\nhair-color = [1, 2]\n", "takes 3 numbers"},
           {"[parameters]\nair_darg = 1\n", "did you mean 'air_drag'"},
           {"[parameters]\nair_drag = -1\n", "out of range"},
           {"[daemon]\nrate = 1\n", "[parameters], [picture] and [[light]]"},
           {"picture = 1\n", "[parameters], [picture] and [[light]]"},
           {"light = 3\n", "not a list of lights"},
           {"light = []\n", "not a list of lights"},
           {"[light]\nkind = \"spot\"\n", "not a list of lights"},
           {"[[light]]\n\nintenisty = 3\n", "preset line 3, light.intenisty; did you mean 'light-intensity'"},
           {"[[light]]\nkind = \"lava\"\n", "choose one of"},
           {"[[light]]\n[[light]]\n[[light]]\n[[light]]\n[[light]]\n", "at most 4 lights: preset line 5"},
           {"[[light]]\n[picture]\nlight-cone = 30\n", "given twice"},
           {"[picture\n", "preset line 1"}}) {
    PictureOptions picture;
    const std::string before = presetText({}, picture);
    try {
      readPresetText(text, "preset", picture);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
    EXPECT_EQ(presetText({}, picture), before);
  }
}

}  // namespace
}  // namespace strandcast
