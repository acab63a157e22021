// Grammar of USD text, and which prims of a stage are read: transforms, visibility, purpose and variants.
#include <gtest/gtest.h>

#include "io/groom_file.h"
#include "tests/expect_error.h"
#include "tests/io/sample_files.h"

namespace strandcast {
namespace {

RawGroom readText(const std::string& text) { return readUsda(samples::fromText(text), "wig"); }

/// A strand of two points from (x, 0, 0) to (x, 4, 0), with `more` in its prim.
std::string lockPrim(const std::string& name, const std::string& more = "", int x = 0) {
  const std::string at = std::to_string(x);
  return "def BasisCurves \"" + name +
         "\" {\n uniform token type = \"linear\"\n int[] curveVertexCounts = [2]\n" +
         " point3f[] points = [(" + at + ", 0, 0), (" + at + ", 4, 0)]\n" + more + "\n}\n";
}
const std::string kHead = "#usda 1.0\n( metersPerUnit = 0.01 )\n";

/// Expects that the one strand of a text, that of lockPrim(), is read and nothing is reported.
void expectLock(const std::string& text) {
  SCOPED_TRACE(text);
  try {
    const RawGroom groom = readText(text);
    EXPECT_EQ(groom.strands.positions, (std::vector<Vec3>{{0, 0, 0}, {0, 4, 0}}));
    EXPECT_FLOAT_EQ(groom.unit_meters, 0.01f);
    EXPECT_EQ(groom.report.omissionsLine(), "");
    EXPECT_TRUE(groom.report.warnings.empty()) << groom.report.warnings[0];
  } catch (const Error& error) {
    ADD_FAILURE() << error.what();
  }
}

TEST(UsdaGrammar, CommentsStandBetweenAnyTwoTokens) {
  for (const std::string comment : {"# one\n", "// one # two\n", "/**/", "/* // \" ' { [ ( @ \n * / */",
                                    "# /* not open\n", "//* neither\n"}) {
    // Inserted from the last position to the first, so that comments stay whole.
    std::string spaced = lockPrim("lock");
    for (const char* mark :
         {", 4", "(0", "2]", "curveVertexCounts", "[]", "int", "=", "{", "\"lock\"", "BasisCurves"})
      spaced.insert(spaced.find(mark), comment);
    expectLock(kHead + spaced + comment);
  }
  expectLock(
      "#usda 1.0 // made by hand\n(\n\"words\" # more\n/* x */ metersPerUnit /* y */ = 0.01 // z\n)\n" +
      lockPrim("lock"));
  expectError([] { readText("#usda 1.0\n\n/* no end" + lockPrim("lock")); },
              {"line 3", "comment does not end"});
}

TEST(UsdaGrammar, LinesEndAsOnEverySystem) {
  for (const std::string end : {"\r\n", "\r", "\n"}) {
    std::string text = kHead + "# comment\n" + lockPrim("lock", "// comment"), ended;
    for (const char c : text) ended += c == '\n' ? end : std::string(1, c);
    expectLock(ended);
    expectLock("\xEF\xBB\xBF" + ended);
    expectError([&] { readText("#usda 1.0" + end + end + "def"); }, {"line 3", "name in quotes"});
  }
}

TEST(UsdaGrammar, VersionsOneAreReadOthersRefusedByName) {
  for (const char* version : {"1.0", "1.1", "1.2", "1.13", "1.0.1", " 1.0\t"})
    expectLock("#usda " + std::string(version) + "\n( metersPerUnit = 0.01 )\n" + lockPrim("lock"));
  for (const char* version : {"2.0", "10.0", "0.8"})
    expectError([&] { readText("#usda " + std::string(version) + "\n" + lockPrim("lock")); },
                {"line 1", std::string("version ") + version, "1.x", "usdcat"});
  for (const char* version : {"", "one", "1", "1."})
    expectError([&] { readText("#usda " + std::string(version) + "\n" + lockPrim("lock")); },
                {"version", "1.0"});
}

TEST(UsdaGrammar, StringsAssetsPathsAndNumbersInAllTheirForms) {
  for (const char* property :
       {"string a = 'it\\'s } {'",
        "string a = \"say \\\"}\\\"\"",
        "string a = '''two\n} lines'''",
        "string a = \"\"\"a \"quoted\" }\n\"\"\"",
        "string a = \"\"; string b = ''",
        "asset a = @./maps/skin }.png@",
        "asset a = @@@a@b}@@c.png@@@",
        "asset a = @@@ends@@@@@",
        "asset a = @@@an \\@@@ }@@@",
        "asset a = @@",
        "asset[] a = [@a@, @b@,]",
        "rel a = </x/y.z>",
        "rel a = [<../b>, </c{v=d}e>]",
        "rel a",
        "custom rel a = None",
        "prepend rel a = </b>",
        "delete rel a = [</b>]",
        "add rel a = </b>",
        "append rel a = </b>",
        "reorder rel a = [</c>, </b>]",
        "float a = -inf",
        "double[] a = [inf, -inf, nan, +1, .5, 1., 1e10, -1E-5, 1e400]",
        "int a = None",
        "float a.connect = </b.outputs:c>",
        "prepend color3f a.connect = [</b.c>]",
        "float a.timeSamples = { 1: 2, 2: None, -inf: 3, }",
        "double a.spline = { bezier, pre: held, 1: 5; post width 1, slope 2, 2: 6 & 7, }",
        "dictionary a = { string b = \"}\"; dictionary c = { int d = 1 } }",
        "bool a = true; bool b = 0",
        "custom uniform token a:b:c = \"d\" ( doc = 'e'; customData = { string f = \")\" } )",
        "matrix4d a = ( (1,0,0,0), (0,1,0,0), (0,0,1,0), (0,0,0,1) )",
        "opaque a",
        "pathExpression a = \"//\"",
        "float a ( \"words\" hidden = true, displayGroup = \"x\"; prepend y = [1] )",
        "reorder nameChildren = [\"a\"]",
        "reorder properties = [\"a\", \"b\"]",
        "varying float2 a = (0, 1);;",
        "quath a = (1, 0, 0, 0)",
        "timecode a = 1",
        "string a = \"\xC3\xA4 \xE2\x9C\x93\"",
        "def \"untyped\" {}",
        "over \"x\" { float primvars:q = 1 }",
        "class Scope \"x\" {}",
        "def Scope \"x\" ( prepend apiSchemas = [\"A\"]; kind = \"group\"; doc = \"\"\"a\nb\"\"\" ) {}",
        "def Scope \"x\" ( references = None; payload = []; delete inherits = </y> ) {}"})
    expectLock(kHead + lockPrim("lock", property));
  expectLock(
      "#usda 1.0\n(\n 'words'\n customLayerData = { dictionary a = { asset b = @c@ } }; metersPerUnit = "
      "1e-2\n"
      " subLayers = []\n relocates = { <a>: <b> }\n timeCodesPerSecond = 24,\n)\nreorder rootPrims = "
      "[\"a\"]\n" +
      lockPrim("lock"));
  expectError([] { readText(kHead + lockPrim("lock", "float a = @no end")); },
              {"line 7", "asset does not end"});
  expectError([] { readText(kHead + lockPrim("lock", "string a = 'no end\n'")); },
              {"line 7", "string does not end"});
  expectError([] { readText(kHead + lockPrim("lock", "point3f[] points = [(0x10, 0, 0)]")); },
              {"line 7", "number"});
}

Vec3 tipUnder(const std::string& ops, const std::string& order) {
  return readText(kHead + "def Xform \"g\" {\n" + ops + "\nuniform token[] xformOpOrder = [" + order + "]\n" +
                  lockPrim("lock") + "}")
      .strands.positions[1];
}

TEST(UsdaTransforms, EveryOperationInEveryTypeMovesTheStrand) {
  const auto expectTip = [](const std::string& op, const std::string& value, const Vec3& tip) {
    const size_t space = op.find(' ');
    const std::string name = op.substr(space + 1), order = "\"" + name + "\"";
    EXPECT_LT((tipUnder(op + " = " + value, order) - tip).norm(), 1e-5f) << op;
    EXPECT_LT((tipUnder(op + ".timeSamples = { 5: " + value + " }", order) - tip).norm(), 1e-5f) << op;
    const std::string back = order + ", \"!invert!" + name + "\"";
    EXPECT_LT((tipUnder(op + " = " + value, back) - Vec3(0, 4, 0)).norm(), 1e-5f) << op;
    EXPECT_LT((tipUnder(op, order) - Vec3(0, 4, 0)).norm(), 1e-5f) << op << " without a value";
    EXPECT_LT((tipUnder(op + " = None", order) - Vec3(0, 4, 0)).norm(), 1e-5f) << op << " = None";
  };
  for (const char* type : {"double", "float", "half"}) {
    const std::string one = std::string(type) + " xformOp:", three = std::string(type) + "3 xformOp:";
    expectTip(three + "translate", "(1, 2, 3)", {1, 6, 3});
    expectTip(one + "translateX", "5", {5, 4, 0});
    expectTip(one + "translateY:pivot", "5", {0, 9, 0});
    expectTip(one + "translateZ", "5", {0, 4, 5});
    expectTip(three + "scale:a:b", "(2, 3, 4)", {0, 12, 0});
    expectTip(one + "scaleX", "2", {0, 4, 0});
    expectTip(one + "scaleY", "2", {0, 8, 0});
    expectTip(one + "scaleZ", "2", {0, 4, 0});
    expectTip(one + "rotateX:tilt", "90", {0, 0, 4});
    expectTip(one + "rotateY", "90", {0, 4, 0});
    expectTip(one + "rotateZ", "90", {-4, 0, 0});
    // The first axis is applied first.
    expectTip(three + "rotateXYZ", "(90, 90, 0)", {4, 0, 0});
    expectTip(three + "rotateXYZ", "(90, 90, 90)", {0, 4, 0});
    expectTip(three + "rotateXZY", "(90, 90, 90)", {4, 0, 0});
    expectTip(three + "rotateYXZ", "(90, 90, 90)", {0, 0, 4});
    expectTip(three + "rotateYZX", "(90, 90, 90)", {-4, 0, 0});
    expectTip(three + "rotateZXY", "(90, 90, 90)", {0, 0, 4});
    expectTip(three + "rotateZYX", "(90, 90, 90)", {0, -4, 0});
  }
  for (const char* type : {"quatf", "quatd", "quath"})
    expectTip(std::string(type) + " xformOp:orient", "(0, 0, 0, 1)", {0, -4, 0});
  expectTip("matrix4d xformOp:transform", "( (1,0,0,0), (0,2,0,0), (0,0,1,0), (7,8,9,1) )", {7, 16, 9});
}

TEST(UsdaTransforms, OperationsWithoutAValueAreSaid) {
  const RawGroom groom = readText(kHead +
                                  "def Xform \"g\" {\n float3 xformOp:scale\nuniform token[] xformOpOrder = "
                                  "[\"xformOp:scale\", \"xformOp:none\"]\n" +
                                  lockPrim("lock") + "}");
  ASSERT_EQ(groom.report.warnings.size(), 1u);
  EXPECT_NE(groom.report.warnings[0].find("2 operations of xformOpOrder without a value"), std::string::npos);
  EXPECT_NE(groom.report.warnings[0].find("xformOp:scale of /g"), std::string::npos);
}

TEST(UsdaTransforms, AResetLeavesThePrimsAboveAndWhatStandsBeforeIt) {
  const std::string above =
      "def Xform \"a\" {\n double3 xformOp:translate = (100, 0, 0)\n"
      "uniform token[] xformOpOrder = [\"xformOp:translate\"]\n";
  const std::string ops =
      "double xformOp:translateX = 1\ndouble xformOp:translateZ = 2\nuniform token[] xformOpOrder = ";
  const auto root = [&](const std::string& order) {
    return readText(kHead + above + lockPrim("lock", ops + order) + "}").strands.positions[0];
  };
  EXPECT_EQ(root("[\"xformOp:translateX\", \"xformOp:translateZ\"]"), Vec3(101, 0, 2));
  EXPECT_EQ(root("[\"xformOp:translateX\", \"!resetXformStack!\", \"xformOp:translateZ\"]"), Vec3(0, 0, 2));
  EXPECT_EQ(root("None"), Vec3(100, 0, 0));
}

TEST(UsdaTransforms, APrimThatCannotBePlacedDoesNotCostTheOthers) {
  for (const std::string bad :
       {"float3 xformOp:scale = (1, 2)", "float3 xformOp:scale = (1, nan, 1)",
        "float3 xformOp:shear = (1, 2, 3)", "float3 xformOp:rotateXXY = (1, 2, 3)",
        "float3 xformOp:translateXY = (1, 2, 3)", "float4 xformOp:orient = (1, 2, 3)"}) {
    const std::string name = bad.substr(bad.find(' ') + 1, bad.find(" =") - bad.find(' ') - 1);
    const std::string prim = "def Xform \"g\" {\n" + bad + "\nuniform token[] xformOpOrder = [\"" + name +
                             "\"]\n" + lockPrim("lost") + "}\n";
    const RawGroom groom = readText(kHead + prim + lockPrim("lock"));
    EXPECT_EQ(groom.strands.strands(), 1u) << bad;
    EXPECT_NE(groom.report.omissionsLine().find("1 prim that cannot be read (/g/lost: "), std::string::npos)
        << bad;
    expectError([&] { readText(kHead + prim); }, {"line 4", name});
  }
  const std::string flat =
      "float3 xformOp:scale = (1, 0, 1)\nuniform token[] xformOpOrder = [\"!invert!xformOp:scale\"]";
  expectError([&] { readText(kHead + lockPrim("lost", flat)); }, {"line 7", "cannot be inverted"});
}

/// The x coordinates of the roots that are read from a stage with these prims and one more strand at x = 9.
std::vector<float> shown(const std::string& prims, std::string* left_out = nullptr) {
  const RawGroom groom = readText(kHead + prims + lockPrim("last", "", 9));
  std::vector<float> out;
  for (size_t s = 0; s < groom.strands.strands(); ++s)
    out.push_back(groom.strands.positions[groom.strands.offsets[s]].x());
  if (left_out != nullptr) *left_out = groom.report.omissionsLine();
  return out;
}

TEST(UsdaVisibility, InvisiblePrimsAndAllBelowThemAreLeftOutAndNamed) {
  std::string left_out;
  EXPECT_EQ(shown("def Scope \"old\" {\n def Xform \"x\" {\n token visibility = \"inherited\"\n" +
                      lockPrim("a", "", 1) + "}\n token visibility = \"invisible\"\n" + lockPrim("b", "", 2) +
                      "}\n" + lockPrim("c", "", 3),
                  &left_out),
            (std::vector<float>{3, 9}));
  EXPECT_EQ(left_out, "without 2 invisible prims (/old/x/a, /old/b)");
  EXPECT_EQ(shown(lockPrim("a", "token visibility = \"inherited\"", 1)), (std::vector<float>{1, 9}));
  EXPECT_EQ(shown(lockPrim("a", "token visibility = \"invisible\"", 1), &left_out), (std::vector<float>{9}));
  EXPECT_EQ(left_out, "without 1 invisible prim (/a)");
  EXPECT_EQ(shown(lockPrim("a", "token visibility.timeSamples = { 1: \"invisible\", 9: \"inherited\" }", 1)),
            (std::vector<float>{9}));
  EXPECT_EQ(shown(lockPrim("a", "token visibility.timeSamples = { 9: \"invisible\", 1: \"inherited\" }", 1)),
            (std::vector<float>{1, 9}));
  EXPECT_EQ(shown(lockPrim("a", "token visibility = None", 1)), (std::vector<float>{1, 9}));
  expectError([] { readText(kHead + lockPrim("a", "token visibility = \"invisible\"")); },
              {"no BasisCurves", "1 invisible prim (/a)", "make the hair visible"});
}

TEST(UsdaVisibility, PurposeIsInheritedAndGuidesAndProxiesAreLeftOut) {
  std::string left_out;
  const std::string rest = lockPrim("none", "", 1) +
                           lockPrim("own", "uniform token purpose = \"render\"", 2) +
                           lockPrim("default", "uniform token purpose = \"default\"", 3);
  const auto under = [&](const std::string& purpose) {
    return shown("def Xform \"g\" {\n uniform token purpose = \"" + purpose + "\"\n def Scope \"s\" {\n" +
                     rest + "}\n}\n",
                 &left_out);
  };
  EXPECT_EQ(under("guide"), (std::vector<float>{2, 3, 9}));
  EXPECT_EQ(left_out, "without 1 prim of purpose guide (/g/s/none)");
  EXPECT_EQ(under("proxy"), (std::vector<float>{2, 3, 9}));
  EXPECT_EQ(left_out, "without 1 prim of purpose proxy (/g/s/none)");
  EXPECT_EQ(under("render"), (std::vector<float>{1, 2, 3, 9}));
  EXPECT_EQ(under("default"), (std::vector<float>{1, 2, 3, 9}));
}

TEST(UsdaVisibility, PrototypesInactiveAndAbstractPrimsDoNotShow) {
  std::string left_out;
  EXPECT_EQ(
      shown("def PointInstancer \"i\" {\n def Scope \"p\" {\n" + lockPrim("a", "", 1) + "}\n}\n", &left_out),
      (std::vector<float>{9}));
  EXPECT_EQ(left_out, "without 1 prototype of a PointInstancer (/i/p/a)");
  EXPECT_EQ(shown("def \"g\" ( active = false ) {\n" + lockPrim("a", "", 1) + "}\n"),
            (std::vector<float>{9}));
  EXPECT_EQ(
      shown("over \"g\" {\n" + lockPrim("a", "", 1) + "}\nclass \"h\" {\n" + lockPrim("b", "", 2) + "}\n"),
      (std::vector<float>{9}));
}

TEST(UsdaVisibility, InactiveAbstractAndUndefinedHairIsNamed) {
  std::string left_out;
  shown("def \"g\" ( active = false ) {\n" + lockPrim("a", "", 1) + "}\n", &left_out);
  EXPECT_EQ(left_out, "without 1 inactive prim (/g/a)");
  std::string self = lockPrim("a", "", 1), typed = lockPrim("b", "", 2);
  self.insert(self.find('{'), "( active = 0 ) ");
  typed.replace(0, 3, "over");
  EXPECT_EQ(shown(self + "class \"h\" {\n" + lockPrim("b", "", 2) + "}\nover \"i\" {\n" +
                      lockPrim("c", "", 3) + "}\n" + typed + "def \"empty\" ( active = false ) {}\n",
                  &left_out),
            (std::vector<float>{9}));
  EXPECT_EQ(
      left_out,
      "without 1 inactive prim (/a), 1 prim of a class (/h/b), 2 prims of overs without a def (/i/c, /b)");
  expectError([&] { readText(kHead + self); },
              {"no BasisCurves", "that show", "1 inactive prim (/a)", "make the hair visible, active"});
}

TEST(UsdaVisibility, OnlyTheSelectedVariantIsReadAndThePrimItselfIsStronger) {
  std::string left_out;
  const auto read = [&](const std::string& selected, const std::string& more = "") {
    return shown("def Xform \"g\" (\n variants = { string style = \"" + selected +
                     "\" }\n prepend variantSets = \"style\"\n)\n{\n" + more +
                     "\nvariantSet \"style\" = {\n \"long\" {\n" + lockPrim("a", "", 1) +
                     "}\n \"short\" ( \"words\" ) {\n token visibility = \"inherited\"\n" +
                     lockPrim("a", "", 2) + lockPrim("b", "", 3) + "}\n}\n}\n",
                 &left_out);
  };
  EXPECT_EQ(read("long"), (std::vector<float>{1, 9}));
  EXPECT_EQ(left_out, "without variants that are not selected");
  EXPECT_EQ(read("short"), (std::vector<float>{2, 3, 9}));
  EXPECT_EQ(read("none"), (std::vector<float>{9}));
  EXPECT_EQ(read("short", "over \"b\" {\n token visibility = \"invisible\"\n}"), (std::vector<float>{2, 9}));
  EXPECT_EQ(read("short", "token visibility = \"invisible\""), (std::vector<float>{9}));
}

/// A prim with variant sets `a` and `b`, of which "x" and "y" are selected.
std::string groupOf(const std::string& blocks, const std::string& sets = "[\"a\", \"b\"]") {
  return "def \"g\" (\n variants = { string a = \"x\"; string b = \"y\" }\n prepend variantSets = " + sets +
         "\n)\n{\n" + blocks + "\n}\n";
}
std::string variantOf(const std::string& set, const std::string& name, const std::string& content,
                      const std::string& metadata = "") {
  return "variantSet \"" + set + "\" = {\n \"" + name + "\" " + metadata + " {\n" + content + "\n}\n}\n";
}

TEST(UsdaVariants, WhatAnOverSaysIsKeptWhereverItsDefStands) {
  const std::string over =
      "over \"a\" {\n point3f[] points = [(5, 0, 0), (5, 4, 0)]\n float[] widths = [2, 2]\n int[] "
      "primvars:clump = [1]\n}\n";
  const std::string variant = variantOf("a", "x", lockPrim("a", "", 1));
  for (const std::string& blocks : {over + variant, variant + over}) {
    const RawGroom groom = readText(kHead + groupOf(blocks));
    EXPECT_EQ(groom.strands.positions, (std::vector<Vec3>{{5, 0, 0}, {5, 4, 0}})) << blocks;
    EXPECT_EQ(groom.strands.radii, (std::vector<float>{1, 1})) << blocks;
    EXPECT_EQ(groom.report.omissionsLine(), "without 1 other primvar (clump)") << blocks;
  }
  const std::string weak_over = variantOf(
      "a", "x", "over \"a\" {\n point3f[] points = [(5, 0, 0), (5, 4, 0)]\n float[] widths = [2, 2]\n}\n");
  for (const std::string& blocks : {weak_over + lockPrim("a", "", 1), lockPrim("a", "", 1) + weak_over}) {
    const RawGroom groom = readText(kHead + groupOf(blocks));
    EXPECT_EQ(groom.strands.positions, (std::vector<Vec3>{{1, 0, 0}, {1, 4, 0}})) << blocks;
    EXPECT_EQ(groom.strands.radii, (std::vector<float>{1, 1})) << blocks;
  }
  // Properties kept of an over that turns out to be no curves do not affect the prims below it.
  std::string left_out;
  shown(
      "def \"g\" ( variants = { string a = \"x\" } ) {\n over \"m\" {\n point3f[] points.timeSamples = { 1: "
      "[(0, 0, 0)] }\n" +
          lockPrim("a", "", 1) + "}\n" + variantOf("a", "x", "def Mesh \"m\" {}") + "}\n",
      &left_out);
  EXPECT_EQ(left_out, "");
}

TEST(UsdaVariants, ActiveIsTheStrongestThatIsSaid) {
  const std::string lock = lockPrim("a", "", 1);
  std::string active = lock;
  active.insert(active.find('{'), "( active = true ) ");
  const std::string off = variantOf("a", "x", "over \"a\" ( active = false ) {}");
  EXPECT_EQ(shown(groupOf(lock + off)), (std::vector<float>{9}));
  EXPECT_EQ(shown(groupOf(off + lock)), (std::vector<float>{9}));
  EXPECT_EQ(shown(groupOf(active + off)), (std::vector<float>{1, 9}));
  EXPECT_EQ(shown(groupOf(off + active)), (std::vector<float>{1, 9}));
  EXPECT_EQ(shown(groupOf(lock + variantOf("a", "x", "", "( active = false )"))), (std::vector<float>{9}));
  EXPECT_EQ(shown(groupOf(lock + variantOf("a", "other", "", "( active = false )"))),
            (std::vector<float>{1, 9}));
}

TEST(UsdaVariants, TheSetListedFirstIsTheStronger) {
  const auto rootAt = [](const std::string& x) {
    return "over \"a\" {\n point3f[] points = [(" + x + ", 0, 0), (" + x + ", 4, 0)]\n}\n";
  };
  const std::string def =
      "def BasisCurves \"a\" {\n uniform token type = \"linear\"\n int[] "
      "curveVertexCounts = [2]\n}\n";
  const std::string a = variantOf("a", "x", rootAt("3")), b = variantOf("b", "y", rootAt("4"));
  for (const std::string& blocks : {def + a + b, b + def + a, b + a + def}) {
    EXPECT_EQ(shown(groupOf(blocks)), (std::vector<float>{3, 9})) << blocks;
    EXPECT_EQ(shown(groupOf(blocks, "[\"b\", \"a\"]")), (std::vector<float>{4, 9})) << blocks;
    EXPECT_EQ(shown(groupOf(blocks, "\"b\"")), (std::vector<float>{4, 9})) << blocks;
  }
}

TEST(UsdaVariants, ADeclarationWithoutAValueHidesNone) {
  const std::string value =
      "over \"a\" {\n float2[] primvars:st = [(0.5, 0.25)] ( interpolation = "
      "\"vertex\" )\n}\n";
  const std::string declared = "float2[] primvars:st ( interpolation = \"uniform\" )";
  const auto uvs = [&](const std::string& local) {
    return readText(kHead + groupOf(lockPrim("a", local) + variantOf("a", "x", value))).strands.uvs;
  };
  EXPECT_EQ(uvs(declared), (std::vector<Vec2>{{0.5f, 0.25f}}));
  EXPECT_EQ(uvs("float2[] primvars:st = None"), std::vector<Vec2>()) << "blocked";
  EXPECT_EQ(uvs("float2[] primvars:st = [(1, 1)] ( interpolation = \"uniform\" )"),
            (std::vector<Vec2>{{1, 1}}));
}

TEST(UsdaVariants, VariantsInVariantsAreSelectedByThem) {
  const std::string nested = variantOf("b", "y", lockPrim("a", "", 1)) + variantOf("b", "z", "");
  const auto group = [&](const std::string& own, const std::string& metadata) {
    return "def \"g\" ( variants = { string a = \"x\"" + own + " } prepend variantSets = \"a\" ) {\n" +
           variantOf("a", "x", nested, metadata) + "}\n";
  };
  const std::string picks = "( variants = { string b = \"y\" } prepend variantSets = \"b\" )";
  EXPECT_EQ(shown(group("", picks)), (std::vector<float>{1, 9}));
  EXPECT_EQ(shown(group("", "")), (std::vector<float>{9}));
  EXPECT_EQ(shown(group("; string b = \"z\"", picks)), (std::vector<float>{9})) << "the prim is stronger";
  std::string deep;
  for (int i = 0; i < 200; ++i) deep += "variantSet \"a\" = { \"x\" {";
  for (int i = 0; i < 200; ++i) deep += "} }";
  expectError([&] { readText(kHead + groupOf(deep)); }, {"variant sets lie more than 64 deep"});
}

TEST(UsdaStages, OtherFilesThatAStageNeedsAreNamed) {
  std::string left_out;
  shown(
      "def \"g\" ( prepend references = [@./fur/a.usda@</fur> (offset = 2), </class>] payload = @b.usdc@ ) "
      "{}\n",
      &left_out);
  EXPECT_EQ(left_out, "without references (@./fur/a.usda@, </class>, @b.usdc@)");
  expectError([] { readText("#usda 1.0\n( subLayers = [ @hair.usda@ (scale = 2), @b.usda@ ] )\n"); },
              {"no BasisCurves", "sublayers (@hair.usda@, @b.usda@)", "usdcat --flatten"});
}

TEST(UsdaStages, ADefaultGoesBeforeTimeSamplesAndTheyAreSaidToBeLost) {
  const std::string samples = "point3f[] points.timeSamples = { 1: [(5, 0, 0), (5, 4, 0)] }";
  std::string left_out;
  EXPECT_EQ(shown(lockPrim("a", samples, 1), &left_out), (std::vector<float>{1, 9}));
  EXPECT_EQ(left_out, "without time samples");
  EXPECT_EQ(
      shown("def BasisCurves \"a\" {\n uniform token type = \"linear\"\n int[] curveVertexCounts = [2]\n" +
                samples + "\n}\n",
            &left_out),
      (std::vector<float>{5, 9}));
  EXPECT_EQ(left_out, "without time samples");
}

TEST(UsdaCurves, CurvesThatFitNoSegmentAreLeftOutAndCounted) {
  const auto read = [](const std::string& kind, const std::string& counts, size_t points) {
    std::string all;
    for (size_t i = 0; i < points; ++i) all += "(0, " + std::to_string(i) + ", 0), ";
    return readText(kHead + "def BasisCurves \"c\" {\n" + kind + "\nint[] curveVertexCounts = [" + counts +
                    "]\npoint3f[] points = [" + all + "]\nfloat[] widths = [" + "1, 2, 3" +
                    "] ( interpolation = \"uniform\" )\n}\n");
  };
  const std::string linear = "uniform token type = \"linear\"", bspline = "uniform token basis = \"bspline\"",
                    pinned = bspline + "\nuniform token wrap = \"pinned\"";
  const std::tuple<std::string, std::string, size_t, const char*> rows[] = {
      {linear, "2, 1, 3", 6, "1 curve with too few or too many points (/c, curve 1 of 1 point)"},
      {linear, "2, 0, 3", 5, "curve 1 of 0 points"},
      {"", "4, 5, 7", 16, "curve 1 of 5 points"},
      {"", "4, 3, 4", 11, "curve 1 of 3 points"},
      {bspline, "4, 3, 5", 12, "curve 1 of 3 points"},
      {pinned, "2, 1, 3", 6, "curve 1 of 1 point"},
  };
  for (const auto& [kind, counts, points, said] : rows) {
    const RawGroom groom = read(kind, counts, points);
    ASSERT_EQ(groom.strands.strands(), 2u) << counts;
    EXPECT_NE(groom.report.omissionsLine().find(said), std::string::npos) << groom.report.omissionsLine();
    EXPECT_FLOAT_EQ(groom.strands.radii.front(), 0.5f);
    EXPECT_FLOAT_EQ(groom.strands.radii.back(), 1.5f) << "values stay with their curves";
  }
}

TEST(UsdaCurves, TuplesOfAnotherSizeThanTheirTypeCostTheirPrimOnly) {
  const auto said = [](const std::string& property) {
    std::string out;
    EXPECT_EQ(shown("def BasisCurves \"c\" {\n uniform token type = \"linear\"\n int[] curveVertexCounts = "
                    "[2]\n" +
                        property + "\n}\n",
                    &out),
              (std::vector<float>{9}));
    return out;
  };
  EXPECT_EQ(said("point3f[] points = [(0, 0), (0, 1, 0, 1)]"),
            "without 1 prim that cannot be read (/c: points has tuples of 2 where point3f takes 3)");
  EXPECT_NE(said("point3f[] points.timeSamples = { 1: [(0, 0, 0, 1), (1, 0)] }").find("has tuples of 2"),
            std::string::npos);
  EXPECT_NE(said("float3[] points = [0, 0, 0, 0, 1, 0]").find("has tuples of 1"), std::string::npos);
  EXPECT_NE(said("point3d[] points = [(0, 0, 0, 0, 1, 0)]").find("has tuples of 6"), std::string::npos);
  std::string uvs;
  EXPECT_EQ(
      shown(lockPrim("c", "float2[] primvars:st = [(0, 0, 1), (1)] ( interpolation = \"vertex\" )", 1), &uvs),
      (std::vector<float>{1, 9}));
  EXPECT_NE(uvs.find("UVs (/c: primvars:st has tuples of 1"), std::string::npos) << uvs;
  EXPECT_NE(
      said("point3f[] points = [(0, 0, 0), (0, 1, 0)]\nmatrix4d xformOp:transform = ((1,0,0,0,0), (1,0,0),"
           "(0,0,1,0), (0,0,0,1))\nuniform token[] xformOpOrder = [\"xformOp:transform\"]")
          .find("where matrix4d takes 4"),
      std::string::npos);
}

TEST(UsdaCurves, CurvesAndPrimsOutOfRangeDoNotCostTheOthers) {
  const auto left_out = [](const std::string& counts, const std::string& points) {
    std::string out;
    EXPECT_EQ(shown("def BasisCurves \"c\" {\n uniform token type = \"linear\"\n int[] curveVertexCounts = " +
                        counts + "\n point3f[] points = " + points + "\n}\n",
                    &out)
                  .back(),
              9);
    return out;
  };
  for (const char* number : {"nan", "inf", "-inf", "1e39", "1e400"})
    EXPECT_EQ(left_out("[2, 2]", "[(0, 0, 0), (0, " + std::string(number) + ", 0), (3, 0, 0), (3, 1, 0)]"),
              "without 1 curve out of range (/c, curve 0)");
  const std::string two = "[(0, 0, 0), (0, 1, 0)]";
  for (const char* counts : {"[3]", "[-1, 3]", "[1.5]", "[1, 2]", "[nan]", "[1]", "[]", "None"}) {
    const std::string said = left_out(counts, two);
    EXPECT_TRUE(said.find("1 prim that cannot be read (/c: ") != std::string::npos) << counts << ": " << said;
  }
}

}  // namespace
}  // namespace strandcast
