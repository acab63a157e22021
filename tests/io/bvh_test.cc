#include "io/bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <random>

#include "core/error.h"
#include "io/bvh_skeleton.h"
#include "tests/expect_error.h"
#include "tests/io/sample_clip.h"
#include "tests/real_data.h"

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
std::string bvhErrorOf(const std::string& text) {
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
  // A rotation of the root by 90 degrees about Z carries the head to its side.
  clip.values[3] = 90;
  EXPECT_NEAR((clip.pose(1, 0).position - Vec3(-2, 1, 0)).norm(), 0, 1e-5);
}

TEST(Bvh, RotationsMultiplyInTheOrderOfTheChannels) {
  BvhClip clip = parse(kSampleClip);  // root: Z, X, Y
  clip.values[3] = 90;
  clip.values[4] = 90;
  // X is applied first (innermost): Y -> Z; then Z leaves it unchanged.
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
  EXPECT_NE(bvhErrorOf(replaced("MyHead", "")).find("a joint has no name"), std::string::npos);
}

TEST(Bvh, ErrorsNameTheFileTheLineAndWhatIsWrong) {
  EXPECT_NE(bvhErrorOf("").find("the file ends early: clip.bvh, line 1"), std::string::npos);
  EXPECT_NE(bvhErrorOf("hello").find("expected HIERARCHY"), std::string::npos);
  EXPECT_NE(
      bvhErrorOf(replaced("OFFSET 0 1 0", "OFFSET 0 nan 0")).find("out of range: 'nan': clip.bvh, line 4"),
      std::string::npos);
  const std::string digits(100000, '9'), exponent = "1e" + digits;
  for (const auto& [number, shown] : {std::pair<std::string, std::string>{"inf", "inf"},
                                      {"-Infinity", "-Infinity"},
                                      {"1e999", "1e999"},
                                      {"2e9", "2e9"},
                                      {digits, digits.substr(0, 32) + "..."},
                                      {exponent, exponent.substr(0, 32) + "..."}})
    EXPECT_EQ(
        bvhErrorOf(replaced("OFFSET 0 1 0", "OFFSET 0 " + number + " 0")),
        "number is out of range: '" + shown + "': clip.bvh, line 4; check that the BVH file is complete");
  EXPECT_EQ(parse(replaced("OFFSET 0 1 0", "OFFSET 0 1e-" + digits + " 0")).joints[0].offset, Vec3(0, 0, 0));
  EXPECT_EQ(bvhErrorOf(replaced("OFFSET 0 1 0", "OFFSET 0 " + std::string(100000, 'x') + " 0")),
            "expected a number, found '" + std::string(32, 'x') +
                "...': clip.bvh, line 4; check that the BVH file is complete");
  EXPECT_NE(bvhErrorOf(replaced("OFFSET 0 1 0", "OFFSET 0 x1 0")).find("expected a number, found 'x1'"),
            std::string::npos);
  EXPECT_NE(bvhErrorOf(replaced("CHANNELS 6", "CHANNELS 7000")).find("number of channels must be"),
            std::string::npos);
  EXPECT_NE(bvhErrorOf(replaced("Xposition", "Wposition")).find("unknown channel 'Wposition'"),
            std::string::npos);
  EXPECT_NE(bvhErrorOf(replaced("Yposition", "Xposition")).find("given twice"), std::string::npos);
  EXPECT_NE(bvhErrorOf(replaced("JOINT", "JOIN")).find("found 'JOIN'"), std::string::npos);
}

bool warns(const BvhClip& clip, const std::string& of) {
  const std::vector<std::string>& lines = clip.report.warnings;
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(of) != std::string::npos; });
}

TEST(Bvh, TheWholeLinesArePlayedWhateverFramesSays) {
  for (const char* said : {"4", "6", "90000000", "0", "-5", "5.5", "4294967295", "4294967301",
                           "18446744073709551621", "1e400", "nan", "inf", "five"}) {
    const BvhClip clip = parse(replaced("Frames: 5", std::string("Frames: ") + said));
    EXPECT_EQ(clip.values, parse(kSampleClip).values) << said;
    EXPECT_TRUE(warns(clip, std::string("Frames says ") + said + ", the motion has 5 whole frames")) << said;
  }
  const BvhClip vast = parse(replaced("Frames: 5", "Frames: " + std::string(100000, '7')));
  EXPECT_TRUE(warns(vast, "Frames says " + std::string(32, '7') + "..., the motion has 5"));
  EXPECT_TRUE(parse(kSampleClip).report.warnings.empty());
  EXPECT_TRUE(warns(parse(replaced("Frames: 5\n", "")), "does not say how many frames"));
}

TEST(Bvh, ALineThatIsNotWholeIsLeftOutAndCounted) {
  const std::string last = "0 1 4 0 0 0 0 0 0\n";
  const std::string longest = "0 1 4 0 0 0 0 0 " + std::string(100000, '8') + '\n';
  for (const auto& [odd, fault] : {std::pair<std::string, std::string>{"0 1 4 0 0", "5 values"},
                                   {"0", "1 value"},
                                   {"0 1 4 0 0 0 0 0 nan\n", "'nan'"},
                                   {"-inf 1 4 0 0 0 0 0 nan\n", "'-inf'"},
                                   {"0 1 4 0 0 0 0 0 1e400\n", "'1e400'"},
                                   {"0 1 4 0 0 0 0 0 x\n", "'x'"},
                                   {"0 1 4 0 0 0 0 0 0 0\n", "10 values"},
                                   {"end of the motion\n", "'end'"},
                                   {longest, "'" + std::string(32, '8') + "...'"}}) {
    const BvhClip clip = parse(replaced(last, odd));
    EXPECT_EQ(clip.frames, 4u) << odd;
    EXPECT_TRUE(
        warns(clip, "1 line of the motion is left out, as it has not 9 numbers: line 23 (" + fault + ")"))
        << odd;
    EXPECT_TRUE(warns(clip, "Frames says 5, the motion has 4 whole frames")) << odd;
  }
  const BvhClip middle = parse(replaced("0 1 1 0 0 0 30 0 0\n", "0 1 1 0 0\n"));
  EXPECT_EQ(middle.frames, 4u);
  EXPECT_FLOAT_EQ(middle.pose(0, 1).position.x(), 0.5f) << "the others are not shifted";
  EXPECT_NE(bvhErrorOf(replaced("CHANNELS 3", "CHANNELS 2")).find("found 'Zrotation'"), std::string::npos)
      << "a name too many";
  std::string wrong = replaced("CHANNELS 3 Yrotation Xrotation Zrotation", "CHANNELS 2 Yrotation Xrotation");
  EXPECT_NE(bvhErrorOf(wrong).find("the lines of the motion have 9 to 9 values, the joints have 8 channels"),
            std::string::npos);
}

TEST(Bvh, FramesBrokenOverLinesAreRead) {
  std::string broken = kSampleClip;
  const size_t motion = broken.find("0.1\n") + 4;
  for (size_t at = motion, values = 0; at < broken.size(); ++at)
    if (broken[at] == ' ' && ++values % 3 == 0) broken[at] = '\n';
  EXPECT_EQ(parse(broken).values, parse(kSampleClip).values);
  for (const char* odd : {"nan", "-inf", "1e400", "x"}) {
    std::string damaged = broken;
    damaged.replace(damaged.rfind("60"), 2, odd);
    const BvhClip clip = parse(damaged);
    EXPECT_EQ(clip.frames, 4u) << odd;
    EXPECT_EQ(clip.pose(0, 2).position.z(), 3) << "the next is not shifted";
    EXPECT_TRUE(warns(
        clip,
        std::string("1 frame of the motion is left out, as it has not 9 numbers: line 28 ('") + odd + "')"))
        << odd;
  }
  EXPECT_NE(
      bvhErrorOf(broken.substr(0, motion) + "nan 1 0\n0 0 0\n0 0 0\n")
          .find(
              "no frame of the motion has 9 numbers, one a channel: the first has 'nan': clip.bvh, line 19"),
      std::string::npos);
  std::string joined = kSampleClip;
  std::replace(joined.begin() + static_cast<std::ptrdiff_t>(motion), joined.end(), '\n', ' ');
  EXPECT_EQ(parse(joined).values, parse(kSampleClip).values);
}

TEST(Bvh, AFrameTimeThatIsNotUsableIsTheUsualOne) {
  for (const char* time : {"Frame Time: 0\n", "Frame Time: -1\n", "Frame Time: 1e300\n",
                           "Frame Time: 1e400\n", "Frame Time: nan\n", "Frame Time:\n", ""}) {
    const BvhClip clip = parse(replaced("Frame Time: 0.1\n", time));
    EXPECT_DOUBLE_EQ(clip.frame_time, 1.0 / 30) << time;
    EXPECT_EQ(clip.values.size(), 45u) << time;
    EXPECT_TRUE(warns(clip, "1/30 s is taken")) << time;
  }
  EXPECT_TRUE(warns(parse(replaced("0.1\n", "33.3333\n")), "milliseconds"));
  EXPECT_TRUE(warns(parse(replaced("Frame Time: 0.1", "Frame Time: inf")), "the frame time is 'inf'"));
}

TEST(Bvh, KeywordsLineEndsAndBlanksAreTakenAsProgramsWriteThem) {
  const BvhClip plain = parse(kSampleClip);
  const auto all = [](std::string text, const std::string& from, const std::string& to) {
    for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
    return text;
  };
  std::string lower = kSampleClip;
  for (const char* word : {"HIERARCHY", "ROOT", "OFFSET", "CHANNELS", "JOINT", "End Site", "MOTION", "Frames",
                           "Time", "Xposition", "Yrotation"}) {
    std::string small = word;
    std::transform(small.begin(), small.end(), small.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    lower = all(lower, word, small);
  }
  const size_t frames = kSampleClip.find("0.1\n") + 4;
  const std::string commas = kSampleClip.substr(0, frames) + all(kSampleClip.substr(frames), " ", ", ");
  for (const std::string& text :
       {lower, all(kSampleClip, "\n", "\r"), all(kSampleClip, "\n", "\r\n"), all(kSampleClip, "  ", "\t"),
        all(kSampleClip, "\n", "\n\n"), all(kSampleClip, "\n  {", " {"),
        all(kSampleClip, "End Site\n    {", "End Site{"), all(kSampleClip, "End Site", "End Site LeftToe"),
        all(kSampleClip, "End Site", "EndSite"), all(kSampleClip, "Frames: 5", "FRAMES:5"),
        all(kSampleClip, "Frames: 5", "Frames 5"), all(kSampleClip, "Frame Time: ", "Frame Time :"),
        all(kSampleClip, "Frame Time: ", "FrameTime\t"),
        all(kSampleClip, "Frames: 5\nFrame Time: 0.1", "Frame Time: 0.1\nFrames: 5"),
        all(kSampleClip, "Frames: 5\n", "Frames: 5 "), commas, kSampleClip + "\n\n \n",
        kSampleClip + std::string(4, '\0'),
        replaced("OFFSET 0 2 0\n    CHANNELS 3 Yrotation Xrotation Zrotation",
                 "CHANNELS 3 Yrotation Xrotation Zrotation OFFSET 0 2 0")}) {
    const BvhClip clip = parse(text);
    EXPECT_EQ(clip.values, plain.values) << text;
    EXPECT_EQ(clip.frame_time, plain.frame_time) << text;
    EXPECT_TRUE(clip.report.warnings.empty()) << clip.report.warnings[0] << text;
    for (size_t j = 0; j < plain.joints.size(); ++j) {
      EXPECT_EQ(clip.joints[j].name, plain.joints[j].name) << text;
      EXPECT_EQ(clip.joints[j].offset, plain.joints[j].offset) << text;
      EXPECT_EQ(clip.joints[j].channels, plain.joints[j].channels) << text;
    }
  }
  const BvhClip decimal = parse(all(all(kSampleClip, "0.1", "0,1"), "0.5", "0,5"));
  EXPECT_EQ(decimal.values, plain.values);
  EXPECT_TRUE(warns(decimal, "commas in numbers are read as decimal points"));
}

TEST(Bvh, JointsMayLackOffsetsOrChannelsAndHaveScales) {
  const BvhClip bare = parse(replaced("OFFSET 0 2 0\n    ", ""));
  EXPECT_EQ(bare.joints[1].offset, Vec3(0, 0, 0));
  EXPECT_TRUE(warns(bare, "1 joint has no OFFSET"));
  std::string text =
      replaced("CHANNELS 3 Yrotation Xrotation Zrotation", "CHANNELS 4 Yrotation Yscale Xrotation Zrotation");
  for (size_t at = text.find("0.1\n") + 4; (at = text.find('\n', at)) != std::string::npos; at += 3)
    text.replace(at, 1, " 7\n");
  const BvhClip scaled = parse(text);
  EXPECT_EQ(scaled.report.left_out, std::vector<std::string>{"scale channels"});
  EXPECT_EQ(scaled.frames, 5u);
  const std::string two =
      "HIERARCHY ROOT a { OFFSET 0 0 0 JOINT b { OFFSET 0 1 0 CHANNELS 1 Zrotation } }\n"
      "ROOT c d { OFFSET 1 0 0 CHANNELS 1 Xposition }\nMOTION\nFrames: 1\nFrame Time: 0.1\n90 5\n";
  const BvhClip roots = parse(two);
  ASSERT_EQ(roots.joints.size(), 3u);
  EXPECT_EQ(roots.joints[2].name, "c d");
  EXPECT_EQ(roots.joints[2].parent, -1);
  EXPECT_EQ(roots.pose(2, 0).position, Vec3(5, 0, 0));
}

TEST(Bvh, JointsOfOneNameAreReported) {
  const auto clip = [](const std::vector<std::string>& names) {
    std::string text = "HIERARCHY\n", frame;
    for (const std::string& name : names) {
      text += "ROOT " + name + "\n{\nOFFSET 0 1 0\nCHANNELS 1 Xposition\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n";
      frame += "5 ";
    }
    return parse(text + "MOTION\nFrames: 1\nFrame Time: 0.1\n" + frame + "\n");
  };
  const std::string told = "joints have one name, and the first of each in the file is taken: ";
  const BvhClip arms = clip({"hip", "arm", "Arm", "arm", "arm"});
  EXPECT_TRUE(warns(arms, told + "'arm' (3)"));
  EXPECT_EQ(arms.find("arm"), 2) << "after the end of the hip";
  EXPECT_TRUE(warns(clip({"a", "a", "b", "b", "c", "c", "d", "d"}), told + "'a' (2), 'b' (2), 'c' (2), ..."));
  EXPECT_TRUE(warns(clip({"My head", "My head"}), told + "'My head' (2)"));
  EXPECT_TRUE(clip({"hip", "Hip", "hip_"}).report.warnings.empty()) << "End Sites share theirs";
}

TEST(Bvh, PositionChannelsAreTheSkeletonWhereOffsetsAreZero) {
  const std::string place = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";
  const auto clip = [&](const std::string& offset) {
    return parse("HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\n" + place + "JOINT head\n{\nOFFSET " + offset +
                 "\n" + place + "}\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n5 100 7 0 0 90 0 60 0 0 0 0\n");
  };
  for (const char* offset : {"0 60 0", "0 0 0"}) {
    EXPECT_EQ(clip(offset).restPosition(1), Vec3(0, 60, 0)) << offset;
    EXPECT_EQ(clip(offset).size(), 60) << offset;
  }
}

TEST(BvhUnits, BonesThatMatchABodyTellUnitAndAxisOfItsClip) {
  Skeleton animal;  // with its length along Z
  animal.joints = {{"tail", -1, {Vec3(0, 0.5f, -0.6f)}},
                   {"spine", 0, {Vec3(0, 0, 0.6f)}},
                   {"Head", 1, {Vec3(0, 0, 0.6f)}}};
  const std::string place = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";
  const auto clip = [&](const std::string& offset, const std::string& position) {
    return parse("HIERARCHY\nROOT tail\n{\nOFFSET 0 0 0\n" + place + "JOINT spine\n{\nOFFSET " + offset +
                 "\n" + place + "JOINT Head\n{\nOFFSET " + offset + "\n" + place +
                 "}\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n" + "0 50 0 0 0 0 " + position + " 0 0 0 " +
                 position + " 0 0 0\n");
  };
  const struct {
    const char *offset, *position;
    float unit;
    bool is_turned;
  } kClips[] = {{"0 0 60", "0 0 60", 0.01f, false},
                {"0 0 0", "0 0 60", 0.01f, false},
                {"0 0 0.6", "0 0 0", 1, false},
                {"0 -600 0", "0 -600 0", 0.001f, true},
                {"0 0 0", "0 -6 0", 0.1f, true}};
  for (const auto& given : kClips) {
    const BvhClip read = clip(given.offset, given.position);
    const BvhMatch match(read, animal);
    EXPECT_EQ(match.joints, 3u);
    EXPECT_EQ(match.bones.size(), 2u) << given.offset;
    EXPECT_NEAR(unitOf(read, &match, 0).meters, given.unit, 1e-5f * given.unit)
        << given.offset << ", " << given.position;
    EXPECT_EQ(match.upright(read, 2).isApprox(Quat::Identity()), !given.is_turned) << given.offset;
  }
}

TEST(Bvh, DeepNestingIsRefused) {
  std::string text = "HIERARCHY\nROOT a\n";
  for (int i = 0; i < 100000; ++i) text += "{ OFFSET 0 0 0\nJOINT b\n";
  EXPECT_NE(bvhErrorOf(text).find("nested too deep"), std::string::npos);
}

TEST(Bvh, TruncationsAreRefusedOrPlayedUpToTheLastWholeLine) {
  const size_t first = kSampleClip.find("0 1 0 0 0 0 0 0 0\n") + 17;
  for (size_t length = 0; length < kSampleClip.size(); ++length) {
    if (length < first) {
      EXPECT_NE(bvhErrorOf(kSampleClip.substr(0, length)), "no error") << length;
      continue;
    }
    const BvhClip clip = parse(kSampleClip.substr(0, length));
    EXPECT_GE(clip.frames, 1u);
    EXPECT_EQ(clip.values.size(), clip.frames * 9);
    if (clip.frames < 5) {
      EXPECT_TRUE(warns(clip, "Frames says 5")) << length;
    }
  }
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
      ASSERT_EQ(clip.values.size(), clip.frames * clip.channels);
      for (size_t j = 0; j < clip.joints.size(); ++j) clip.pose(j, clip.frames - 1);
      EXPECT_TRUE(std::isfinite(clip.guessedUnit()));
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
    return errorOf([&] { readBvh(std::filesystem::path(file)); });
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
