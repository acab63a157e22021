#include "apps/presets.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"

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

TEST(PictureSettings, RendererKeepsEveryValueThatTheyAllow) {
  for (const PictureSetting& setting : pictureSettings()) {
    if (setting.file != nullptr || setting.info.name == "light-direction") continue;  // which is made unit
    for (const double end : {setting.info.low, setting.info.high}) {
      PictureOptions options;
      setPicture(options, setting, std::vector<double>(setting.get(options).size(), end), "test");
      PictureOptions kept = options;
      kept.settings = clipped(options.settings);
      EXPECT_EQ(setting.get(kept), setting.get(options)) << setting.info.name << " " << end;
    }
  }
}

TEST(Presets, WhatIsWrittenIsRead) {
  PictureOptions picture;
  picture.settings.hair_width = 1.23456789e-4f;
  picture.settings.growth.interpolation = Interpolation::kSingleStrand;
  picture.settings.background = Vec3(0.1f, 0.2f, 0.3f);
  picture.settings.keep_out = true;
  picture.zoom = 2.5;
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
}

TEST(Presets, WhatIsNotNamedStays) {
  PictureOptions picture;
  picture.zoom = 3;
  readPresetText("[picture]\nsamples = 2\n", "preset", picture);
  EXPECT_EQ(picture.zoom, 3);
  EXPECT_EQ(picture.settings.samples, 2);
}

TEST(Presets, MistakesAreSaidWithTheirLineAndChangeNothing) {
  for (const auto& [text, says] : std::vector<std::pair<std::string, std::string>>{
           {"[picture]\nsamples = 2\nsampels = 2\n",
            "preset line 3, picture.sampels; did you mean 'samples'"},
           {"[picture]\nsamples = 99\n", "out of range"},
           {"[picture]\nsamples = 'many'\n", "not a number"},
           {"[picture]\ngeometry = \"tubes\"\n", "choose one of"},
           {"[picture]\npasses = [\"hair\", \"teeth\"]\n", "no pass 'teeth'"},
           {"[picture]\nhair-color = [1, 2]\n", "takes 3 numbers"},
           {"[parameters]\nair_darg = 1\n", "did you mean 'air_drag'"},
           {"[parameters]\nair_drag = -1\n", "out of range"},
           {"[daemon]\nrate = 1\n", "[parameters] and [picture]"},
           {"picture = 1\n", "[parameters] and [picture]"},
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
