#include "transport/recording/recording.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <random>
#include <sstream>

#include "bound_hairs.h"
#include "core/error.h"
#include "core/hash.h"
#include "moving_hair.h"
#include "recording_fuzz.h"
#include "tests/expect_error.h"
#include "tests/full_disk.h"
#include "tests/io/scratch_folder.h"
#include "transport/in_process.h"
#include "transport/message_bytes.h"
#include "transport/recording/old_messages.h"
#include "transport/recording/recorder.h"
#include "transport/wire_fields.h"

namespace strandcast {
namespace {

constexpr size_t kStrands = 60;

GroomDescription smallGroom(uint64_t session = 11) {
  GroomDescription groom = hairGroom(kStrands, [](size_t s) { return 2 + s % 5; });
  groom.session = session;
  return groom;
}

Command inputOf(uint64_t id) {
  Command command;
  command.groom_id = 1;
  command.id = id;
  command.kind = CommandKind::kSetParameter;
  command.name = "wind";
  command.values = {1, 2, 3};
  return command;
}

/// Records frames 1 to `frames` at 60 Hz, with a command before frame 3.
void record(const std::filesystem::path& file, uint64_t frames, Codec codec = Codec::kFloat32,
            bool is_closed = true) {
  const GroomDescription groom = smallGroom();
  RecordingOptions options;
  options.codec.codec = codec;
  options.source = "how it was made";
  auto recorder = std::make_unique<Recorder>(file, options);
  recorder->setGroom(groom, sampleBody(4));
  for (uint64_t number = 1; number <= frames; ++number) {
    if (number == 3) recorder->addInput(inputOf(33));
    EXPECT_TRUE(recorder->addFrame(hairFrame(groom, number)));
  }
  const uint64_t open_bytes = recorder->bytes();
  recorder.reset();
  if (!is_closed) std::filesystem::resize_file(file, open_bytes);
}

std::vector<uint8_t> bytesOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(RecordingTest, GivesBackWhatWasRecordedInAnyOrder) {
  const ScratchFolder folder;
  constexpr uint64_t kFrames = 2 * kIndexFrames + 100;
  record(folder / "a.rec", kFrames);
  Recording recording(folder / "a.rec");
  EXPECT_FALSE(recording.isCut());
  EXPECT_EQ(recording.frames(), kFrames);
  EXPECT_NEAR(recording.seconds(), static_cast<double>(kFrames - 1) / 60, 1e-9);
  EXPECT_EQ(recording.head().source, "how it was made");
  EXPECT_NE(recording.head().layout.find("big-endian"), std::string::npos) << "it says how to read it";
  const GroomDescription groom = smallGroom();
  RecordedFrame read;
  for (const uint64_t number : {uint64_t{0}, kFrames - 1, uint64_t{1}, uint64_t{2}, kIndexFrames,
                                kIndexFrames - 1, 2 * kIndexFrames, uint64_t{77}}) {
    recording.read(number, read);
    const GuideFrame expected = hairFrame(groom, number + 1);
    EXPECT_EQ(read.frame->frame, number + 1);
    EXPECT_EQ(read.frame->positions, expected.positions) << number;
    EXPECT_EQ(read.frame->head.rotation.coeffs(), expected.head.rotation.coeffs());
    EXPECT_EQ(read.record.state_hash, positionsHash(expected.positions));
    EXPECT_EQ(read.inputs.size(), number == 2 ? 1u : 0u) << number;
    EXPECT_EQ(recording.frameAt(read.record.time), number);
    EXPECT_EQ(recording.frameAt(read.record.time + 0.5 / 60), number);
  }
  recording.read(2, read);
  EXPECT_EQ(read.inputs.at(0).id, 33u);
  EXPECT_EQ(read.inputs.at(0).values, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(read.groom->guides.offsets, groom.guides.offsets);
  EXPECT_EQ(read.body->mesh.positions.size(), 16u);
  EXPECT_EQ(recording.frameAt(-1), 0u);
  EXPECT_EQ(recording.frameAt(1e9), kFrames - 1);
  EXPECT_THROW(recording.read(kFrames, read), Error);
}

TEST(RecordingTest, CodecsKeepToTheirError) {
  const ScratchFolder folder;
  const GroomDescription groom = smallGroom();
  for (const Codec codec : {Codec::kDelta16, Codec::kOctahedral12, Codec::kTemporal}) {
    record(folder / "a.rec", 20, codec);
    Recording recording(folder / "a.rec");
    RecordedFrame read;
    for (const uint64_t number : {19, 3, 4}) {  // every frame decodes alone
      recording.read(number, read);
      const GuideFrame expected = hairFrame(groom, number + 1);
      float worst = 0;
      for (size_t v = 0; v < expected.positions.size(); ++v)
        worst = std::max(worst, (read.frame->positions[v] - expected.positions[v]).norm());
      EXPECT_LE(worst, recording.head().max_error) << recording.head().codec;
      EXPECT_GT(worst, 0);
      EXPECT_EQ(read.record.state_hash, positionsHash(expected.positions)) << "of the exact positions";
    }
  }
}

TEST(RecordingTest, IsReadUpToWhereverItWasCut) {
  const ScratchFolder folder;
  constexpr uint64_t kFrames = kIndexFrames + 20;
  record(folder / "whole.rec", kFrames);
  const std::vector<uint8_t> bytes = bytesOf(folder / "whole.rec");
  const auto framesOf = [&](size_t size) {
    Recording cut(std::make_unique<RecordingInMemory>(
                      std::vector<uint8_t>(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size))),
                  "cut");
    EXPECT_TRUE(cut.isCut());
    RecordedFrame read;
    if (cut.frames() > 0) cut.read(cut.frames() - 1, read);
    if (cut.frames() > 3) cut.read(2, read);
    return cut.frames();
  };
  EXPECT_EQ(framesOf(bytes.size() - 1), kFrames) << "only the end is missing";
  EXPECT_EQ(framesOf(bytes.size() - 1000), kFrames - 1) << "the cut is in the last frame or its index";
  uint64_t before = kFrames;
  std::mt19937 random(4);
  std::vector<size_t> sizes;
  for (int i = 0; i < 60; ++i) sizes.push_back(4096 + random() % (bytes.size() - 4097));
  std::sort(sizes.rbegin(), sizes.rend());
  for (const size_t size : sizes) {
    const uint64_t frames = framesOf(size);
    EXPECT_LE(frames, before);
    EXPECT_NEAR(static_cast<double>(frames),
                static_cast<double>(size) * static_cast<double>(kFrames) / static_cast<double>(bytes.size()),
                40);
    before = frames;
  }
}

TEST(RecordingTest, AFileThatWasNotClosedIsWhole) {
  const ScratchFolder folder;
  record(folder / "open.rec", 30, Codec::kDelta16, false);
  Recording recording(folder / "open.rec");
  EXPECT_TRUE(recording.isCut());
  EXPECT_EQ(recording.frames(), 30u);
  RecordedFrame read;
  recording.read(29, read);
  EXPECT_EQ(read.frame->frame, 30u);
}

TEST(RecordingTest, GridsStandWithTheirFrames) {
  const ScratchFolder folder;
  constexpr uint64_t kFrames = kIndexFrames + 20, kEvery = 31;
  const GroomDescription groom = smallGroom();
  const auto cellsOf = [](uint64_t number) { return number % 2 == 0 ? 32u : 16u; };
  const auto hasWind = [](uint64_t number) { return number % 3 == 0; };
  {
    Recorder recorder(folder / "a.rec", {});
    recorder.setGroom(groom, sampleBody(4));
    EXPECT_FALSE(recorder.addGrids(sampleGrids(0, 16, true))) << "there is no frame yet";
    for (uint64_t number = 0; number < kFrames; ++number) {
      if (number == kIndexFrames) recorder.addInput(inputOf(33));
      EXPECT_TRUE(recorder.addFrame(hairFrame(groom, number + 1)));
      if (number % kEvery == 0) {
        EXPECT_TRUE(recorder.addGrids(sampleGrids(number, cellsOf(number), hasWind(number))));
        EXPECT_FALSE(recorder.addGrids(sampleGrids(number, 16, false))) << "a second time";
      }
    }
    EXPECT_EQ(recorder.gridFrames(), (kFrames + kEvery - 1) / kEvery);
  }
  Recording recording(folder / "a.rec");
  ASSERT_FALSE(recording.isCut());
  ASSERT_EQ(recording.frames(), kFrames);
  AirGrids read;
  for (const uint64_t number :
       {uint64_t{0}, kIndexFrames - 1, kIndexFrames, 33 * kEvery, kEvery, 6 * kEvery, kFrames - 1}) {
    const bool has = number % kEvery == 0;
    ASSERT_EQ(recording.readGrids(number, read), has) << number;
    if (!has) continue;
    const AirGrids expected = sampleGrids(number, cellsOf(number), hasWind(number));
    ASSERT_EQ(read.cells, expected.cells);
    EXPECT_EQ(read.cell, expected.cell);
    EXPECT_EQ(read.origin, expected.origin);
    for (size_t which = 0; which < kGridValues; ++which) {
      ASSERT_EQ(read.values[which].size(), expected.values[which].size()) << which;
      float largest = 0, error = 0;
      for (size_t i = 0; i < read.values[which].size(); ++i) {
        largest = std::max(largest, std::fabs(expected.values[which][i]));
        error = std::max(error, std::fabs(read.values[which][i] - expected.values[which][i]));
      }
      EXPECT_LE(error, 0.501f * largest / 32767) << "half a unit, of value " << which;
    }
  }
  RecordedFrame frame;
  recording.read(kIndexFrames, frame);
  EXPECT_EQ(frame.inputs.size(), 1u);
  EXPECT_THROW(recording.readGrids(kFrames, read), Error);
}

TEST(RecordingTest, GridsThatAreNotSoundAreLeftOut) {
  const ScratchFolder folder;
  const GroomDescription groom = smallGroom();
  Recorder recorder(folder / "a.rec", {});
  recorder.setGroom(groom, sampleBody(4));
  uint64_t frame = 0;
  const auto refuses = [&](auto&& spoil) {
    EXPECT_TRUE(recorder.addFrame(hairFrame(groom, ++frame)));
    AirGrids grids = sampleGrids(1, 16, true);
    spoil(grids);
    return !recorder.addGrids(grids);
  };
  EXPECT_FALSE(refuses([](AirGrids&) {}));
  EXPECT_TRUE(refuses([](AirGrids& g) { g.of(GridValue::kPressure)[7] = NAN; }));
  EXPECT_TRUE(refuses([](AirGrids& g) { g.of(GridValue::kWindX)[7] = -INFINITY; }));
  EXPECT_TRUE(refuses([](AirGrids& g) { g.of(GridValue::kWindX).pop_back(); }));
  EXPECT_TRUE(refuses([](AirGrids& g) { g.cells = 17; }));
  EXPECT_TRUE(refuses([](AirGrids& g) { g.cell = 0; }));
  EXPECT_TRUE(refuses([](AirGrids& g) { g.values = {}; }));
  GuideFrame broken = hairFrame(groom, ++frame);
  broken.positions[3].x() = NAN;
  EXPECT_FALSE(recorder.addFrame(broken));
  EXPECT_FALSE(recorder.addGrids(sampleGrids(1, 16, true))) << "of a frame that was left out";
  EXPECT_TRUE(recorder.addFrame(hairFrame(groom, ++frame)));
  recorder.addInput(inputOf(33));
  EXPECT_FALSE(recorder.addGrids(sampleGrids(1, 16, true))) << "behind an input of the next frame";
}

TEST(RecordingTest, GridsThatWereCutAreNotThereAndDamagedOnesAreRefused) {
  const ScratchFolder folder;
  const GroomDescription groom = smallGroom();
  uint64_t frame_end = 0, grids_end = 0;
  {
    Recorder recorder(folder / "a.rec", {});
    recorder.setGroom(groom, sampleBody(4));
    recorder.addFrame(hairFrame(groom, 1));
    frame_end = recorder.bytes();
    recorder.addGrids(sampleGrids(1, 32, true));
    grids_end = recorder.bytes();
  }
  const std::vector<uint8_t> whole = bytesOf(folder / "a.rec");
  const auto reading = [&](const std::vector<uint8_t>& bytes) {
    return Recording(std::make_unique<RecordingInMemory>(bytes), "a.rec");
  };
  AirGrids grids;
  RecordedFrame frame;
  for (uint64_t size = frame_end; size < whole.size(); size += 97) {
    Recording cut = reading({whole.begin(), whole.begin() + static_cast<ptrdiff_t>(size)});
    ASSERT_EQ(cut.frames(), 1u) << size;
    cut.read(0, frame);
    EXPECT_EQ(cut.readGrids(0, grids), size >= grids_end) << size;
  }

  // Layout of the first record: number, cells, origin, cell, first layer, values, count of units, units,
  // packed bytes.
  constexpr size_t kOf = kRecordHeadBytes;
  const auto refuses = [&](size_t at, std::vector<uint8_t> with, bool repairs = true) {
    std::vector<uint8_t> bytes = whole;
    std::copy(with.begin(), with.end(), bytes.begin() + static_cast<ptrdiff_t>(frame_end + at));
    if (repairs) repairHashes(bytes);
    Recording damaged = reading(bytes);
    damaged.read(0, frame);
    try {
      damaged.readGrids(0, grids);
    } catch (const Error&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refuses(kOf, {})) << "as it is";
  EXPECT_TRUE(refuses(kOf + 60, {0x12}, false)) << "the hash";
  EXPECT_TRUE(refuses(3, {6}, false)) << "the kind";
  EXPECT_TRUE(refuses(kOf + 7, {9})) << "number";
  EXPECT_TRUE(refuses(kOf + 11, {33})) << "cells";
  EXPECT_TRUE(refuses(kOf + 11, {16})) << "fewer cells than the layers";
  EXPECT_TRUE(refuses(kOf + 8, {0xff, 0xff, 0xff, 0xf0})) << "cells, far too many";
  EXPECT_TRUE(refuses(kOf + 12, {0x7f, 0xc0, 0, 0})) << "origin, not a number";
  EXPECT_TRUE(refuses(kOf + 24, {0, 0, 0, 0})) << "cell";
  EXPECT_TRUE(refuses(kOf + 31, {16})) << "first layer";
  EXPECT_TRUE(refuses(kOf + 35, {0xff})) << "unknown values";
  EXPECT_TRUE(refuses(kOf + 35, {0x3f})) << "fewer values than units";
  EXPECT_TRUE(refuses(kOf + 40, {0x7f, 0xc0, 0, 0})) << "unit, not a number";
  EXPECT_TRUE(refuses(kOf + 40, {0xbf, 0x80, 0, 0})) << "unit below 0";
  EXPECT_TRUE(refuses(kOf + 72, {1, 2, 3, 4})) << "packed bytes";
}

/// A recording with hairs and poses, of which the first record of a kind is damaged.
Recording withDamaged(RecordKind kind, uint32_t growth) {
  const ScratchFolder folder;
  GroomDescription groom = smallGroom();
  groom.growth = growth;
  {
    RecordingOptions options;
    options.codec.codec = Codec::kFloat32;
    Recorder recorder(folder / "a.rec", options);
    recorder.setGroom(groom, sampleBody(4));
    recorder.setHairs(boundHairs(
        groom.guides, 10, [](size_t h) { return 2 + h % 5; }, true));
    for (uint64_t number = 1; number <= 4; ++number) {
      StepPoses step;
      step.step = number;
      step.poses.source = 5;
      step.poses.names = "head";
      step.poses.ages = {0};
      step.poses.poses = {0, 1, 0, 0, 0, 0, 1};
      recorder.addPoses(step);
      EXPECT_TRUE(recorder.addFrame(hairFrame(groom, number)));
    }
  }
  std::vector<uint8_t> bytes = bytesOf(folder / "a.rec");
  size_t at = sizeof kRecordingMagic;
  while (loadBigEndian<RecordKind>(bytes.data() + at) != kind)
    at += kRecordHeadBytes + loadBigEndian<uint32_t>(bytes.data() + at + 4);
  bytes[at + kRecordHeadBytes + 9] ^= 0xff;
  return Recording(std::make_unique<RecordingInMemory>(std::move(bytes)), "a.rec");
}

TEST(RecordingTest, OneDamagedDescriptionLeavesAllElseReadable) {
  constexpr uint32_t kBoth = GroomDescription::kFromSeed | GroomDescription::kHairs;
  for (const RecordKind kind : {RecordKind::kBody, RecordKind::kHairs, RecordKind::kPoseNames}) {
    Recording recording = withDamaged(kind, kBoth);
    ASSERT_EQ(recording.frames(), 4u);
    for (const uint64_t number : {3u, 0u, 1u}) {
      RecordedFrame read;
      ASSERT_NO_THROW(recording.read(number, read));
      EXPECT_EQ(read.frame->positions, hairFrame(smallGroom(), number + 1).positions);
      ASSERT_TRUE(read.body);
      EXPECT_EQ(read.body->mesh.positions.size(), kind == RecordKind::kBody ? 0u : 16u);
      EXPECT_EQ(read.body->session, 11u);
      EXPECT_EQ(read.hairs != nullptr, kind != RecordKind::kHairs);
      EXPECT_EQ(read.groom->growth,
                kind == RecordKind::kHairs ? uint32_t{GroomDescription::kFromSeed} : kBoth);
      EXPECT_TRUE(read.groom->seeded.empty());
      EXPECT_EQ(read.poses.size(), kind == RecordKind::kPoseNames ? 0u : 1u);
      EXPECT_EQ(read.damage.body, kind == RecordKind::kBody);
      EXPECT_EQ(read.damage.hairs, kind == RecordKind::kHairs);
      EXPECT_EQ(read.damage.pose_names, kind == RecordKind::kPoseNames);
      const std::vector<std::string> warnings = recording.warningsOf(read.damage);
      ASSERT_EQ(warnings.size(), 1u);
      EXPECT_NE(warnings[0].find("a.rec"), std::string::npos) << warnings[0];
    }
  }
}

TEST(RecordingTest, AGroomWhoseHairsAreDamagedGrowsNoneFromASeedUnlessItDid) {
  RecordedFrame read;
  withDamaged(RecordKind::kHairs, GroomDescription::kHairs).read(0, read);
  EXPECT_EQ(read.groom->growth, GroomDescription::kFromSeed) << "a reader waits for nothing else";
  EXPECT_EQ(read.groom->seeded, std::vector<uint8_t>(kStrands, 0));
  EXPECT_NO_THROW(checkAnnouncement(*read.groom, *read.body, "test"));
}

TEST(RecordingTest, AnotherSessionBringsItsOwnGroom) {
  const ScratchFolder folder;
  const GroomDescription first = smallGroom();
  GroomDescription second = hairGroom(7, [](size_t) { return 9; });
  second.session = 99;
  {
    Recorder recorder(folder / "a.rec", {});
    EXPECT_FALSE(recorder.addFrame(hairFrame(first, 1))) << "there is no groom yet";
    recorder.setGroom(first, sampleBody(3));
    for (uint64_t i = 1; i <= 5; ++i) EXPECT_TRUE(recorder.addFrame(hairFrame(first, i)));
    EXPECT_FALSE(recorder.addFrame(hairFrame(first, 5))) << "the same one again";
    recorder.setGroom(second, sampleBody(5));
    EXPECT_FALSE(recorder.addFrame(hairFrame(first, 6))) << "of the groom before";
    for (uint64_t i = 1; i <= 4; ++i) EXPECT_TRUE(recorder.addFrame(hairFrame(second, i)));
    GuideFrame broken = hairFrame(second, 5);
    broken.positions[3].x() = NAN;
    EXPECT_FALSE(recorder.addFrame(broken));
  }
  Recording recording(folder / "a.rec");
  ASSERT_EQ(recording.frames(), 9u);
  RecordedFrame read;
  for (const uint64_t number : {8, 4, 5, 0}) {
    recording.read(number, read);
    EXPECT_EQ(read.groom->session, number < 5 ? 11u : 99u);
    EXPECT_EQ(read.frame->positions.size(), read.groom->guides.vertices());
    EXPECT_EQ(read.body->mesh.positions.size(), number < 5 ? 9u : 25u);
  }
}

TEST(RecordingTest, WhatIsNoRecordingIsRefused) {
  const ScratchFolder folder;
  EXPECT_THROW(Recording(folder / "absent.rec"), Error);
  EXPECT_THROW(Recording(folder.path()), Error);
  EXPECT_THROW(Recorder(folder / "no" / "folder.rec", {}), Error);
  std::ofstream(folder / "text.rec") << "this is something else";
  EXPECT_THROW(Recording(folder / "text.rec"), Error);
  record(folder / "a.rec", 3);
  std::vector<uint8_t> bytes = bytesOf(folder / "a.rec");
  bytes[sizeof kRecordingMagic + kRecordHeadBytes + 3] = 5;  // version
  repairHashes(bytes);
  try {
    Recording(std::make_unique<RecordingInMemory>(bytes), "later.rec");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("version 4"), std::string::npos) << error.what();
  }
}

/// Converts a recording of the present version to an old one with guide chunks of type OldChunk, and reads
/// it.
template <class OldChunk>
void expectOldVersionIsRead(uint32_t version) {
  const ScratchFolder folder;
  record(folder / "new.rec", 5, Codec::kOctahedral12);
  {
    // A file without index and end is read from the front.
    RecordReader reader(openRecordingFile(folder / "new.rec"));
    RecordWriter writer(folder / "old.rec");
    RecordReader::Record record;
    for (uint64_t at = sizeof kRecordingMagic; reader.read(at, record); at = record.next) {
      std::vector<uint8_t> bytes(record.bytes.begin(), record.bytes.end());
      if (record.kind == RecordKind::kHead) storeBigEndian(version, bytes.data());
      if (record.kind == RecordKind::kIndex || record.kind == RecordKind::kEnd) continue;
      MessageReader present(record.bytes);
      const auto convert = [&]<class Present, class Old>(Present chunk, std::type_identity<Old> old) {
        fields(present, chunk, std::type_identity<Present>());
        MessageWriter old_record(bytes);
        fields(old_record, chunk, old);
      };
      if (record.kind == RecordKind::kGroom) convert(GroomChunk(), std::type_identity<GroomChunk6>());
      if (record.kind == RecordKind::kGuides) convert(GuideChunk(), std::type_identity<OldChunk>());
      if (record.kind == RecordKind::kFrame) {
        FrameRecord frame;
        recordFields(present, frame, std::type_identity<FrameRecord>());
        MessageWriter old_record(bytes);
        recordFields(old_record, frame, std::type_identity<FrameRecord3>());
      }
      writer.write(record.kind, bytes);
    }
    writer.flush();
  }
  Recording old(folder / "old.rec"), now(folder / "new.rec");
  ASSERT_EQ(old.frames(), 5u);
  RecordedFrame a, b;
  for (uint64_t number = 0; number < 5; ++number) {
    old.read(number, a);
    now.read(number, b);
    EXPECT_EQ(a.frame->positions, b.frame->positions);
    EXPECT_EQ(a.record.state_hash, b.record.state_hash);
    EXPECT_EQ(a.groom->growth, GroomDescription::kFromSeed);
  }
}

TEST(RecordingTest, OnesOfVersion1AreRead) { expectOldVersionIsRead<GuideChunk3>(1); }
TEST(RecordingTest, OnesOfVersion2AreRead) { expectOldVersionIsRead<GuideChunk5>(2); }
TEST(RecordingTest, OnesOfVersion3AreRead) { expectOldVersionIsRead<GuideChunk6>(3); }

/// Of all that a decoded frame tells of its guides, head and colliders.
uint64_t contentHash(const GuideFrame& frame) {
  ContentHash hash;
  const auto add = [&](const auto& numbers) {
    hash.add(numbers.data(), static_cast<size_t>(numbers.size()) * sizeof(float));
  };
  for (const Vec3& position : frame.positions) add(position);
  const auto addPose = [&](const Pose& pose) { add(pose.position), add(pose.rotation.coeffs()); };
  addPose(frame.head);
  for (const PlacedCollider& collider : frame.colliders) {
    hash.add(&collider.id, sizeof collider.id);
    addPose(collider.pose);
    bendNumbers(collider.bend, [&](const float& number) { hash.add(&number, sizeof number); });
  }
  return hash.value();
}

// data/wire6.rec has recording version 3 and wire version 6. `strandcastd --rate 4 --body-cell 0.004` made it
// of armGlb() (spacing 0.06, 6 sectors, blend 0.03) with its clip, 20 strands and `ctl wind`.
TEST(RecordingTest, OneOfWireVersion6IsReadAsItWasRecorded) {
  constexpr uint64_t kHashes[] = {
      0x6bc5db05fa7fb8c2, 0xd152111543419dd0, 0x303dbbe272866c7f, 0x409651669e063f3,  0xdc11249962a60efb,
      0xe203e46c292f8453, 0x74354d121a9ae1b4, 0xd1319208b603d431, 0x3cf9c7fcd6c59f84, 0x9b03fe399a4133ba};
  Recording recording(std::filesystem::path(STRANDCAST_SOURCE_DIR "/tests/transport/data/wire6.rec"));
  ASSERT_EQ(recording.frames(), std::size(kHashes));
  EXPECT_FALSE(recording.isCut());
  EXPECT_EQ(recording.head().codec, "delta16");
  RecordedFrame read;
  for (uint64_t number = 0; number < recording.frames(); ++number) {
    recording.read(number, read);
    EXPECT_EQ(contentHash(*read.frame), kHashes[number])
        << "frame " << number << " 0x" << std::hex << contentHash(*read.frame);
    EXPECT_EQ(read.groom->guides.vertices(), 120u);
    EXPECT_EQ(read.body->mesh.triangles.size(), 132u);
    EXPECT_EQ(read.frame->colliders.size(), 7u);
    EXPECT_EQ(read.inputs.size(), number == 0 ? 1u : 0u);
  }
}

TEST(RecordingTest, AFullDiskIsSaidAndCastingGoesOn) {
  EXPECT_THROW(Recorder("/dev/full", {}), Error);
  const ScratchFolder folder;
  auto [publisher, subscriber] = makeInProcessChannel(1);
  RecordingPublisher recording(std::move(publisher));
  recording.open(folder / "a.rec", {});
  const GroomDescription groom = smallGroom();
  recording.announce(groom, sampleBody(3));
  for (uint64_t i = 1; i <= 3; ++i) recording.publish(hairFrame(groom, i));
  std::string failure;
  {
    const FullDisk disk(recording.recorder().bytes() + 1000);
    for (uint64_t i = 4; i <= 9; ++i) recording.publish(hairFrame(groom, i));
    failure = recording.close();
  }
  EXPECT_EQ(subscriber->frame()->frame, 9u);
  EXPECT_NE(failure.find("is the disk full?"), std::string::npos) << failure;
  EXPECT_NE(failure.find("can be replayed"), std::string::npos) << failure;
  Recording recorded(folder / "a.rec");
  EXPECT_TRUE(recorded.isCut());
  EXPECT_GE(recorded.frames(), 3u);
  EXPECT_LT(recorded.frames(), 9u);
}

TEST(RecordingTest, AFullDiskIsLoggedAtOnceAndOnce) {
  const ScratchFolder folder;
  const GroomDescription groom = smallGroom();
  RecordingPublisher recording(makeInProcessChannel(1).first);
  recording.open(folder / "a.rec", {});
  recording.announce(groom, sampleBody(3));
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  std::string in_time;
  {
    const FullDisk disk(recording.recorder().bytes() + 1000);
    for (uint64_t i = 1; i <= 9; ++i) recording.publish(hairFrame(groom, i));
    in_time = log.str();
    recording.close();
  }
  spdlog::set_default_logger(before);
  EXPECT_NE(in_time.find("is the disk full?"), std::string::npos) << in_time;
  EXPECT_EQ(std::count(in_time.begin(), in_time.end(), '\n'), 1) << in_time;
  EXPECT_EQ(log.str(), in_time);
}

TEST(RecordingTest, AnOldFileStaysUntilThereIsAGroom) {
  const ScratchFolder folder;
  const auto file = folder / "a.rec";
  const GroomDescription groom = smallGroom();
  const auto record = [&](uint64_t frames) {
    Recorder recorder(file, {}, MakeFile::kWithGroom);
    EXPECT_EQ(recorder.bytes(), 0u);
    if (frames > 0) recorder.setGroom(groom, sampleBody(3));
    for (uint64_t i = 1; i <= frames; ++i) EXPECT_TRUE(recorder.addFrame(hairFrame(groom, i)));
    recorder.close();
  };
  record(0);
  EXPECT_FALSE(std::filesystem::exists(file));
  record(3);
  record(0);
  EXPECT_EQ(Recording(file).frames(), 3u);
  record(2);
  EXPECT_EQ(Recording(file).frames(), 2u);
  EXPECT_FALSE(Recording(file).isCut());
  EXPECT_THROW(Recorder(folder / "absent" / "a.rec", {}, MakeFile::kWithGroom), Error) << "said at once";
  EXPECT_THROW(Recorder(folder / "", {}, MakeFile::kWithGroom), Error) << "a folder";
}

TEST(RecordingTest, AFileThatIsInUseIsNotReplaced) {
  const ScratchFolder folder;
  const auto file = folder / "a.rec";
  const GroomDescription groom = smallGroom();
  const auto refusal = [&](MakeFile when) { return errorOf([&] { Recorder(file, {}, when); }); };
  record(file, 3);
  {
    const Recording reader(file);
    EXPECT_NE(refusal(MakeFile::kAtOnce).find("another program writes or reads it"), std::string::npos);
    EXPECT_NE(refusal(MakeFile::kWithGroom).find("another program writes or reads it"), std::string::npos);
  }
  EXPECT_EQ(Recording(file).frames(), 3u);
  Recorder writer(file, {});
  writer.setGroom(groom, sampleBody(3));
  for (uint64_t i = 1; i <= 4; ++i) EXPECT_TRUE(writer.addFrame(hairFrame(groom, i)));
  EXPECT_NE(refusal(MakeFile::kAtOnce), "");
  EXPECT_NE(refusal(MakeFile::kWithGroom), "");
  EXPECT_EQ(Recording(file).frames(), 4u) << "what is written so far can be read";
  EXPECT_TRUE(writer.addFrame(hairFrame(groom, 5)));
  writer.close();
  EXPECT_EQ(Recording(file).frames(), 5u);
}

TEST(RecordingTest, OneOpenedWhileItWasWrittenIsKeptFromTheNextWriter) {
  const ScratchFolder folder;
  const auto file = folder / "a.rec";
  std::optional<Recorder> writer(std::in_place, file, RecordingOptions());
  const GroomDescription groom = smallGroom();
  writer->setGroom(groom, sampleBody(3));
  for (uint64_t i = 1; i <= 4; ++i) EXPECT_TRUE(writer->addFrame(hairFrame(groom, i)));
  Recording reader(file);
  RecordedFrame read;
  reader.read(0, read);
  writer.reset();
  reader.read(1, read);
  EXPECT_NE(errorOf([&] { Recorder(file, {}); }).find("another program writes or reads it"),
            std::string::npos);
  reader.read(3, read);
}

TEST(RecordingTest, OneWithoutAFrameIsNotCalledWorthReplaying) {
  const ScratchFolder folder;
  const std::string failure = errorOf([&] {
    const FullDisk disk(100);
    Recorder(folder / "a.rec", {});
  });
  EXPECT_NE(failure.find("holds no frame yet"), std::string::npos) << failure;
  EXPECT_EQ(failure.find("can be replayed"), std::string::npos) << failure;
}

TEST(RecordingTest, APublisherRecordsFramesAndCommandsInTheirOrder) {
  const ScratchFolder folder;
  auto [publisher, subscriber] = makeInProcessChannel(1);
  const GroomDescription groom = smallGroom();
  {
    RecordingPublisher recording(std::move(publisher));
    recording.open(folder / "a.rec", {});
    recording.announce(groom, sampleBody(3));
    for (uint64_t i = 1; i <= 6; ++i) {
      if (i % 2 == 0) subscriber->send(inputOf(100 + i));
      while (recording.takeCommand()) {
      }
      recording.publish(hairFrame(groom, i));
    }
    EXPECT_EQ(recording.close(), "");
    EXPECT_EQ(recording.recorder().frames(), 6u);
  }
  Recording recording(folder / "a.rec");
  RecordedFrame read;
  for (uint64_t number = 0; number < 6; ++number) {
    recording.read(number, read);
    ASSERT_EQ(read.inputs.size(), number % 2) << number;
    for (const Command& input : read.inputs) EXPECT_EQ(input.id, 101 + number);
  }
}

TEST(RecordingTest, DamagedFilesAreRefusedOrReadSoundly) {
  const std::vector<FuzzSeeds> files = recordingSeeds();
  for (const FuzzSeeds& file : files) {
    const std::vector<uint8_t>& sound = file.inputs[0];
    EXPECT_GE(fuzzRecording(sound.data(), sound.size()), 20u) << file.of << " undamaged";
    EXPECT_LT(sound.size(), 24576u) << "what ./dev fuzz lets an input be long";
  }
  std::mt19937 random(20240229);
  size_t read = 0;
  for (int i = 0; i < 4000; ++i) {
    std::vector<uint8_t> bytes = files[random() % files.size()].inputs[0];
    // Damage beyond the head, because most of the head is its long text.
    constexpr size_t kBehindHead = 1800;
    for (size_t times = 1 + random() % 3; times > 0; --times) {
      const size_t at = kBehindHead + random() % (bytes.size() - kBehindHead);
      switch (random() % 4) {
        case 0:
          bytes[at] = static_cast<uint8_t>(random());
          break;
        case 1:
          bytes[at] ^= static_cast<uint8_t>(1u << random() % 8);
          break;
        case 2:
          for (size_t k = at; k < std::min(at + 4, bytes.size()); ++k) bytes[k] = random() % 2 ? 0xff : 0;
          break;
        default:
          bytes.resize(std::max(at, kBehindHead + 1));
      }
    }
    bytes[0] = static_cast<uint8_t>(i);
    read += fuzzRecording(bytes.data(), bytes.size());
  }
  EXPECT_GT(read, 10000u) << "most frames are not where the damage is";
}

}  // namespace
}  // namespace strandcast
