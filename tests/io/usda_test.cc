// USD text: which curves of a stage become strands, where they are placed, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "groom/groom.h"
#include "io/file_bytes.h"
#include "io/groom_file.h"
#include "tests/expect_error.h"
#include "tests/io/sample_files.h"
#include "tests/io/scratch_folder.h"

namespace strandcast {
namespace {

RawGroom read(const std::string& prims) { return readUsda(samples::fromText("#usda 1.0\n" + prims), "wig"); }

std::string curves(const std::string& more, const std::string& counts = "[4]",
                   const std::string& points = "[(0, 0, 0), (1, 0, 0), (2, 1, 0), (3, 1, 0)]") {
  return "def BasisCurves \"c\" {\n int[] curveVertexCounts = " + counts + "\n point3f[] points = " + points +
         "\n" + more + "\n}\n";
}

void expectNear(const Vec3& is, const Vec3& should) {
  EXPECT_LT((is - should).norm(), 1e-5f) << is.transpose();
}

TEST(Usda, CurvesOfASceneStandWhereItsTransformsPlaceThem) {
  const RawGroom groom = readUsda(samples::usda(), "wig");
  EXPECT_EQ(groom.format, "usda");
  EXPECT_EQ(groom.native_up, UpAxis::kZ);
  EXPECT_FLOAT_EQ(groom.unit_meters, 0.01f);
  const StrandSet& strands = groom.strands;
  ASSERT_EQ(strands.offsets, (std::vector<uint32_t>{0, 4, 7, 11}));
  expectNear(strands.positions[3], Vec3(4.5f, 0, 13));  // rotated about Z, then moved
  expectNear(strands.positions[4], Vec3(5, 1, 10));
  ASSERT_EQ(strands.radii.size(), 11u);
  for (const float radius : strands.radii) EXPECT_FLOAT_EQ(radius, 0.01f);
  EXPECT_EQ(strands.uvs, (std::vector<Vec2>{{0.25f, 0.5f}, {0.75f, 0.5f}, {0, 0}}));
  EXPECT_EQ(groom.report.left_out,
            (std::vector<std::string>{"1 prim of a class (/head/kind)",
                                      "1 prim of an over without a def (/head/hat/none)", "time samples"}));
}

TEST(Usda, CubicCurvesGiveThePointsThatTheyGoThrough) {
  const auto strand = [](const std::string& more) { return read(curves(more)).strands.positions; };
  const std::vector<Vec3> bezier = strand("");  // the schema's default
  ASSERT_EQ(bezier.size(), 4u);
  expectNear(bezier[0], Vec3(0, 0, 0));
  expectNear(bezier[1], Vec3(1, 7.0f / 27, 0));
  expectNear(bezier[3], Vec3(3, 1, 0));
  const std::vector<Vec3> spline = strand("uniform token basis = \"bspline\"");
  ASSERT_EQ(spline.size(), 2u);
  expectNear(spline[0], Vec3(1, 1.0f / 6, 0));
  expectNear(spline[1], Vec3(2, 5.0f / 6, 0));
  const std::vector<Vec3> through = strand("uniform token basis = \"catmullRom\"");
  ASSERT_EQ(through.size(), 2u);
  expectNear(through[0], Vec3(1, 0, 0));
  for (const char* basis : {"bspline", "catmullRom"}) {
    const std::vector<Vec3> pinned =
        strand("uniform token basis = \"" + std::string(basis) + "\"\nuniform token wrap = \"pinned\"");
    ASSERT_EQ(pinned.size(), 4u) << basis;
    expectNear(pinned[0], Vec3(0, 0, 0));
    expectNear(pinned[3], Vec3(3, 1, 0));
  }
}

TEST(Usda, OrdersOfTransformsAndTheirInverses) {
  const auto tip = [](const std::string& ops) {
    return read(
               "def Xform \"a\" {\n double3 xformOp:translate = (100, 0, 0)\n uniform token[] xformOpOrder = "
               "[\"xformOp:translate\"]\n" +
               curves("uniform token type = \"linear\"\n" + ops, "[2]", "[(0, 0, 0), (1, 0, 0)]") + "}")
        .strands.positions[1];
  };
  const std::string scaled = "float3 xformOp:scale = (2, 1, 1)\nfloat xformOp:rotateY = 90\n";
  expectNear(tip(scaled + "uniform token[] xformOpOrder = [\"xformOp:rotateY\", \"xformOp:scale\"]"),
             Vec3(100, 0, -2));
  expectNear(tip(scaled + "uniform token[] xformOpOrder = [\"xformOp:scale\", \"xformOp:rotateY\"]"),
             Vec3(100, 0, -1));
  expectNear(
      tip(scaled + "uniform token[] xformOpOrder = [\"!resetXformStack!\", \"!invert!xformOp:rotateY\"]"),
      Vec3(0, 0, 1));
  expectNear(tip("quatf xformOp:orient = (0, 0, 0, 2)\nuniform token[] xformOpOrder = [\"xformOp:orient\"]"),
             Vec3(99, 0, 0));
}

TEST(Usda, WhatIsWrongIsRefusedWithItsLine) {
  const auto refused = [](const std::string& prims, const std::vector<std::string>& parts) {
    expectError([&] { read(prims); }, parts);
  };
  refused("", {"wig", "no BasisCurves"});
  refused("def Mesh \"m\" {}", {"no BasisCurves"});
  refused(curves("", "[5]"), {"line 2", "\"c\"", "curveVertexCounts"});
  refused(curves("", "[3]"), {"12 numbers", "3 points"});
  refused(curves("", "[3]", "[(0, 0, 0), (1, 0, 0), (2, 0, 0)]"), {"3 points", "cubic"});
  refused(curves("uniform token type = \"linear\"", "[2]", "[(0, 0, 0), (1, inf, 0)]"),
          {"line 4", "not finite"});
  refused(curves("uniform token wrap = \"periodic\""), {"closed"});
  refused(curves("", "[4]", "[(0, 0, 0), (1, 0, 0)"), {"line 6", "should be a ']'"});
  refused("def BasisCurves \"c\" { point3f[] points = [(0, 0", {"ends within a value"});
  refused("def BasisCurves \"c\" {", {"ends within prim \"c\""});
  refused("def BasisCurves \"c {", {"line 2", "string does not end"});
  std::string deep;
  for (int i = 0; i < 2000; ++i) deep += "def \"a\" {";
  refused(deep, {"deep"});
  expectError([] { readUsda(samples::fromText("PXR-USDC...."), "wig"); }, {"binary", "usdcat"});
  expectError([] { readUsda(samples::fromText("#VRML"), "wig"); }, {"no USD text"});
}

TEST(Usda, AGroomIsWrittenBitForBitWithItsUnit) {
  const ScratchFolder folder;
  StrandSet strands = readTfx(samples::tfx4(), "wig").strands;
  strands.positions[3] = Vec3(-0.0f, 1e-42f, 16777217.0f);
  strands.radii.assign(strands.vertices(), 4e-5f);
  writeGroom(folder / "a.usda", strands);
  const RawGroom again = readRawGroom(folder / "a.usda");
  EXPECT_EQ(again.unit_meters, 1);
  ASSERT_EQ(again.strands.offsets, strands.offsets);
  EXPECT_EQ(std::memcmp(again.strands.positions.data(), strands.positions.data(), 12 * strands.vertices()),
            0);
  EXPECT_EQ(again.strands.radii, strands.radii);
  EXPECT_EQ(again.strands.uvs, strands.uvs);
  EXPECT_EQ(omissionsOf(folder / "a.usda", strands),
            omissionsOf(folder / "a.hair", readHair(samples::hair(), "wig").strands));
}

TEST(Usda, FilesSayTheirUnit) {
  const ScratchFolder folder;
  const StrandSet strands = readTfx(samples::tfx4(), "wig").strands;
  writeGroom(folder / "m.usda", strands);
  writeGroom(folder / "cm.usda", strands, UpAxis::kY, 0.01f);
  writeGroom(folder / "unsaid.tfx", strands);
  EXPECT_FLOAT_EQ(loadGroom({folder / "cm.usda"}, {}).report.unit_meters, 0.01f);
  EXPECT_TRUE(loadGroom({folder / "cm.usda"}, {}).report.warnings.empty()) << "nothing is guessed";
  EXPECT_FLOAT_EQ(loadGroom({folder / "cm.usda"}, {.unit_meters = 0.1f}).report.unit_meters, 0.1f);
  for (const char* first : {"m.usda", "unsaid.tfx"})
    expectError(
        [&] {
          loadGroom({folder / first, folder / (first[0] == 'm' ? "unsaid.tfx" : "m.usda")}, {});
        },
        {"only some of the files give their unit", "--unit-meters"});
}

TEST(Usda, StagesOfSeveralUnitsAreEachReadInTheirOwn) {
  const ScratchFolder folder;
  StrandSet strands = readTfx(samples::tfx4(), "wig").strands;
  strands.radii.assign(strands.vertices(), 0.5f);
  writeGroom(folder / "m.usda", strands, UpAxis::kY, 1);
  writeGroom(folder / "quarter.usda", strands, UpAxis::kY, 0.25f);
  const StrandSet both = loadGroom({folder / "m.usda", folder / "quarter.usda"}, {}).strands;
  const StrandSet other = loadGroom({folder / "quarter.usda", folder / "m.usda"}, {}).strands;
  const size_t half = strands.vertices();
  ASSERT_EQ(both.vertices(), 2 * half);
  for (size_t i = 0; i < half; ++i) {
    EXPECT_LT((both.positions[half + i] - 0.25f * both.positions[i]).norm(), 1e-6f);
    EXPECT_LT((both.positions[half + i] - other.positions[i]).norm(), 1e-6f);
    EXPECT_NEAR(both.radii[half + i], 0.125f, 1e-6f);
  }
}

TEST(Usda, AUnitThatIsNotGivenIsACentimetreAndThatIsSaid) {
  for (const char* head : {"", "( upAxis = \"Y\" )\n", "( metersPerUnit = None )\n"}) {
    const RawGroom groom = read(head + curves(""));
    EXPECT_FLOAT_EQ(groom.unit_meters, 0.01f);
    EXPECT_TRUE(groom.unit_is_default);
    EXPECT_TRUE(groom.report.warnings.empty()) << "whether a unit is given by hand is not known here";
    EXPECT_NE(defaultUnitWarning(groom).find("metersPerUnit is not given"), std::string::npos) << head;
  }
  const RawGroom said = read("( metersPerUnit = 0.01 )\n" + curves(""));
  EXPECT_FALSE(said.unit_is_default);
  EXPECT_EQ(defaultUnitWarning(said), "");
  const ScratchFolder folder;
  const auto warned = [&](float unit) {
    const Groom groom = loadGroom({folder / "a.usda"}, {.unit_meters = unit});
    return std::count_if(groom.report.warnings.begin(), groom.report.warnings.end(), [](const auto& line) {
      return line.find("a.usda: metersPerUnit is not given") != std::string::npos;
    });
  };
  writeFileBytes(folder / "a.usda", samples::fromText("#usda 1.0\n" + curves("")));
  EXPECT_EQ(warned(0), 1);
  EXPECT_EQ(warned(0.01f), 0);
  EXPECT_EQ(warned(0.1f), 0);
  for (const char* unit : {"0", "-1", "nan", "1e12", "inf"})
    expectError([&] { read("( metersPerUnit = " + std::string(unit) + " )\n" + curves("")); },
                {"line 2", "metersPerUnit is out of range"});
}

TEST(Usda, WhatSeveralFilesLackIsReportedEach) {
  const ScratchFolder folder;
  const std::string hidden =
      "( metersPerUnit = 1 )\ndef BasisCurves \"h\" { token visibility = \"invisible\" }\n";
  writeFileBytes(folder / "a.usda", samples::fromText("#usda 1.0\n" + hidden + curves("")));
  writeFileBytes(folder / "b.usda", samples::fromText("#usda 1.0\n( metersPerUnit = 1 )\n" + curves("")));
  writeFileBytes(folder / "c.usda",
                 samples::fromText("#usda 1.0\n" + hidden + curves("float[] primvars:displayOpacity = []")));
  const std::string lack = "1 invisible prim (/h)";
  EXPECT_EQ(loadGroom({folder / "a.usda"}, {}).report.left_out, std::vector<std::string>{lack});
  EXPECT_EQ(loadGroom({folder / "a.usda", folder / "b.usda", folder / "c.usda"}, {}).report.left_out,
            (std::vector<std::string>{(folder / "a.usda").string() + ": " + lack,
                                      (folder / "c.usda").string() + ": " + lack + ", opacities"}));
}

TEST(Usda, NamesInReportsStayOnOneLineAndShort) {
  const RawGroom groom = read("( metersPerUnit = 1 )\ndef BasisCurves \"\"\"a\n\xFF" + std::string(500, 'x') +
                              "\"\"\" { token visibility = \"invisible\" }\n" + curves(""));
  EXPECT_EQ(groom.report.omissionsLine(),
            "without 1 invisible prim (/a\\n\\xff" + std::string(77, 'x') + "...)");
}

TEST(Usda, TextInUtf16IsRefusedWithHowToConvertIt) {
  for (const bool big : {false, true}) {
    samples::Bytes wide = samples::fromText(big ? "\xfe\xff" : "\xff\xfe");
    for (const std::byte c : samples::usda())
      wide.insert(wide.end(), {big ? std::byte{0} : c, big ? c : std::byte{0}});
    expectError([&] { readUsda(wide, "wig.usda"); }, {"UTF-16", "wig.usda", "iconv -f UTF-16 -t UTF-8"});
    wide.erase(wide.begin(), wide.begin() + 2);
    expectError([&] { readUsda(wide, "wig.usda"); },
                {"UTF-16", big ? "iconv -f UTF-16BE -t UTF-8" : "iconv -f UTF-16LE -t UTF-8"});
  }
  samples::Bytes filled = samples::usda();
  filled.resize(filled.size() + 7);
  EXPECT_EQ(readUsda(filled, "wig.usda").strands.positions,
            readUsda(samples::usda(), "wig.usda").strands.positions)
      << "zero bytes at the end";
}

}  // namespace
}  // namespace strandcast
