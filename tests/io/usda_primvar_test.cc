// Primvars of USD curves: values, indices and interpolation for each type, basis and wrap of curves.
#include <gtest/gtest.h>

#include <iterator>

#include "io/groom_file.h"
#include "tests/expect_error.h"
#include "tests/io/sample_files.h"

namespace strandcast {
namespace {

RawGroom readPrims(const std::string& prims) {
  return readUsda(samples::fromText("#usda 1.0\n( metersPerUnit = 0.01 )\n" + prims), "wig");
}

/// A kind of curves, with the sizes from OpenUSD's tables for two such curves.
struct KindOfCurves {
  const char *type, *basis, *wrap;
  size_t points[2], varyings[2], vertices[2];
  size_t root;  // the control point nearest to the root
};
constexpr KindOfCurves kKinds[] = {
    {"linear", "bezier", "nonperiodic", {3, 2}, {3, 2}, {3, 2}, 0},
    {"linear", "catmullRom", "pinned", {3, 2}, {3, 2}, {3, 2}, 0},
    {"cubic", "bezier", "nonperiodic", {10, 4}, {4, 2}, {10, 4}, 0},
    {"cubic", "bezier", "pinned", {10, 4}, {4, 2}, {10, 4}, 0},
    {"cubic", "bspline", "nonperiodic", {7, 4}, {5, 2}, {5, 2}, 1},
    {"cubic", "bspline", "pinned", {5, 2}, {5, 2}, {5, 2}, 0},
    {"cubic", "catmullRom", "nonperiodic", {7, 4}, {5, 2}, {5, 2}, 1},
    {"cubic", "catmullRom", "pinned", {5, 2}, {5, 2}, {5, 2}, 0},
};

std::string nameOf(const KindOfCurves& kind) { return std::string(kind.type) + kind.basis + kind.wrap; }

/// Two straight curves, with `more` in their prim.
std::string twoCurves(const KindOfCurves& kind, const std::string& more) {
  std::string points;
  for (int c = 0; c < 2; ++c)
    for (size_t i = 0; i < kind.points[c]; ++i)
      points += "(" + std::to_string(c) + ", " + std::to_string(i) + ", 0), ";
  return "def BasisCurves \"c\" {\n uniform token type = \"" + std::string(kind.type) +
         "\"\n uniform token basis = \"" + kind.basis + "\"\n uniform token wrap = \"" + kind.wrap +
         "\"\n int[] curveVertexCounts = [" + std::to_string(kind.points[0]) + ", " +
         std::to_string(kind.points[1]) + "]\n point3f[] points = [" + points + "]\n" + more + "}\n";
}

std::string listed(size_t count, const auto& value) {
  std::string out = "[";
  for (size_t i = 0; i < count; ++i) out += (i > 0 ? ", " : "") + value(i);
  return out + "]";
}

/// UVs (k / 64, 1) and widths (k + 1) / 8 for value k, stored in order, or reversed with indices.
std::string valuesOf(const std::string& interpolation, size_t count, bool indexed) {
  const auto stored = [&](size_t k) { return static_cast<double>(indexed ? count - 1 - k : k); };
  const std::string how = " ( interpolation = \"" + interpolation + "\" )\n";
  const std::string indices = listed(count, [&](size_t k) { return std::to_string(count - 1 - k); });
  std::string out = "texCoord2f[] primvars:st = " +
                    listed(count, [&](size_t k) { return "(" + std::to_string(stored(k) / 64) + ", 1)"; }) +
                    how;
  out += "float[] primvars:widths = " +
         listed(count, [&](size_t k) { return std::to_string((stored(k) + 1) / 8); }) + how;
  if (indexed)
    out += "int[] primvars:st:indices = " + indices + "\nint[] primvars:widths:indices = " + indices + "\n";
  return out;
}

void expectValues(const KindOfCurves& kind, const std::string& interpolation, bool indexed) {
  const size_t points = kind.points[0] + kind.points[1], varyings = kind.varyings[0] + kind.varyings[1];
  const size_t count = interpolation == "constant"  ? 1
                       : interpolation == "uniform" ? 2
                       : interpolation == "varying" ? varyings
                                                    : points;
  const RawGroom groom = readPrims(twoCurves(kind, valuesOf(interpolation, count, indexed)));
  const StrandSet& strands = groom.strands;
  ASSERT_EQ(strands.strands(), 2u);
  ASSERT_EQ(strands.uvs.size(), 2u) << groom.report.omissionsLine();
  ASSERT_EQ(strands.radii.size(), strands.vertices()) << groom.report.omissionsLine();
  EXPECT_TRUE(groom.report.warnings.empty()) << groom.report.warnings[0];
  for (size_t c = 0; c < 2; ++c) {
    ASSERT_EQ(strands.verticesOf(c), kind.vertices[c]);
    // Indices of the values at the root and at the tip.
    size_t root = 0, tip = 0;
    if (interpolation == "uniform") root = tip = c;
    if (interpolation == "varying") {
      root = c == 0 ? 0 : kind.varyings[0];
      tip = root + kind.varyings[c] - 1;
    }
    if (interpolation == "vertex") {
      root = (c == 0 ? 0 : kind.points[0]) + kind.root;
      tip = (c == 0 ? 0 : kind.points[0]) + kind.points[c] - 1 - kind.root;
    }
    EXPECT_NEAR(strands.uvs[c].x(), static_cast<float>(root) / 64, 1e-6f);
    EXPECT_NEAR(strands.uvs[c].y(), 1, 1e-6f);
    EXPECT_NEAR(2 * strands.radii[strands.offsets[c]], static_cast<float>(root + 1) / 8, 1e-6f);
    EXPECT_NEAR(2 * strands.radii[strands.offsets[c + 1] - 1], static_cast<float>(tip + 1) / 8, 1e-6f);
    // Given both ends, the values between are evenly spaced.
    const uint32_t second = strands.offsets[c] + 1;
    const float step = static_cast<float>(tip - root) / static_cast<float>(kind.vertices[c] - 1);
    EXPECT_NEAR(2 * strands.radii[second], (static_cast<float>(root + 1) + step) / 8, 1e-6f);
  }
}

TEST(UsdaPrimvars, EveryInterpolationOfEveryKindOfCurvesWithAndWithoutIndices) {
  for (const KindOfCurves& kind : kKinds)
    for (const char* interpolation : {"constant", "uniform", "varying", "vertex"})
      for (const bool indexed : {false, true}) {
        SCOPED_TRACE(nameOf(kind) + " " + interpolation + (indexed ? " with indices" : ""));
        expectValues(kind, interpolation, indexed);
      }
}

TEST(UsdaPrimvars, ClosedCurvesAreLeftOutWhateverTheirBasis) {
  for (const KindOfCurves& kind : kKinds) {
    KindOfCurves closed = kind;
    closed.wrap = "periodic";
    expectError([&] { readPrims(twoCurves(closed, "")); }, {"line 3", "\"c\"", "closed"});
    const RawGroom groom = readPrims(twoCurves(closed, "") + twoCurves(kKinds[0], ""));
    EXPECT_EQ(groom.strands.strands(), 2u);
    ASSERT_EQ(groom.report.left_out.size(), 1u);
    EXPECT_NE(groom.report.left_out[0].find("1 prim that cannot be read (/c: its curves are closed"),
              std::string::npos);
  }
}

TEST(UsdaPrimvars, BasesThatNewerSchemasDoNotHaveAreRefusedByName) {
  for (const char* basis : {"hermite", "power", "b-spline"})
    expectError(
        [&] {
          readPrims(twoCurves({"cubic", basis, "nonperiodic", {4, 4}, {}, {}, 0}, ""));
        },
        {"\"c\"", basis, "not read"});
}

std::vector<Vec2> uvs(const std::string& more, const std::string& above = "") {
  return readPrims("def Xform \"g\" {\n" + above + "\n" + twoCurves(kKinds[0], more) + "}").strands.uvs;
}
const std::vector<Vec2> kBoth = {{0.25f, 0.5f}, {0.75f, 1}};

TEST(UsdaPrimvars, UvsAreReadUnderTheNamesAndTypesOfExporters) {
  for (const char* name : {"st", "uv", "st0", "UVMap", "map1", "groom_root_uv", "surface_uv_coordinate"})
    EXPECT_EQ(uvs("float2[] primvars:" + std::string(name) +
                  " = [(0.25, 0.5), (0.75, 1)] ( interpolation = \"uniform\" )\n"),
              kBoth)
        << name;
  for (const char* type : {"texCoord2f", "texCoord2h", "texCoord2d", "float2", "half2", "double2"})
    EXPECT_EQ(
        uvs(std::string(type) + "[] primvars:st = [(0.25, 0.5), (0.75, 1)] (interpolation = \"uniform\")\n"),
        kBoth)
        << type;
  EXPECT_EQ(uvs("texCoord3f[] primvars:st = [(0.25, 0.5, 7), (0.75, 1, 7)] (interpolation = \"uniform\")\n"),
            kBoth);
  EXPECT_EQ(
      uvs("float[] primvars:st = [0.25, 0.5, 0.75, 1] (elementSize = 2; interpolation = \"uniform\")\n"),
      kBoth);
  EXPECT_EQ(uvs("texCoord2f[] primvars:uv = [(9, 9), (9, 9)] (interpolation = \"uniform\")\n"
                "texCoord2f[] primvars:st = [(0.25, 0.5), (0.75, 1)] (interpolation = \"uniform\")\n"),
            kBoth)
      << "st goes before uv";
  EXPECT_EQ(uvs("texCoord2f[] primvars:st = [(9, 9), (9, 9), (9, 9)] (interpolation = \"uniform\")\n"
                "texCoord2f[] primvars:uv = [(0.25, 0.5), (0.75, 1)] (interpolation = \"uniform\")\n"),
            kBoth)
      << "unless it cannot be used";
}

TEST(UsdaPrimvars, MetadataMayStandWithTheDeclarationAndValuesInTimeSamples) {
  EXPECT_EQ(uvs("texCoord2f[] primvars:st ( interpolation = \"uniform\" )\n"
                "texCoord2f[] primvars:st.timeSamples = { 9: [(1, 1), (1, 1)], 2: None,\n"
                "  4: [(0.25, 0.5), (0.75, 1)], }\n"),
            kBoth);
  EXPECT_EQ(uvs("texCoord2f[] primvars:st.timeSamples = { 1: [(0.75, 1), (0.25, 0.5)] }\n"
                "texCoord2f[] primvars:st ( interpolation = \"uniform\" )\n"
                "int[] primvars:st:indices.timeSamples = { 1: [1, 0] }\n"),
            kBoth);
}

TEST(UsdaPrimvars, ConstantOnesAreInheritedFromThePrimsAbove) {
  const std::vector<Vec2> same = {{0.25f, 0.5f}, {0.25f, 0.5f}};
  const std::string above = "texCoord2f[] primvars:st = [(0.25, 0.5)]";
  EXPECT_EQ(uvs("", above), same);
  EXPECT_EQ(uvs("", above + "( interpolation = \"constant\" )"), same);
  EXPECT_EQ(uvs("", "texCoord2f[] primvars:st = [(9, 9), (0.25, 0.5)]\nint[] primvars:st:indices = [1]"),
            same);
  EXPECT_EQ(uvs("texCoord2f[] primvars:st = [(0.25, 0.5), (0.75, 1)] (interpolation = \"uniform\")\n", above),
            kBoth);
  EXPECT_TRUE(uvs("", above + "( interpolation = \"vertex\" )").empty()) << "only constant ones are";
}

TEST(UsdaPrimvars, ThoseBetweenThatAreNotConstantEndTheInheritance) {
  const std::string above = "texCoord2f[] primvars:st = [(0.25, 0.5)]\n";
  const auto between = [&](const std::string& middle) {
    return readPrims("def Xform \"g\" {\n" + above + "def Xform \"h\" {\n" + middle + "\n" +
                     twoCurves(kKinds[0], "") + "}\n}")
        .strands.uvs;
  };
  const std::vector<Vec2> same = {{0.25f, 0.5f}, {0.25f, 0.5f}};
  EXPECT_EQ(between(""), same);
  EXPECT_EQ(between("texCoord2f[] primvars:st ( interpolation = \"vertex\" )"), same) << "without a value";
  EXPECT_EQ(between("texCoord2f[] primvars:st = [(1, 1)]"), (std::vector<Vec2>{{1, 1}, {1, 1}}));
  for (const char* other : {"uniform", "varying", "vertex", "faceVarying"})
    EXPECT_TRUE(
        between("texCoord2f[] primvars:st = [(1, 1)] ( interpolation = \"" + std::string(other) + "\" )")
            .empty())
        << other;
}

TEST(UsdaPrimvars, WidthsWithoutInterpolationAreTakenByTheirCountAndThatIsSaid) {
  const auto read = [](const std::string& widths) {
    return readPrims(twoCurves(kKinds[2], "float[] widths = [" + widths + "]\n"));
  };
  const RawGroom vertex = read("1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1");
  EXPECT_EQ(vertex.strands.radii.size(), vertex.strands.vertices());
  EXPECT_TRUE(vertex.report.warnings.empty()) << "widths are per vertex by default";
  for (const char* widths : {"4", "4, 4", "4, 4, 4, 4, 4, 4"}) {
    const RawGroom other = read(widths);
    ASSERT_FALSE(other.strands.radii.empty()) << widths;
    EXPECT_FLOAT_EQ(other.strands.radii[0], 2) << widths;
    ASSERT_EQ(other.report.warnings.size(), 1u) << widths;
    EXPECT_NE(other.report.warnings[0].find("widths have no interpolation"), std::string::npos);
  }
}

TEST(UsdaPrimvars, ValuesThatCannotBeUsedAreMendedAndCounted) {
  const RawGroom unauthored = readPrims(twoCurves(
      kKinds[0],
      "float[] primvars:widths = [2, 4, -1] (interpolation = \"vertex\"; unauthoredValuesIndex = 9)\n"
      "int[] primvars:widths:indices = [0, 1, 9, 2, 7]\n"
      "texCoord2f[] primvars:st = [(0.25, 0.5)] (interpolation = \"uniform\")\n"
      "int[] primvars:st:indices = [0, -1]\n"));
  EXPECT_EQ(unauthored.strands.uvs, (std::vector<Vec2>{{0.25f, 0.5f}, {0, 0}}));
  EXPECT_EQ(unauthored.strands.radii, (std::vector<float>{1, 2, 1.5f, 1.5f, 1.5f}));
  ASSERT_EQ(unauthored.report.warnings.size(), 2u);
  EXPECT_NE(unauthored.report.warnings[1].find("UVs that cannot be used are (0, 0) (1 of /c)"),
            std::string::npos);
  const RawGroom widths =
      readPrims(twoCurves(kKinds[0], "float[] widths = [2, -1, nan, 4, inf] (interpolation = \"vertex\")\n"));
  EXPECT_EQ(widths.strands.radii, (std::vector<float>{1, 1.5f, 1.5f, 2, 1.5f}));
  ASSERT_EQ(widths.report.warnings.size(), 1u);
  EXPECT_NE(widths.report.warnings[0].find("the mean of the others (3 of /c)"), std::string::npos);
}

TEST(UsdaPrimvars, WhatDoesNotFitIsLeftOutWithTheReason) {
  const auto reason = [](const std::string& more) {
    const RawGroom groom = readPrims(twoCurves(kKinds[2], more));
    EXPECT_TRUE(groom.strands.uvs.empty() && groom.strands.radii.empty());
    return groom.report.omissionsLine();
  };
  const std::string st = "texCoord2f[] primvars:st = ";
  const std::pair<std::string, const char*> rows[] = {
      {st + "[(1, 1), (2, 2)] (interpolation = \"faceVarying\")",
       "without UVs (/c: primvars:st has \"faceVarying\" interpolation, which curves do not have)"},
      {st + "[(1, 1), (2, 2)] (interpolation = \"varying\")",
       "without UVs (/c: primvars:st has 2 values where varying interpolation takes 6)"},
      {st + "[(1, 1)] (interpolation = \"uniform\")\nint[] primvars:st:indices = [0, 0, 0]",
       "without UVs (/c: primvars:st has 3 values where uniform interpolation takes 2)"},
      {st + "[(1, 1), (2, 2), (3, 3)]", "no interpolation that fits"},
      {"float[] primvars:st = [1, 2] (interpolation = \"uniform\")", "one number a value"},
      {"string[] primvars:st = [\"a\", \"b\"] (interpolation = \"uniform\")", "no values"},
      {"float[] widths = [1, 2, 3] (interpolation = \"uniform\")", "widths (/c: widths has 3 values"},
      {"float[] widths = [-1] (interpolation = \"constant\")", "widths has no value that can be used"},
      {"float[] widths = [1, 2, 3, 4] (interpolation = \"uniform\"; elementSize = 2)", "2 numbers a value"},
  };
  for (const auto& [more, expected] : rows)
    EXPECT_NE(reason(more + "\n").find(expected), std::string::npos) << reason(more + "\n");
  EXPECT_EQ(readPrims(twoCurves(kKinds[0],
                                "float[] primvars:displayOpacity = [0.5]\n"
                                "int[] primvars:hairId = [1, 2]\nint[] primvars:hairId:indices = [0]\n"))
                .report.omissionsLine(),
            "without opacities, 1 other primvar (hairId)");
}

TEST(UsdaPrimvars, ManyOthersAreCountedInNoTime) {
  std::string more;
  for (int i = 0; i < 20000; ++i) more += "float primvars:q" + std::to_string(i) + " = 1\n";
  EXPECT_EQ(readPrims(twoCurves(kKinds[0], more)).report.omissionsLine(),
            "without 20000 other primvars (q0, q1, q10, ...)");
}

TEST(UsdaPrimvars, UvsThatChangeAlongAStrandAreSaidToBeLost) {
  const std::string st = "texCoord2f[] primvars:st = [(0, 0), (0, 0.5), (0, 1), (1, 0), (1, 1)] ";
  const RawGroom groom = readPrims(twoCurves(kKinds[0], st + "(interpolation = \"vertex\")\n"));
  EXPECT_EQ(groom.strands.uvs, (std::vector<Vec2>{{0, 0}, {1, 0}}));
  EXPECT_EQ(groom.report.omissionsLine(), "without UVs along the strands but those of the roots");
}

}  // namespace
}  // namespace strandcast
