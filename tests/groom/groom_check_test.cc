// Checks of grooms that are damaged on purpose, one kind of damage at a time.
#include "groom/groom_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "groom/groom_operations.h"

namespace strandcast {
namespace {

constexpr size_t kStrands = 40, kVertices = 9;

/// A lawn of slightly leaning strands, 0.2 m long, on a floor of 8 x 5 roots.
StrandSet lawn() {
  StrandSet strands;
  for (size_t s = 0; s < kStrands; ++s) {
    std::vector<Vec3> points;
    for (size_t i = 0; i < kVertices; ++i) {
      const float up = 0.2f * static_cast<float>(i) / static_cast<float>(kVertices - 1);
      points.emplace_back(0.01f * static_cast<float>(s % 8) + 0.1f * up * up, up,
                          0.01f * static_cast<float>(s / 8));
    }
    strands.append(points);
  }
  return strands;
}

/// Cleans and checks. Strands with numbers that are not finite are checked alone: readers leave them out.
CheckReport checked(const StrandSet& as_read, std::span<const std::string> names = {}, float unit = 1) {
  Groom groom;
  groom.report.unit_meters = unit;
  for (size_t s = 0; s < as_read.strands(); ++s) {
    const std::span<const Vec3> points = as_read.strand(s);
    bool finite = true;
    for (const Vec3& p : points) finite &= p.allFinite();
    if (finite) groom.strands.append(points);
  }
  cleanStrands(groom);
  return checkGroom(as_read, groom, names);
}

void expectRow(const CheckReport& report, const std::string& key, CheckSeverity severity, double number) {
  const CheckResult* row = report.find(key);
  ASSERT_NE(row, nullptr) << key;
  EXPECT_EQ(row->severity, severity) << row->what;
  EXPECT_EQ(row->number, number) << row->what;
  EXPECT_EQ(row->remedy.empty(), severity == CheckSeverity::kOk) << row->what;
}

TEST(CheckGroom, AGoodGroomIsReady) {
  const CheckReport report = checked(lawn());
  EXPECT_EQ(report.worst(), CheckSeverity::kOk);
  EXPECT_STREQ(verdictOf(report.worst()), "ready");
  EXPECT_TRUE(report.marks.empty());
  for (const char* key : {"groom_size", "hair_length", "not_finite", "single_vertex", "zero_edges",
                          "dropped_strands", "merged_vertices", "resampled_strands", "reversed_strands",
                          "duplicate_strands", "folds", "uneven_edges"})
    EXPECT_NE(report.find(key), nullptr) << key;
  for (const CheckResult& row : report.results)
    EXPECT_TRUE(row.remedy.empty() && row.where.empty()) << row.what;
}

TEST(CheckGroom, NumbersThatAreNotFiniteAreAFault) {
  StrandSet strands = lawn();
  strands.strand(7)[3].x() = std::numeric_limits<float>::quiet_NaN();
  strands.strand(7)[4].y() = std::numeric_limits<float>::infinity();
  const CheckReport report = checked(strands);
  expectRow(report, "not_finite", CheckSeverity::kFault, 2);
  EXPECT_EQ(report.find("not_finite")->where, "strand 7");
  EXPECT_STREQ(verdictOf(report.worst()), "not ready");
}

TEST(CheckGroom, StrandsOfOneVertexAreNamedByTheirPart) {
  StrandSet strands = lawn();
  strands.append(std::vector<Vec3>{Vec3(0.5f, 0, 0)});
  strands.parts.assign(strands.strands(), 0);
  for (size_t s = kStrands - 2; s < strands.strands(); ++s) strands.parts[s] = 1;
  const std::vector<std::string> names{"front", "back"};
  const CheckReport report = checked(strands, names);
  expectRow(report, "single_vertex", CheckSeverity::kWarning, 1);
  EXPECT_EQ(report.find("single_vertex")->where, "strand 2 of back");
  expectRow(report, "dropped_strands", CheckSeverity::kWarning, 1);  // 2.4 % of the strands
}

TEST(CheckGroom, EdgesWithoutLengthAreCounted) {
  StrandSet strands = lawn();
  strands.strand(3)[4] = strands.strand(3)[5];
  strands.strand(9)[0] = strands.strand(9)[1];
  const CheckReport report = checked(strands);
  expectRow(report, "zero_edges", CheckSeverity::kWarning, 2);
  expectRow(report, "merged_vertices", CheckSeverity::kOk, 2);  // 0.6 % of the vertices
}

TEST(CheckGroom, StrandsOnTopOfEachOtherAreCounted) {
  StrandSet strands = lawn();
  std::vector<Vec3> copy(strands.strand(5).begin(), strands.strand(5).end());
  strands.append(copy);
  for (Vec3& p : copy) p += Vec3(3e-6f, 0, 0);
  strands.append(copy);
  for (Vec3& p : copy) p += Vec3(1e-3f, 0, 0);
  strands.append(copy);  // a millimetre beside: another hair
  const CheckReport report = checked(strands);
  expectRow(report, "duplicate_strands", CheckSeverity::kWarning, 2);
}

TEST(CheckGroom, FoldsAreMarked) {
  StrandSet strands = lawn();
  strands.strand(11)[5] = strands.strand(11)[3] + Vec3(0.004f, 0, 0);
  const CheckReport report = checked(strands);
  const CheckResult* row = report.find("folds");
  ASSERT_NE(row, nullptr);
  EXPECT_EQ(row->severity, CheckSeverity::kWarning);
  EXPECT_EQ(row->where, "strand 11");
  ASSERT_EQ(static_cast<double>(report.marks.size()), row->number);
  EXPECT_EQ(report.marks.front().kind, CheckMark::Kind::kShape);
  EXPECT_EQ(report.marks.front().position, strands.strand(11)[4]);
}

TEST(CheckGroom, VeryUnevenEdgesOfManyStrandsAreAWarning) {
  StrandSet strands = lawn();
  const auto shorten = [&](size_t s) {
    strands.strand(s)[4] = 0.8f * strands.strand(s)[3] + 0.2f * strands.strand(s)[4];
    for (size_t i = 5; i < kVertices; ++i)
      strands.strand(s)[i] += Vec3(0, 0.01f * static_cast<float>(i - 4), 0);
  };
  shorten(0);
  expectRow(checked(strands), "uneven_edges", CheckSeverity::kOk, 1);
  for (size_t s = 1; s < 10; ++s) shorten(s);
  expectRow(checked(strands), "uneven_edges", CheckSeverity::kWarning, 10);
}

TEST(CheckGroom, AWrongUnitIsAFaultWithTheUnitsThatFit) {
  StrandSet strands = lawn();
  for (Vec3& p : strands.positions) p *= 200;
  const CheckReport report = checked(strands);
  ASSERT_NE(report.find("hair_length"), nullptr);
  EXPECT_EQ(report.find("hair_length")->severity, CheckSeverity::kFault);
  EXPECT_EQ(report.find("groom_size")->severity, CheckSeverity::kFault);
  EXPECT_NE(report.find("groom_size")->remedy.find("--unit-meters"), std::string::npos);
  EXPECT_NE(report.find("groom_size")->remedy.find("0.01"), std::string::npos)
      << report.find("groom_size")->remedy;
}

TEST(CheckGroom, AFewStrandsThatAreTooLongAreAWarning) {
  StrandSet strands = lawn();
  for (size_t i = 0; i < kVertices; ++i) strands.strand(1)[i].y() *= 20;
  const CheckReport report = checked(strands);
  EXPECT_EQ(report.find("hair_length")->severity, CheckSeverity::kWarning);
}

TEST(CheckGroom, WhatReadersLeftOutAndDoubtIsListed) {
  Groom groom;
  groom.strands = lawn();
  groom.report.strands_read = kStrands;
  groom.report.unit_meters = 1;
  groom.report.left_out = {"colours", "2 invisible prims"};
  groom.report.warnings = {"the unit is guessed"};
  groom.report.reversed = 3;
  groom.report.resampled = 4;
  const CheckReport report = checkGroom(groom.strands, groom);
  expectRow(report, "reversed_strands", CheckSeverity::kWarning, 3);
  expectRow(report, "resampled_strands", CheckSeverity::kWarning, 4);
  EXPECT_EQ(report.find("left_out")->what, "read without colours");
  EXPECT_EQ(report.find("left_out")->severity, CheckSeverity::kOk);
  EXPECT_EQ(report.find("reader")->what, "the unit is guessed");
  EXPECT_EQ(report.count(CheckSeverity::kWarning), 3u);
  EXPECT_STREQ(verdictOf(report.worst()), "ready with warnings");
}

TEST(CheckGroom, AnEmptySetIsAFaultAndNoCrash) {
  EXPECT_EQ(checkGroom(StrandSet(), Groom()).worst(), CheckSeverity::kFault);
}

}  // namespace
}  // namespace strandcast
