#include "scenes/bvh.h"

#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "tests/error_of.h"
#include "tests/real_data.h"
#include "tests/scenes/sample_clip.h"

namespace strandcast {
namespace {

BvhClip parse(const std::string& text) {
  return readBvh(std::as_bytes(std::span(text.data(), text.size())), "clip.bvh");
}
std::string replaced(const std::string& from, const std::string& to) {
  std::string text = kSampleClip;
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}
std::string errorOf(const std::string& text) {
  try {
    parse(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Bvh, ReadsTheHierarchyAndTheFrames) {
  const BvhClip clip = parse(kSampleClip);
  ASSERT_EQ(clip.joints.size(), 3u);
  EXPECT_EQ(clip.joints[1].name, "MyHead");
  EXPECT_EQ(clip.joints[1].parent, 0);
  EXPECT_EQ(clip.joints[1].first_channel, 6u);
  EXPECT_EQ(clip.joints[1].channels[0], BvhChannel::kYRotation);
  EXPECT_EQ(clip.joints[2].parent, 1);
  EXPECT_EQ(clip.channels, 9u);
  EXPECT_EQ(clip.frames, 5u);
  EXPECT_DOUBLE_EQ(clip.frame_time, 0.1);
  EXPECT_EQ(clip.values.size(), 45u);
  EXPECT_EQ(clip.find(""), 1);
  EXPECT_EQ(clip.find("Hips"), 0);
  EXPECT_EQ(clip.find("Tail"), -1);
}

TEST(Bvh, PosesFollowTheParents) {
  BvhClip clip = parse(kSampleClip);
  const Pose pose = clip.pose(1, 2);
  EXPECT_NEAR((pose.position - Vec3(0.5f, 3, 2)).norm(), 0, 1e-5);
  EXPECT_NEAR((pose.rotate(Vec3::UnitX()) - Vec3(0.5f, 0, -std::sqrt(0.75f))).norm(), 0,
              1e-5);  // 60 degrees about Y
  // The root turned by 90 degrees about Z carries the head to its side.
  clip.values[3] = 90;
  EXPECT_NEAR((clip.pose(1, 0).position - Vec3(-2, 1, 0)).norm(), 0, 1e-5);
}

TEST(Bvh, RotationsMultiplyInTheOrderOfTheChannels) {
  BvhClip clip = parse(kSampleClip);  // root: Z, X, Y
  clip.values[3] = 90;
  clip.values[4] = 90;
  // X first (the inner one): Y -> Z, then Z leaves it.
  EXPECT_NEAR((clip.pose(0, 0).rotate(Vec3::UnitY()) - Vec3::UnitZ()).norm(), 0, 1e-5);
}

TEST(Bvh, ChannelsMayComeInAnyOrderAndNumber) {
  const BvhClip clip = parse(replaced("6 Xposition Yposition Zposition Zrotation Xrotation Yrotation",
                                      "6 Yrotation Zposition Xrotation Xposition Zrotation Yposition"));
  EXPECT_EQ(clip.joints[0].channels[1], BvhChannel::kZPosition);
}

TEST(Bvh, WhatProgramsWriteBesidesIsTaken) {
  const BvhClip marked = parse("\xef\xbb\xbf" + replaced("JOINT MyHead", "JOINT My head \t"));
  EXPECT_EQ(marked.joints[1].name, "My head");
  EXPECT_EQ(marked.find(""), 1);
  const BvhClip braced = parse(replaced("MyHead\n  {", "My head {"));
  EXPECT_EQ(braced.joints[1].name, "My head");
  const BvhClip numbers = parse(replaced("0 1 1 0", "+0.5 1e-400 -1e-400 0"));
  EXPECT_EQ(numbers.pose(0, 1).position, Vec3(0.5f, 0, 0));
  EXPECT_NE(errorOf(replaced("0 1 1 0", "0 1e400 1 0")).find("expected a number"), std::string::npos);
  EXPECT_NE(errorOf(replaced("MyHead", "")).find("a joint has no name"), std::string::npos);
}

TEST(Bvh, ErrorsNameTheFileTheLineAndWhatIsWrong) {
  EXPECT_NE(errorOf("").find("the file ends early: clip.bvh, line 1"), std::string::npos);
  EXPECT_NE(errorOf("hello").find("expected HIERARCHY"), std::string::npos);
  EXPECT_NE(errorOf(replaced("0 1 1 0", "0 nan 1 0")).find("clip.bvh, line 20"), std::string::npos);
  EXPECT_NE(errorOf(replaced("0 1 1 0", "0 inf 1 0")).find("out of range"), std::string::npos);
  EXPECT_NE(errorOf(replaced("0 1 1 0", "0 x1 1 0")).find("expected a number, found 'x1'"),
            std::string::npos);
  EXPECT_NE(errorOf(replaced("Frames: 5", "Frames: 6")).find("ends"), std::string::npos);
  EXPECT_NE(errorOf(replaced("Frames: 5", "Frames: 4")).find("more values"), std::string::npos);
  EXPECT_NE(errorOf(replaced("Frames: 5", "Frames: 90000000")).find("ends before its last frame"),
            std::string::npos);
  EXPECT_NE(errorOf(replaced("Frames: 5", "Frames: -5")).find("number of frames must be"), std::string::npos);
  EXPECT_NE(errorOf(replaced("Frames: 5", "Frames: 0")).find("number of frames must be"), std::string::npos);
  EXPECT_NE(errorOf(replaced("0.1\n", "0\n")).find("frame time must be"), std::string::npos);
  EXPECT_NE(errorOf(replaced("CHANNELS 6", "CHANNELS 7000")).find("number of channels must be"),
            std::string::npos);
  EXPECT_NE(errorOf(replaced("Xposition", "Wposition")).find("unknown channel 'Wposition'"),
            std::string::npos);
  EXPECT_NE(errorOf(replaced("Yposition", "Xposition")).find("given twice"), std::string::npos);
  EXPECT_NE(errorOf(replaced("JOINT", "JOIN")).find("found 'JOIN'"), std::string::npos);
}

TEST(Bvh, DeepNestingIsRefused) {
  std::string text = "HIERARCHY\nROOT a\n";
  for (int i = 0; i < 100000; ++i) text += "{ OFFSET 0 0 0\nJOINT b\n";
  EXPECT_NE(errorOf(text).find("nested too deep"), std::string::npos);
}

TEST(Bvh, EveryTruncationIsRefused) {
  // Up to the last line, whose last characters may be cut without harm.
  for (size_t length = 0; length + 4 < kSampleClip.size(); ++length)
    EXPECT_NE(errorOf(kSampleClip.substr(0, length)), "no error") << length;
}

TEST(Bvh, DamagedClipsAreReadOrRefusedNeverWorse) {
  std::mt19937 random(1);
  int read = 0, refused = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string text = kSampleClip;
    for (unsigned k = 0; k < 1 + random() % 4; ++k) {
      const size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random());
          break;
        case 1:
          text.erase(at, 1 + random() % 12);
          break;
        case 2:
          text.insert(at, text.substr(random() % text.size(), random() % 40));
          break;
        default:
          text.insert(at, std::to_string(random()));
          break;
      }
    }
    try {
      const BvhClip clip = parse(text);
      for (size_t j = 0; j < clip.joints.size(); ++j) clip.pose(j, clip.frames - 1);
      ++read;
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(read, 0);
  EXPECT_GT(refused, 0);
}

TEST(Bvh, FilesAreReadAsOthersAre) {
  const auto complaint = [](const char* file) {
    return strandcast::errorOf([&] { readBvh(std::filesystem::path(file)); });
  };
  EXPECT_NE(complaint("/nowhere/walk.bvh").find("the file cannot be found: /nowhere/walk.bvh"),
            std::string::npos);
  EXPECT_NE(complaint("/dev/zero").find("not a regular file: /dev/zero"), std::string::npos);
  EXPECT_NE(complaint("/tmp").find("this is a directory: /tmp"), std::string::npos);
}

TEST(Bvh, ReadsRealClips) {
  for (const char* name : {"mh_walk1.bvh", "mh_zombieWalk1.bvh"}) {
    const auto file = dataFolder() / "motion" / name;
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << " (set STRANDCAST_DATA)";
    const BvhClip clip = readBvh(file);
    EXPECT_NEAR(clip.frame_time, 1.0 / 24, 1e-3);
    EXPECT_GT(clip.frames, 5u);
    const int head = clip.find("");
    ASSERT_GE(head, 0);
    EXPECT_EQ(clip.joints[static_cast<size_t>(head)].name, "Head");
    EXPECT_TRUE(clip.pose(static_cast<size_t>(head), clip.frames - 1).position.allFinite());
  }
}

}  // namespace
}  // namespace strandcast
