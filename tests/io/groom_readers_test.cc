// Strand readers and writers on small files: what they read, and what they refuse with which error.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "groom/groom.h"
#include "io/file_bytes.h"
#include "io/groom_file.h"
#include "tests/expect_error.h"
#include "tests/io/sample_files.h"
#include "tests/io/scratch_folder.h"

namespace strandcast {
namespace {

using samples::Bytes;
using samples::overwrite;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::vector<int> pinsOf(const StrandSet& strands, size_t s) {
  return {strands.pinned.begin() + strands.offsets[s], strands.pinned.begin() + strands.offsets[s + 1]};
}

Bytes truncated(Bytes bytes, size_t size) {
  bytes.resize(size);
  return bytes;
}

void expectTfxError(const Bytes& bytes, const std::string& place) {
  expectError([&] { readTfx(bytes, "wig.tfx"); }, {"wig.tfx", place});
}
void expectHairError(const Bytes& bytes, const std::string& place) {
  expectError([&] { readHair(bytes, "wig.hair"); }, {"wig.hair", place});
}
void expectObjStrandsError(const std::string& text, const std::string& place) {
  expectError([&] { readObjStrands(samples::fromText(text), "wig.obj"); }, {"wig.obj", place});
}

TEST(Tfx, Version3HasItsPositionsAndPinsVerticesZeroAndOne) {
  const RawGroom groom = readTfx(samples::tfx3(), "wig.tfx");
  EXPECT_EQ(groom.format, "tfx3");
  ASSERT_EQ(groom.strands.strands(), 3u);
  ASSERT_EQ(groom.strands.vertices(), 12u);
  for (size_t s = 0; s < 3; ++s) {
    for (size_t i = 0; i < 4; ++i) EXPECT_EQ(groom.strands.strand(s)[i], samples::vertex(s, i));
    EXPECT_EQ(pinsOf(groom.strands, s), (std::vector<int>{1, 1, 0, 0}));
  }
}

TEST(Tfx, Version3PinsTheLastTwoVerticesToo_WhenBothEndsAreImmovable) {
  Bytes bytes = samples::tfx3(true);
  overwrite(bytes, 4, uint32_t{2});
  overwrite(bytes, 8, uint32_t{6});
  EXPECT_EQ(pinsOf(readTfx(bytes, "wig.tfx").strands, 1), (std::vector<int>{1, 1, 0, 0, 1, 1}));
}

TEST(Tfx, Version4PinsWhereWIsZeroAndReadsStrandUvs) {
  const RawGroom groom = readTfx(samples::tfx4(), "wig.tfx");
  EXPECT_EQ(groom.format, "tfx4");
  ASSERT_EQ(groom.strands.uvs.size(), 3u);
  EXPECT_EQ(groom.strands.uvs[2], Vec2(0.5f, 0.5f));
  for (size_t s = 0; s < 3; ++s) {
    EXPECT_EQ(groom.strands.strand(s)[3], samples::vertex(s, 3));
    EXPECT_EQ(pinsOf(groom.strands, s), (std::vector<int>{1, 1, 0, 0}));
  }
}

TEST(Tfx, EveryTruncationIsRefused) {
  for (const Bytes& whole : {samples::tfx3(), samples::tfx4()})
    for (size_t size = 0; size < whole.size(); ++size) expectTfxError(truncated(whole, size), "byte ");
}

TEST(Tfx, CountsThatDoNotFitTheFileAreRefusedAtTheirOffset) {
  for (Bytes bytes : {samples::tfx3(), samples::tfx4()}) {
    for (const uint32_t strands : {0u, 4000u, 0x40000000u, 0x80000000u, 0xFFFFFFFFu}) {
      overwrite(bytes, 4, strands);
      expectTfxError(bytes, "byte 4");
    }
    // 2^32 strands of 2^32 vertices of 16 bytes: a 64-bit product would overflow to a small number.
    overwrite(bytes, 8, uint32_t{0xFFFFFFFF});
    expectTfxError(bytes, "byte 4");
    overwrite(bytes, 4, uint32_t{0x10000000});
    overwrite(bytes, 8, uint32_t{0x10});
    expectTfxError(bytes, "byte 4");
    overwrite(bytes, 8, uint32_t{0});
    expectTfxError(bytes, "byte 8");
  }
}

TEST(Tfx, OffsetsInTheHeaderOrPastTheEndAreRefusedAtTheirField) {
  for (const size_t field : {12, 16, 20, 24, 28}) {
    for (const uint32_t offset : {4u, 159u, 100000u, 0x80000000u, 0xFFFFFFF0u}) {
      Bytes bytes = samples::tfx4();
      overwrite(bytes, field, offset);
      expectTfxError(bytes, "byte " + std::to_string(field));
    }
  }
  for (const size_t field : {144, 148, 152, 156, 160, 164}) {
    for (const uint32_t offset : {4u, 295u, 100000u, 0xFFFFFFF0u}) {
      Bytes bytes = samples::tfx3();
      overwrite(bytes, field, offset);
      expectTfxError(bytes, "byte " + std::to_string(field));
    }
  }
  Bytes bytes = samples::tfx4();
  overwrite(bytes, 12, uint32_t{0});
  expectTfxError(bytes, "byte 12");
  bytes = samples::tfx4();
  overwrite(bytes, 16, static_cast<uint32_t>(bytes.size() - 8));  // space for one of three UVs
  expectTfxError(bytes, "byte " + std::to_string(bytes.size() - 8));
}

TEST(Tfx, AStrandThatIsNotFiniteIsLeftOutAndCounted) {
  using Names = std::vector<std::string>;
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    Bytes bytes = samples::tfx4();
    overwrite(bytes, 160 + 5 * 16 + 8, bad);  // of strand 1
    RawGroom groom = readTfx(bytes, "wig.tfx");
    ASSERT_EQ(groom.strands.strands(), 2u);
    EXPECT_EQ(groom.strands.strand(1)[3], samples::vertex(2, 3));
    EXPECT_EQ(groom.strands.uvs[1], Vec2(0.5f, 0.5f)) << "its own";
    EXPECT_EQ(pinsOf(groom.strands, 1), (std::vector<int>{1, 1, 0, 0}));
    EXPECT_EQ(groom.report.left_out, Names{"1 strand with a position that is not finite"});
    bytes = samples::tfx3();
    overwrite(bytes, 296 + 7 * 12, bad);
    overwrite(bytes, 296 + 11 * 12, bad);
    groom = readTfx(bytes, "wig.tfx");
    EXPECT_EQ(groom.strands.vertices(), 4u);
    EXPECT_EQ(groom.report.left_out, Names{"2 strands with a position that is not finite"});
    overwrite(bytes, 296, bad);
    expectTfxError(bytes, "byte 296");
    bytes = samples::tfx4();
    overwrite(bytes, 160 + 12 * 16, bad);  // an element of the UVs
    groom = readTfx(bytes, "wig.tfx");
    EXPECT_EQ(groom.strands.uvs[0], Vec2(0, 0));
    EXPECT_EQ(groom.strands.strands(), 3u);
    EXPECT_EQ(groom.report.warnings, Names{"1 of the strand UVs are not finite: 0 stands for them"});
  }
}

TEST(Tfx, OtherVersionsAreRefused) {
  for (const float version : {0.0f, 2.0f, 3.5f, 5.0f, -4.0f, kNan}) {
    Bytes bytes = samples::tfx4();
    overwrite(bytes, 0, version);
    expectTfxError(bytes, "byte 0");
  }
}

TEST(Hair, HasItsCountsPointsAndHalfItsThicknessAsRadius) {
  const RawGroom groom = readHair(samples::hair(), "wig.hair");
  EXPECT_EQ(groom.native_up, UpAxis::kZ);
  EXPECT_EQ(groom.strands.offsets, (std::vector<uint32_t>{0, 2, 5, 10}));
  EXPECT_EQ(groom.strands.strand(2)[4], samples::vertex(2, 4));
  ASSERT_EQ(groom.strands.radii.size(), 10u);
  EXPECT_FLOAT_EQ(groom.strands.radii[9], 0.09f);
  EXPECT_TRUE(groom.strands.pinned.empty());
  EXPECT_TRUE(groom.strands.isPinned(1, 0));
}

TEST(Hair, WhatIsNotReadIsNamed) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(readHair(samples::hair(), "wig.hair").report.left_out, (Names{"transparency", "colours"}));
  Bytes plain = encodeHair(readHair(samples::hair(), "wig.hair").strands, "wig.hair");
  EXPECT_EQ(readHair(plain, "wig.hair").report.left_out, Names());
  overwrite(plain, 24, 0.25f);
  overwrite(plain, 36, 1.0f);
  EXPECT_EQ(readHair(plain, "wig.hair").report.left_out, (Names{"default transparency", "default colour"}));
  Bytes tfx = samples::tfx4();
  EXPECT_EQ(readTfx(tfx, "wig.tfx").report.left_out, Names());
  overwrite(tfx, 28, uint32_t{160});
  EXPECT_EQ(readTfx(tfx, "wig.tfx").report.left_out, Names{"colours"});
}

TEST(Hair, DefaultSegmentsGiveEveryStrandTheSameCount) {
  const RawGroom groom = readHair(samples::hairDefaultSegments(), "wig.hair");
  EXPECT_EQ(groom.strands.offsets, (std::vector<uint32_t>{0, 4, 8}));
  EXPECT_TRUE(groom.strands.radii.empty());
}

TEST(Hair, EveryTruncationIsRefused) {
  for (const Bytes& whole : {samples::hair(), samples::hairDefaultSegments()})
    for (size_t size = 0; size < whole.size(); ++size) expectHairError(truncated(whole, size), "byte ");
}

TEST(Hair, WrongMagicCountsAndSumsAreRefused) {
  Bytes bytes = samples::hair();
  overwrite(bytes, 0, 'h');
  expectHairError(bytes, "byte 0");
  const auto with = [](size_t offset, uint32_t value, Bytes base) {
    overwrite(base, offset, value);
    return base;
  };
  expectHairError(with(4, 0, samples::hair()), "byte 4");
  expectHairError(with(8, 0, samples::hair()), "byte 8");
  expectHairError(with(8, 11, samples::hair()), "byte ");
  expectHairError(with(8, 9, samples::hair()), "byte ");
  expectHairError(with(4, 0xFFFFFFFF, samples::hair()), "byte 128");
  expectHairError(with(8, 0xFFFFFFFF, samples::hair()), "byte ");
  expectHairError(with(12, 1, samples::hair()), "byte 12");
  expectHairError(with(4, 9, samples::hairDefaultSegments()), "byte 4");
  expectHairError(with(4, 1, samples::hairDefaultSegments()), "byte 8");
  expectHairError(with(16, 0xFFFFFFFF, samples::hairDefaultSegments()), "byte 16");
  expectHairError(with(16, 4, samples::hairDefaultSegments()), "byte 16");
  bytes = samples::hair();
  overwrite(bytes, 128, uint16_t{0xFFFF});
  expectHairError(bytes, "byte 128");
}

TEST(Hair, AStrandThatIsNotFiniteIsLeftOutAndCounted) {
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    Bytes bytes = samples::hair();
    overwrite(bytes, 128 + 6 + 12 * 4, bad);  // of the strand of three points
    const RawGroom groom = readHair(bytes, "wig.hair");
    EXPECT_EQ(groom.strands.offsets, (std::vector<uint32_t>{0, 2, 7}));
    EXPECT_EQ(groom.strands.strand(1)[4], samples::vertex(2, 4));
    EXPECT_FLOAT_EQ(groom.strands.radii[6], 0.09f) << "its own";
    EXPECT_EQ(groom.report.left_out[2], "1 strand with a position that is not finite");
    bytes = samples::hairDefaultSegments();
    overwrite(bytes, 128, bad);
    EXPECT_EQ(readHair(bytes, "wig.hair").strands.strands(), 1u);
    overwrite(bytes, 128 + 7 * 12, bad);
    expectHairError(bytes, "byte 128");
  }
}

TEST(Hair, AThicknessThatIsNoneIsTheDefault) {
  for (const float bad : {kNan, kInfinity, -1.0f}) {
    Bytes bytes = samples::hair();
    overwrite(bytes, 128 + 6 + 120 + 4, bad);
    RawGroom groom = readHair(bytes, "wig.hair");
    EXPECT_FLOAT_EQ(groom.strands.radii[1], 0.5f);
    EXPECT_FLOAT_EQ(groom.strands.radii[2], 0.02f);
    ASSERT_EQ(groom.report.warnings.size(), 1u);
    overwrite(bytes, 20, bad);
    EXPECT_EQ(readHair(bytes, "wig.hair").strands.radii[1], 0);
  }
}

TEST(Hair, ADefaultThicknessThatIsNoneIsLeftOutAndReported) {
  for (const auto& [bad, text] :
       {std::pair{kNan, "nan"}, {kInfinity, "inf"}, {-kInfinity, "-inf"}, {-2.5f, "-2.5"}})
    for (Bytes bytes : {samples::hair(), samples::hairDefaultSegments()}) {
      overwrite(bytes, 20, bad);
      const RawGroom groom = readHair(bytes, "wig.hair");
      const std::vector<std::string>& told = groom.report.left_out;
      const std::string line = std::string("the default thickness, which is ") + text;
      EXPECT_NE(std::find(told.begin(), told.end(), line), told.end()) << line;
      EXPECT_EQ(std::find(told.begin(), told.end(), "default thickness"), told.end());
      EXPECT_TRUE(groom.report.warnings.empty()) << "no vertex needs it";
    }
  Bytes bytes = samples::hair();
  overwrite(bytes, 128 + 6 + 120 + 4, kNan);
  EXPECT_EQ(readHair(bytes, "wig.hair").report.warnings,
            std::vector<std::string>{
                "1 of the thicknesses are negative or not finite: the file's default stands for them"});
  overwrite(bytes, 20, kNan);
  EXPECT_EQ(readHair(bytes, "wig.hair").report.warnings,
            std::vector<std::string>{"1 of the thicknesses are negative or not finite: 0 stands for them"});
}

TEST(Tfx, MassesAndFlagsThatAreNotReadAsTheyAreAreReported) {
  Bytes bytes = samples::tfx4();
  EXPECT_TRUE(readTfx(bytes, "wig.tfx").report.warnings.empty());
  const auto mass = [](size_t vertex) { return 160 + vertex * 16 + 12; };
  overwrite(bytes, mass(2), 0.5f);
  overwrite(bytes, mass(3), 2.0f);
  RawGroom groom = readTfx(bytes, "wig.tfx");
  EXPECT_EQ(groom.report.left_out, std::vector<std::string>{"inverse masses (w) other than 0 and 1"});
  EXPECT_TRUE(groom.report.warnings.empty());
  overwrite(bytes, mass(2), kNan);
  overwrite(bytes, mass(3), -1.0f);
  overwrite(bytes, mass(6), kInfinity);
  groom = readTfx(bytes, "wig.tfx");
  EXPECT_TRUE(groom.report.left_out.empty());
  EXPECT_EQ(groom.report.warnings,
            std::vector<std::string>{
                "3 of the inverse masses (w) are negative or not finite: their vertices are taken as free"});
  EXPECT_EQ(pinsOf(groom.strands, 0), (std::vector<int>{1, 1, 0, 0}));
  for (const uint32_t flag : {2u, 7u, 0xFFFFFFFFu}) {
    bytes = samples::tfx3();
    overwrite(bytes, 16, flag);
    groom = readTfx(bytes, "wig.tfx");
    EXPECT_EQ(pinsOf(groom.strands, 0), (std::vector<int>{1, 1, 1, 1}));
    EXPECT_EQ(groom.report.warnings, std::vector<std::string>{"its flag of both ends immovable is " +
                                                              std::to_string(flag) + ": it is taken as set"});
  }
}

TEST(ObjStrands, PolylinesBecomeStrandsWithNegativeIndicesContinuationsAndEdgeByEdge) {
  const RawGroom groom = readObjStrands(samples::objStrands(), "wig.obj");
  EXPECT_EQ(groom.strands.offsets, (std::vector<uint32_t>{0, 4, 7, 10}));
  EXPECT_EQ(groom.strands.strand(0)[2], Vec3(0, 0.3f, 0.01f));
  EXPECT_EQ(groom.strands.strand(1)[0], Vec3(0.1f, 0.1f, 0));
  EXPECT_EQ(groom.strands.strand(1)[2], Vec3(0.1f, 0.3f, 0.05f));
  EXPECT_EQ(groom.strands.strand(2)[0], Vec3(0, 0.1f, 0));
  EXPECT_EQ(groom.strands.strand(2)[2], Vec3(0.1f, 0.2f, 0));
}

TEST(ObjStrands, AVertexMayFollowThePolylineThatUsesIt) {
  EXPECT_EQ(readObjStrands(samples::fromText("l 1 2\nv 0 0 0\nv 0 1 0"), "wig.obj").strands.vertices(), 2u);
}

TEST(ObjStrands, AMarkOfUtf8BeforeTheFirstLineIsNoPartOfIt) {
  EXPECT_EQ(
      readObjStrands(samples::fromText("\xEF\xBB\xBFv 0 0 0\nv 0 1 0\nl 1 2"), "wig.obj").strands.positions,
      (std::vector<Vec3>{{0, 0, 0}, {0, 1, 0}}));
}

TEST(ObjStrands, BadLinesAreRefusedWithTheirNumber) {
  expectObjStrandsError("", "line 1");
  expectObjStrandsError("# nothing\n", "no polylines");
  expectObjStrandsError("v 0 0 0\nv 1 2\nl 1 2\n", "line 2");
  expectObjStrandsError("v 0 0 0\n\nv 1 x 2\n", "line 3");
  expectObjStrandsError("v 0 0 nan\n", "line 1");
  expectObjStrandsError("v 0 0 1e40\n", "line 1");
  expectObjStrandsError("v 0 inf 1\n", "line 1");
  expectObjStrandsError("v 0 0 0\nl\n", "no polylines");
  expectObjStrandsError("v 0 0 0\nv 0 1 0\nl 1 0\n", "line 3");
  expectObjStrandsError("v 0 0 0\nv 0 1 0\nl 1 3\n", "line 3");
  expectObjStrandsError("v 0 0 0\nv 0 1 0\nl 1 -3\n", "line 3");
  expectObjStrandsError("v 0 0 0\nv 0 1 0\nl 1 2.5\n", "line 3");
  expectObjStrandsError("v 0 0 0\nl 1 99999999999999999999\n", "line 2");
  expectObjStrandsError("v 0 0 0\nl 1 4294967296\n", "line 2");
}

TEST(GroomFile, WhatIsNoReadableFileIsRefusedWithItsName) {
  const ScratchFolder folder;
  const auto expectRefused = [](const std::filesystem::path& file, const std::string& what) {
    expectError([&] { readRawGroom(file); }, {file.string(), what, "byte 0"});
  };
  expectRefused(folder / "absent.tfx", "cannot be found");
  expectRefused(folder.path(), "directory");
  std::ofstream(folder / "empty.tfx").flush();
  expectRefused(folder / "empty.tfx", "empty");
  std::ofstream(folder / "wig.txt") << "hello";
  expectRefused(folder / "wig.txt", "no known groom format");
  std::ofstream(folder / "short.tfx") << "x";
  expectRefused(folder / "short.tfx", "ends before");
  std::ofstream(folder / "fake.hair") << "hairy";
  expectRefused(folder / "fake.hair", "HAIR");
  expectRefused("/dev/zero", "not a regular file");
}

TEST(GroomFile, AnUnreadableFileIsRefusedWithItsName) {
  if (::geteuid() == 0) GTEST_SKIP() << "the superuser may read every file";
  const ScratchFolder folder;
  std::ofstream(folder / "locked.tfx") << "x";
  std::filesystem::permissions(folder / "locked.tfx", std::filesystem::perms::none);
  expectError([&] { readRawGroom(folder / "locked.tfx"); }, {"locked.tfx", "cannot be opened"});
}

TEST(GroomFile, ContentDecidesBeforeTheExtension) {
  const ScratchFolder folder;
  const StrandSet strands = readTfx(samples::tfx4(), "wig").strands;
  writeGroom(folder / "wig.HAIR", strands);
  std::filesystem::rename(folder / "wig.HAIR", folder / "wig.tfx");
  EXPECT_EQ(readRawGroom(folder / "wig.tfx").format, "hair");
}

TEST(GroomWriter, TfxToHairToTfxKeepsEveryBitOfThePositions) {
  const ScratchFolder folder;
  StrandSet strands = readTfx(samples::tfx4(), "wig").strands;
  strands.positions[3] = Vec3(-0.0f, 1e-42f, 16777217.0f);  // a signed zero and a denormal must survive
  writeGroom(folder / "a.tfx", strands);
  const RawGroom first = readRawGroom(folder / "a.tfx");
  writeGroom(folder / "b.hair", first.strands, first.native_up);
  const RawGroom second = readRawGroom(folder / "b.hair");
  writeGroom(folder / "c.tfx", second.strands, second.native_up);
  const RawGroom third = readRawGroom(folder / "c.tfx");
  ASSERT_EQ(third.strands.offsets, strands.offsets);
  for (const RawGroom* groom : {&first, &third})
    EXPECT_EQ(std::memcmp(groom->strands.positions.data(), strands.positions.data(), 12 * strands.vertices()),
              0);
  EXPECT_EQ(second.strands.positions[3], Vec3(-0.0f, -16777217.0f, 1e-42f)) << "Z is up";
  EXPECT_EQ(first.strands.pinned, strands.pinned);
  EXPECT_EQ(first.strands.uvs, strands.uvs);
}

TEST(GroomWriter, AGroomStandsInEveryFormatAsItStood) {
  const ScratchFolder folder;
  const GroomReadOptions units{1, UpAxis::kAuto};
  for (const auto& [name, bytes] :
       {std::pair{"wig.tfx", samples::tfx4()}, std::pair{"wig.hair", samples::hairDefaultSegments()}}) {
    writeFileBytes(folder / name, bytes);
    const RawGroom raw = readRawGroom(folder / name);
    const StrandSet before = loadGroom({folder / name}, units).strands;
    for (const char* copy : {"copy.tfx", "copy.hair"}) {
      writeGroom(folder / copy, raw.strands, raw.native_up);
      EXPECT_EQ(loadGroom({folder / copy}, units).strands.positions, before.positions) << name << copy;
      writeGroom(folder / copy, before);
      EXPECT_EQ(loadGroom({folder / copy}, units).strands.positions, before.positions) << name << copy;
    }
  }
}

TEST(GroomWriter, HairKeepsCountsAndRadii) {
  const StrandSet strands = readHair(samples::hair(), "wig").strands;
  const StrandSet again = readHair(encodeHair(strands, "wig"), "wig").strands;
  EXPECT_EQ(again.offsets, strands.offsets);
  EXPECT_EQ(again.radii, strands.radii);
  EXPECT_EQ(again.positions, strands.positions);
}

TEST(GroomWriter, WhatAFormatCannotHoldIsRefused) {
  const ScratchFolder folder;
  const StrandSet uneven = readHair(samples::hair(), "wig").strands;
  expectError([&] { writeGroom(folder / "a.tfx", uneven); }, {"a.tfx", "strand 1", "resample"});
  expectError([&] { writeGroom(folder / "a.obj", uneven); }, {"a.obj"});
  expectError([&] { writeGroom(folder / "a.tfx", StrandSet()); }, {"a.tfx", "no strands"});
  expectError([&] { writeGroom(folder / "a.hair", StrandSet()); }, {"a.hair", "no strands"});
  expectError([&] { writeGroom(folder / "no/such/a.hair", uneven); }, {"no/such/a.hair"});
  StrandSet endless;
  endless.append(std::vector<Vec3>(65537, Vec3::Zero()));
  expectError([&] { writeGroom(folder / "a.hair", endless); }, {"a.hair", "65537"});
  EXPECT_FALSE(std::filesystem::exists(folder / "a.tfx"));
}

}  // namespace
}  // namespace strandcast
