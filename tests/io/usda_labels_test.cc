// Labels of strands in USD text: ids, guide marks, groups and colours, under the names of Unreal's grooms.
#include <gtest/gtest.h>

#include "io/groom_file.h"
#include "tests/io/sample_files.h"

namespace strandcast {
namespace {

using Ids = std::vector<uint32_t>;
using Marks = std::vector<uint8_t>;
using Colours = std::vector<Vec3>;

/// Linear curves of 2 and 3 points, with `more` in their prim.
std::string twoCurves(const std::string& name, const std::string& more) {
  return "def BasisCurves \"" + name +
         "\" { uniform token type = \"linear\"\n int[] curveVertexCounts = [2, 3]\n"
         "point3f[] points = [(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0), (1, 2, 0)]\n" +
         more + "\n}\n";
}

RawGroom readLabelledPrims(const std::string& prims) {
  return readUsda(samples::fromText("#usda 1.0\n( metersPerUnit = 1 )\n" + prims), "wig");
}
RawGroom readTwo(const std::string& more) { return readLabelledPrims(twoCurves("c", more)); }

/// A property with interpolation.
std::string property(const std::string& declared, const std::string& values, const std::string& how) {
  return declared + " = " + values + " ( interpolation = \"" + how + "\" )\n";
}

std::string onlyWarning(const RawGroom& groom) {
  return groom.report.warnings.size() == 1 ? groom.report.warnings[0] : "not one warning";
}

TEST(UsdaLabels, OfAGroomOfUnrealAreRead) {
  const RawGroom groom = readUsda(samples::usdaLabels(), "wig");
  const StrandSet& strands = groom.strands;
  EXPECT_EQ(strands.ids, (Ids{7, 4294967295u, 9}));
  EXPECT_EQ(strands.is_guide, (Marks{1, 0, 0})) << "a prim without marks has no guides";
  EXPECT_EQ(strands.groups, (Ids{0, 1, 2}));
  ASSERT_EQ(groom.groups.size(), 3u);
  EXPECT_EQ(groom.groups[0].id, -1);
  EXPECT_EQ(groom.groups[0].name, "a \"b\"");
  EXPECT_EQ(groom.groups[1].id, 3);
  EXPECT_EQ(groom.groups[1].name, "c\a");
  EXPECT_EQ(groom.groups[2].id, 0) << "a prim without group ids";
  EXPECT_EQ(groom.groups[2].name, "");
  EXPECT_EQ(strands.uvs, (std::vector<Vec2>{{0.25f, 0.5f}, {0.5f, 0.75f}, {0.25f, 0.5f}}));
  ASSERT_EQ(strands.radii.size(), 9u);
  EXPECT_FLOAT_EQ(strands.radii[4], 0.25f);
  ASSERT_EQ(strands.colours.size(), 3u);
  EXPECT_EQ(strands.colours[0], Vec3(0.5f, 0.5f, 0));
  EXPECT_EQ(strands.colours[2], Vec3(0.5f, 0.25f, 0.125f)) << "inherited";
  EXPECT_EQ(groom.report.omissionsLine(), "without colours along the strands but their means");
  EXPECT_EQ(onlyWarning(groom), "colours that cannot be used are the mean of the others (1 of /g/a)");
}

TEST(UsdaLabels, EveryInterpolationGivesThatOfTheRoot) {
  for (const std::string prefix : {"primvars:", ""}) {
    const auto read = [&](const char* values, const char* how) {
      const RawGroom groom = readTwo(property("int[] " + prefix + "groom_guide", values, how) +
                                     property("int[] " + prefix + "groom_id", values, how) +
                                     property("int[] " + prefix + "groom_group_id", values, how));
      EXPECT_EQ(groom.strands.ids.size(), 2u) << how << groom.report.omissionsLine();
      EXPECT_EQ(groom.strands.is_guide, (Marks{1, groom.strands.ids.back() != 0})) << how;
      EXPECT_EQ(groom.groups.at(groom.strands.groups.at(0)).id, 5) << how;
      return groom.strands.ids;
    };
    EXPECT_EQ(read("[5]", "constant"), (Ids{5, 5}));
    EXPECT_EQ(read("[5, 0]", "uniform"), (Ids{5, 0}));
    EXPECT_EQ(read("[5, 5, 0, 0, 0]", "vertex"), (Ids{5, 0}));
    EXPECT_EQ(read("[5, 5, 0, 0, 0]", "varying"), (Ids{5, 0}));
  }
  EXPECT_EQ(readTwo(property("int[] groom_id", "[1, 2, 3, 4, 5]", "vertex")).report.omissionsLine(),
            "without ids along the strands but those of the roots");
  const RawGroom guessed = readTwo("int[] groom_id = [1, 2]\n");
  EXPECT_EQ(guessed.strands.ids, (Ids{1, 2}));
  EXPECT_EQ(onlyWarning(guessed), "ids have no interpolation, their count told it (/c)");
  EXPECT_EQ(readTwo("int groom_guide = 1\n").strands.is_guide, (Marks{1, 1}));
  EXPECT_EQ(readTwo("bool primvars:groom_guide = true\n").strands.is_guide, (Marks{1, 1}));
}

TEST(UsdaLabels, ColoursAreThoseOfTheGroomElseOfTheDisplay) {
  const std::string display =
      property("color3f[] primvars:displayColor", "[(0, 0, 1), (0, 1, 0)]", "uniform");
  EXPECT_EQ(readTwo(display).strands.colours, (Colours{{0, 0, 1}, {0, 1, 0}}));
  EXPECT_EQ(readTwo(display + "float3[] groom_color = [(1, 0, 0)]\n").strands.colours,
            (Colours{{1, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(readTwo("color4f[] primvars:displayColor = [(1, 0.5, 0, 0.25)]\n").strands.colours[1],
            Vec3(1, 0.5f, 0));
  const std::string hot = property("color3f[] primvars:displayColor", "[(1, nan, 0), (0, 1, 3)]", "uniform");
  EXPECT_EQ(readTwo(hot).strands.colours, (Colours{{0, 1, 3}, {0, 1, 3}}));
}

TEST(UsdaLabels, GroupsHaveTheirFirstNameAndMayHaveNamesAlone) {
  const std::string names = property("string[] groom_group_name", "[\"a\", \"b\"]", "uniform");
  const RawGroom unnumbered = readTwo(names);
  EXPECT_EQ(unnumbered.strands.groups, (Ids{0, 1}));
  ASSERT_EQ(unnumbered.groups.size(), 2u);
  EXPECT_EQ(unnumbered.groups[1].id, 1);
  EXPECT_EQ(unnumbered.groups[1].name, "b");
  const RawGroom doubtful = readTwo(names + "int[] groom_group_id = [4]\n");
  ASSERT_EQ(doubtful.groups.size(), 1u);
  EXPECT_EQ(doubtful.groups[0].name, "a");
  EXPECT_EQ(onlyWarning(doubtful), "groups with more than one name have the first of them (4: a)");
  const RawGroom indexed = readTwo(property("string[] primvars:groom_group_name", "[\"x\\\\y\"]", "uniform") +
                                   "int[] primvars:groom_group_name:indices = [9, 0]\n");
  ASSERT_EQ(indexed.groups.size(), 2u);
  EXPECT_EQ(indexed.groups[0].name, "");
  EXPECT_EQ(indexed.groups[1].name, "x\\y");
  EXPECT_EQ(onlyWarning(indexed), "group names that cannot be used are left out (1 of /c)");
  const std::string endless(300, 'n');
  EXPECT_TRUE(readTwo("string groom_group_name = \"" + endless + "\"\n").groups.empty());
}

TEST(UsdaLabels, DamagedOnesAreLeftOutWithTheReason) {
  const std::pair<std::string, const char*> rows[] = {
      {property("int[] groom_id", "[1, 2, 3]", "uniform"),
       "without ids (/c: groom_id has 3 values where uniform interpolation takes 2)"},
      {property("float[] groom_id", "[1, 2.5]", "uniform"),
       "without ids (/c: groom_id has values that are no whole numbers from 0 to 4294967295)"},
      {property("int64[] groom_id", "[1, 4294967296]", "uniform"), "no whole numbers"},
      {property("int[] groom_id", "[-1, 1]", "uniform"), "no whole numbers"},
      {property("int[] primvars:groom_id", "[1, 2]", "uniform") +
           "int[] primvars:groom_id:indices = [0, 2]\n",
       "primvars:groom_id has values that are no whole numbers"},
      {property("int[] groom_group_id", "[0, 2147483648]", "uniform"),
       "without group ids (/c: groom_group_id has values that are no whole numbers from -2147483648"},
      {property("int2[] groom_guide", "[(1, 1), (0, 0)]", "uniform"),
       "guide marks (/c: groom_guide has 2 num"},
      {property("string[] groom_guide", "[\"a\", \"b\"]", "uniform"),
       "guide marks (/c: groom_guide has 0 num"},
      {property("int[] groom_group_name", "[1, 2]", "uniform"),
       "group names (/c: groom_group_name has numbers, no strings)"},
      {property("float2[] groom_color", "[(1, 1)]", "constant"),
       "colours (/c: groom_color has two numbers a value, no colour)"},
      {property("color3f[] groom_color", "[(-1, 0, 0)]", "constant"), "no value that can be used"},
  };
  for (const auto& [more, reason] : rows) {
    const RawGroom groom = readTwo(more);
    const StrandSet& s = groom.strands;
    EXPECT_TRUE(s.ids.empty() && s.is_guide.empty() && s.groups.empty() && s.colours.empty()) << more;
    EXPECT_NE(groom.report.omissionsLine().find(reason), std::string::npos) << groom.report.omissionsLine();
  }
  const RawGroom repeated = readTwo("int groom_id = 1\n");
  EXPECT_EQ(repeated.strands.ids, (Ids{1, 1}));
  EXPECT_EQ(onlyWarning(repeated), "1 of the ids repeat that of an earlier strand");
  const RawGroom marks = readTwo(property("float[] groom_guide", "[1, nan]", "uniform"));
  EXPECT_EQ(marks.strands.is_guide, (Marks{1, 0}));
  EXPECT_EQ(onlyWarning(marks), "guide marks that cannot be used are 0 (1 of /c)");
}

TEST(UsdaLabels, ThoseOfSomePrimsOnlyAreLeftOut) {
  const std::string plain = twoCurves("b", "");
  EXPECT_EQ(readLabelledPrims(twoCurves("a", "int[] groom_id = [1, 2]\n") + plain).report.omissionsLine(),
            "without ids (none for /b)");
  EXPECT_EQ(
      readLabelledPrims(twoCurves("a", "float3 groom_color = (1, 0, 0)\n") + plain).report.omissionsLine(),
      "without colours (none for /b)");
  const RawGroom damaged = readLabelledPrims(twoCurves("a", "int groom_guide = 1\n") +
                                             twoCurves("b", property("int[] groom_guide", "[1]", "uniform")));
  EXPECT_TRUE(damaged.strands.is_guide.empty());
  EXPECT_NE(damaged.report.omissionsLine().find("guide marks (/b: groom_guide has 1 values"),
            std::string::npos);
}

TEST(UsdaLabels, AreWrittenAndReadAgain) {
  const RawGroom groom = readUsda(samples::usdaLabels(), "wig");
  const RawGroom again = readUsda(encodeUsda(groom.strands, 1, "wig", groom.groups), "wig");
  EXPECT_TRUE(again.report.warnings.empty() && again.report.left_out.empty());
  EXPECT_EQ(again.strands.ids, groom.strands.ids);
  EXPECT_EQ(again.strands.is_guide, groom.strands.is_guide);
  EXPECT_EQ(again.strands.groups, groom.strands.groups);
  EXPECT_EQ(again.strands.colours, groom.strands.colours);
  ASSERT_EQ(again.groups.size(), groom.groups.size());
  for (size_t g = 0; g < groom.groups.size(); ++g) {
    EXPECT_EQ(again.groups[g].id, groom.groups[g].id);
    EXPECT_EQ(again.groups[g].name, groom.groups[g].name);
  }
  const RawGroom bare = readUsda(encodeUsda(groom.strands, 1, "wig"), "wig");
  EXPECT_EQ(bare.groups.at(2).id, 2) << "without a table the index is the id";
  using Names = std::vector<std::string>;
  const Names labels = {"guide marks", "ids", "groups", "colours"};
  StrandSet labelled = groom.strands;
  labelled.uvs.clear();
  labelled.radii.clear();
  EXPECT_EQ(omissionsOf("a.tfx", labelled), labels);
  EXPECT_EQ(omissionsOf("a.hair", labelled), labels);
  EXPECT_EQ(omissionsOf("a.usda", labelled), Names());
}

}  // namespace
}  // namespace strandcast
