// Wavefront OBJ as written by various programs: line ends, blanks, numbers, edges in any order.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <utility>

#include "io/groom_file.h"
#include "io/mesh_file.h"
#include "io/obj_strands.h"
#include "tests/expect_error.h"
#include "tests/io/sample_files.h"

namespace strandcast {
namespace {

using samples::fromText;
using Strands = std::vector<std::vector<uint32_t>>;

TriangleMesh meshOf(const std::string& text) { return readObjMesh(fromText(text), "body.obj").mesh; }
RawGroom groomOf(const std::string& text) { return readObjStrands(fromText(text), "wig.obj"); }

std::string replacedAll(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

bool mentions(const std::vector<std::string>& lines, const std::string& part) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

const std::string kBody =
    "# a body\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\ng\no\nf 1//2 2//2 \\\n3//2 4//2\nf -5 -4 -1\nl 1 "
    "2\n";

TEST(ObjText, EveryLineEndGivesTheSameBody) {
  const TriangleMesh plain = meshOf(kBody);
  ASSERT_EQ(plain.triangles.size(), 3u);
  std::string mixed;
  int line = 0;
  for (const char c : kBody)
    mixed += c != '\n' ? std::string(1, c) : std::array{"\n", "\r", "\r\n", "\r\r\n"}[line++ % 4];
  for (const std::string& text :
       {replacedAll(kBody, "\n", "\r"), replacedAll(kBody, "\n", "\r\n"), replacedAll(kBody, "\n", "\r\r\n"),
        mixed, "\xEF\xBB\xBF" + kBody, kBody + std::string(3, '\0'), kBody.substr(0, kBody.rfind('\n')),
        replacedAll(kBody, " ", "\t"), replacedAll(kBody, " ", " \v \f"),
        replacedAll(kBody, "\n", " \n \t")}) {
    const TriangleMesh mesh = meshOf(text);
    EXPECT_EQ(mesh.positions, plain.positions) << text;
    EXPECT_EQ(mesh.triangles, plain.triangles) << text;
  }
}

TEST(ObjText, EveryLineEndGivesTheSameStrands) {
  const std::string hair =
      "v 0 0 0\nv 0 1 0 1 0 0\nvp 1 2\nv 0 2 0 1\nv 0 3 0\nl 1/2 2/3 \\\n -2\nl 4 3 # end\n";
  const StrandSet plain = groomOf(hair).strands;
  EXPECT_EQ(plain.offsets, (std::vector<uint32_t>{0, 3, 5}));
  for (const char* end : {"\r", "\r\n", "\r\r\n"}) {
    const StrandSet strands = groomOf(replacedAll(hair, "\n", end)).strands;
    EXPECT_EQ(strands.positions, plain.positions);
    EXPECT_EQ(strands.offsets, plain.offsets);
  }
}

TEST(ObjText, LinesAreCountedWhateverEndsThem) {
  for (const char* end : {"\n", "\r", "\r\n", "\r\r\n"})
    expectError([&] { meshOf(replacedAll("v 0 0 0\n\nv 1 0 zero\n", "\n", end)); },
                {"body.obj, line 3", "'zero'"});
}

TEST(ObjText, WideTextIsRefusedAsSuch) {
  std::string wide = "\xff\xfe";
  for (const char c : kBody) wide += {c, '\0'};
  const std::pair<std::string, const char*> kTexts[] = {
      {wide, "iconv -f UTF-16 -t UTF-8"},
      {wide.substr(2), "iconv -f UTF-16LE -t UTF-8"},
      {wide.substr(3, 100), "iconv -f UTF-16BE -t UTF-8"},
      {std::string("\xfe\xff\0v", 4), "iconv -f UTF-16 -t UTF-8"}};
  for (const auto& [text, remedy] : kTexts) {
    expectError([&] { meshOf(text); }, {"body.obj", "UTF-16", remedy});
    expectError([&] { groomOf(text); }, {"wig.obj", "UTF-16", remedy});
  }
}

TEST(ObjText, ACommaInANumberIsNamed) {
  expectError([] { meshOf("v 0,5 0,5 0\n"); }, {"'0,5'", "points in numbers, not commas"});
}

TEST(ObjMesh, ConcaveFacesHaveTheirOwnAreaFromEveryCorner) {
  const std::string outline =
      "v 3 3 0\nv 2 3 0\nv 2 -2 0\nv -2 -2 0\nv -2 3 0\nv -3 3 0\nv -3 -3 0\nv 3 -3 0\n";
  for (int first = 0; first < 8; ++first) {
    std::string face = "f";
    for (int i = 0; i < 8; ++i) face += ' ' + std::to_string((first + i) % 8 + 1);
    const TriangleMesh mesh = meshOf(outline + face + '\n');
    double area = 0;
    for (const auto& t : mesh.triangles) {
      const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
      area += static_cast<double>((b - a).cross(c - a).z()) / 2;
    }
    EXPECT_NEAR(area, 16, 1e-5) << first;
    for (const Vec3& normal : mesh.normals) EXPECT_NEAR(normal.z(), 1, 1e-5) << first;
  }
}

TEST(ObjMesh, OddElementsAreLeftOutAndCounted) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  for (const char* bad : {"nan", "-nan(ind)", "inf", "1.#QNAN", "-1.#IND00", "1e400", "1e39"}) {
    const ReadMesh read =
        readObjMesh(fromText(square + "v 0 " + bad +
                             " 1\nf 1 2 3 4\nf 1 2 5\nf 1 2\nf 3 3 4\np 1\nl 1 2\ncurv 0 1 1 2\n"),
                    "body.obj");
    EXPECT_EQ(read.mesh.triangles.size(), 2u) << bad;
    EXPECT_EQ(read.report.left_out, (std::vector<std::string>{"1 face with a position that is not finite",
                                                              "2 faces of fewer than three different corners",
                                                              "1 polyline (l)", "1 statement of points (p)",
                                                              "1 free-form shape (curv, curv2, surf)"}))
        << bad;
  }
  const ReadMesh skipped = readObjMesh(samples::objMesh(), "body.obj", {"helper-", "joint-"});
  EXPECT_EQ(skipped.report.left_out,
            (std::vector<std::string>{"1 face of groups whose names begin with helper- or joint-"}));
  const ReadMesh crossed = readObjMesh(fromText(square + "f 1 2 3 4\nf 1 3 2 4\n"), "body.obj");
  EXPECT_TRUE(mentions(crossed.report.warnings, "1 face has no area or crosses itself, the first in line 6"));
}

/// Joins edges, given by 1-based vertex indices as in a file, into strands.
Strands joined(const Strands& lines, FileReport* told = nullptr) {
  Polylines read;
  uint32_t most = 0;
  for (const auto& line : lines) {
    for (const uint32_t v : line) {
      read.corners.push_back(v - 1);
      most = std::max(most, v);
    }
    read.end();
  }
  FileReport report;
  const Polylines out = joinedPolylines(read, most, report);
  Strands strands;
  for (size_t s = 0; s < out.size(); ++s) {
    std::vector<uint32_t>& strand = strands.emplace_back();
    for (const uint32_t v : out.at(s)) strand.push_back(v + 1);
  }
  if (told != nullptr) *told = report;
  return strands;
}

TEST(ObjEdges, AnyOrderAndDirectionGivesTheStrandsOfTheOrderedFile) {
  Strands strands, edges;
  for (uint32_t s = 0; s < 6; ++s) {
    std::vector<uint32_t>& strand = strands.emplace_back();
    for (uint32_t i = 0; i < 3 + s; ++i) strand.push_back(10 * s + i + 1);
    for (size_t i = 1; i < strand.size(); ++i) edges.push_back({strand[i - 1], strand[i]});
  }
  EXPECT_EQ(joined(edges), strands);
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    Strands mixed = edges;
    std::shuffle(mixed.begin(), mixed.end(), random);
    for (auto& edge : mixed)
      if (random() % 2 == 0) std::reverse(edge.begin(), edge.end());
    FileReport report;
    Strands found = joined(mixed, &report);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, strands) << round;
    EXPECT_TRUE(report.left_out.empty() && report.warnings.empty());
  }
}

TEST(ObjEdges, OrderedFilesComeOutAsTheyAreWritten) {
  EXPECT_EQ(joined({{4, 3}, {3, 2}, {2, 1}}), (Strands{{4, 3, 2, 1}})) << "the walk begins at the root";
  EXPECT_EQ(joined({{1, 2}, {2, 3}, {1, 4}, {4, 5}, {1, 6}, {6, 7}}),
            (Strands{{1, 2, 3}, {1, 4, 5}, {1, 6, 7}}))
      << "one root of three";
  EXPECT_EQ(joined({{1, 2}, {2, 3}, {3, 4}, {2, 5}, {5, 6}}), (Strands{{1, 2, 3, 4}, {2, 5, 6}}));
  EXPECT_EQ(joined({{1, 2, 3}, {1, 4, 5}, {5, 6}, {7}, {3, 2, 8}}),
            (Strands{{1, 2, 3}, {1, 4, 5, 6}, {7}, {3, 2, 8}}))
      << "whole polylines are strands";
}

TEST(ObjEdges, EdgesWrittenTipFirstMeetInReverse) {
  EXPECT_EQ(joined({{2, 1}, {3, 2}, {4, 3}, {6, 5}, {7, 6}}), (Strands{{1, 2, 3, 4}, {5, 6, 7}}));
  EXPECT_EQ(joined({{1, 2}, {5, 6}, {2, 3}, {6, 7}, {3, 4}}), (Strands{{1, 2, 3, 4}, {5, 6, 7}}));
  EXPECT_EQ(joined({{1, 2}, {3, 2}, {3, 4}}), (Strands{{1, 2, 3, 4}}));
}

TEST(ObjEdges, ForksRingsAndRepeatedEdgesAreReported) {
  FileReport report;
  EXPECT_EQ(joined({{2, 3}, {1, 2}, {2, 4}}, &report), (Strands{{2, 3}, {1, 2}, {2, 4}}));
  EXPECT_TRUE(mentions(report.warnings, "at 1 vertex more than two edges meet"));
  EXPECT_EQ(joined({{3, 4}, {1, 2}, {4, 1}, {2, 3}}, &report), (Strands{{1, 2, 3, 4, 1}}));
  EXPECT_TRUE(mentions(report.warnings, "1 ring of edges"));
  EXPECT_EQ(joined({{2, 3}, {1, 2}, {2, 1}, {3, 3}}, &report), (Strands{{1, 2, 3}}));
  EXPECT_EQ(report.left_out,
            (std::vector<std::string>{"1 edge from a vertex to itself", "1 edge written again"}));
}

TEST(ObjStrands, FacesOfTwoCornersAreEdgesWhereThereIsNoPolyline) {
  const std::string vertices = "v 0 0 0\nv 0 1 0\nv 0 2 0\nv 1 2 0\n";
  const RawGroom groom = groomOf(vertices + "f 3 2\nf 1 2\nf 1 2 4\n");
  EXPECT_EQ(groom.strands.positions, (std::vector<Vec3>{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}));
  EXPECT_TRUE(mentions(groom.report.warnings, "2 faces (f) of two corners are read as edges"));
  EXPECT_EQ(groom.report.left_out, (std::vector<std::string>{"1 face (f)"}));
  EXPECT_EQ(groomOf(vertices + "l 3 2\nf 1 2\n").strands.vertices(), 2u);
}

TEST(ObjStrands, AStrandThatIsNotFiniteIsLeftOutAndCounted) {
  const RawGroom groom =
      groomOf("v 0 0 0\nv 0 nan 0\nv 0 2 0\nv 1 0 0 1 1 1\nv 1 1 0\nl 1 2 3\nl 4 5\nl\np 1\n");
  EXPECT_EQ(groom.strands.positions, (std::vector<Vec3>{{1, 0, 0}, {1, 1, 0}}));
  EXPECT_EQ(groom.report.left_out, (std::vector<std::string>{"1 strand with a position that is not finite",
                                                             "1 polyline without vertices",
                                                             "1 statement of points (p)", "vertex colours"}));
  expectError([] { groomOf("v 0 0 0\nv 0 nan 0\nl 1 2\n"); }, {"wig.obj, line 3", "finite"});
}

TEST(ObjStrands, EdgesFromAVertexToItselfAreNoStrands) {
  EXPECT_EQ(groomOf("v 0 0 0\nv 0 1 0\nl 2 2\nl 1 2\n").strands.strands(), 1u);
  expectError([] { groomOf("v 0 0 0\nv 0 1 0\nl 2 2\nl 1 1\n"); }, {"wig.obj, line 3", "to itself"});
}

TEST(ObjText, KeywordsAreReadInAnyCaseAndUnknownOnesAreCounted) {
  const RawGroom groom = groomOf("V 0 0 0\nV 0 1 0\nL 1 2\nfoo 1\nbar\nusemtl skin\n");
  EXPECT_EQ(groom.strands.vertices(), 2u);
  EXPECT_EQ(groom.report.left_out, (std::vector<std::string>{"2 statements that the format does not have"}));
}

TEST(ObjEdges, ARingIsReportedAndOpenedAlikeInAnyOrder) {
  for (const Strands& edges :
       {Strands{{1, 2}, {2, 3}, {3, 4}, {4, 1}}, Strands{{3, 4}, {4, 1}, {1, 2}, {2, 3}},
        Strands{{2, 1}, {1, 4}, {4, 3}, {3, 2}}, Strands{{3, 4}, {1, 2}, {4, 1}, {2, 3}},
        Strands{{1, 4}, {3, 2}, {4, 3}, {1, 2}}}) {
    FileReport report;
    EXPECT_EQ(joined(edges, &report), (Strands{{1, 2, 3, 4, 1}}));
    EXPECT_EQ(report.warnings,
              (std::vector<std::string>{"1 ring of edges is opened at the lowest vertex index"}));
  }
  FileReport report;
  EXPECT_EQ(joined({{7, 8}, {8, 9}, {2, 3}, {3, 1}, {1, 2}, {5, 4}, {4, 6}, {6, 5}}, &report),
            (Strands{{7, 8, 9}, {1, 2, 3, 1}, {4, 5, 6, 4}}))
      << "strands beside them are as they are written";
  EXPECT_TRUE(mentions(report.warnings, "2 rings of edges are opened"));
}

TEST(ObjEdges, ClosedPolylinesAndStrandsThatCrossThemselvesAreReported) {
  FileReport report;
  EXPECT_EQ(joined({{3, 1, 2, 3}, {4, 5, 6}}, &report), (Strands{{3, 1, 2, 3}, {4, 5, 6}}));
  EXPECT_TRUE(mentions(report.warnings, "1 polyline is closed"));
  EXPECT_EQ(joined({{1, 2}, {2, 3}, {3, 1}, {1, 4}}, &report), (Strands{{1, 2, 3, 1, 4}}));
  EXPECT_TRUE(mentions(report.warnings, "1 strand of edges goes through a vertex again"));
  EXPECT_EQ(joined({{1, 2}, {2, 2}, {2, 3}}, &report), (Strands{{1, 2, 2, 3}}));
  EXPECT_TRUE(report.warnings.empty());
}

TEST(ObjStrands, FreeFormCurvesAloneGetAdviceThatFits) {
  const std::string vertices = "v 0 0 0\nv 0 1 0\nv 0 2 0\n";
  for (const char* shape : {"cstype bspline\ndeg 2\ncurv 0 1 1 2 3\nparm u 0 0 0 1 1 1\nend\n",
                            "vp 0 0\nvp 1 1\ncurv2 1 2\n", "surf 0 1 0 1 1 2 3\n"}) {
    expectError([&] { groomOf(vertices + shape); },
                {"free-form shapes (curv, curv2, surf), which are not read", "to polylines"});
    expectError([&] { meshOf(vertices + shape); }, {"free-form shapes", "to polygons"});
  }
  expectError([&] { groomOf(vertices + "f 1 2 3\n"); }, {"no polylines (l)", "not as a mesh"});
  expectError([&] { groomOf(vertices + "p 1 2 3\n"); }, {"no polylines (l)", "export the hair as polylines"});
}

}  // namespace
}  // namespace strandcast
