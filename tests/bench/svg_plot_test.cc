#include "bench/plots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace strandcast {
namespace {

size_t count(const std::string& text, const std::string& what) {
  size_t found = 0;
  for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

TEST(SvgPlot, APointOfAnyDecadeLiesInItsPanelAndLogarithmically) {
  const PlotSeries series{"s", "red", {{0.01, 3, ""}, {1, 3, ""}, {100, 3, ""}}};
  const std::string svg = logLogPlot("x", "y", "", {{"panel", {series}}});
  const size_t at = svg.find("<polyline points=\"");
  ASSERT_NE(at, std::string::npos);
  double x[3], y[3];
  ASSERT_EQ(std::sscanf(svg.c_str() + at, "<polyline points=\"%lf,%lf %lf,%lf %lf,%lf", &x[0], &y[0], &x[1],
                        &y[1], &x[2], &y[2]),
            6);
  EXPECT_NEAR(x[1] - x[0], x[2] - x[1], 0.11);
  EXPECT_GT(x[1] - x[0], 50);
  EXPECT_EQ(y[0], y[2]);
  double left = 0, top = 0, width = 0, height = 0;
  const size_t box = svg.find("<rect x=");
  ASSERT_NE(box, std::string::npos);
  ASSERT_EQ(std::sscanf(svg.c_str() + box, "<rect x=\"%lf\" y=\"%lf\" width=\"%lf\" height=\"%lf\"", &left,
                        &top, &width, &height),
            4);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(x[i] > left && x[i] < left + width) << x[i];
    EXPECT_TRUE(y[i] > top && y[i] < top + height) << y[i];
  }
}

TEST(SvgPlot, WhatHasNoLogarithmIsLeftOut) {
  const PlotSeries series{"s", "red", {{0, 1, "a"}, {1, -1, "b"}, {NAN, 1, "c"}, {1, 1, "d"}}};
  const std::string svg = logLogPlot("x", "y", "", {{"panel", {series}}});
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_EQ(count(svg, "<circle"), 2u) << "one point and its entry in the legend";
  EXPECT_NE(svg.find(">d</text>"), std::string::npos);
  EXPECT_EQ(svg.find(">a</text>"), std::string::npos);
}

TEST(SvgPlot, LabelsAreEscapedAndASeriesOfTwoPanelsHasOneEntry) {
  const PlotSeries series{"a<b & \"c\"", "red", {{1, 1, ""}}};
  const std::string svg = logLogPlot("x", "y", "1 > 0", {{"left", {series}}, {"right", {series}}});
  EXPECT_EQ(count(svg, "a&lt;b &amp; &quot;c&quot;"), 1u);
  EXPECT_NE(svg.find("1 &gt; 0"), std::string::npos);
  EXPECT_EQ(count(svg, "<svg"), 1u);
  EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
}

TEST(SvgPlot, NothingToDrawIsStillAPlot) {
  const std::string svg = logLogPlot("x", "y", "", {});
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
}

}  // namespace
}  // namespace strandcast
