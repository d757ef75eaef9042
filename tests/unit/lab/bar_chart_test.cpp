#include "deploy/lab/bar_chart.hpp"

#include <gtest/gtest.h>

#include <regex>

using namespace kervan::lab;

namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// The widths of the bars, from top to bottom.
std::vector<double> widths(const std::string& svg) {
  const std::regex bar("width=\"([0-9.]+)\" height=\"13.0\"");
  std::vector<double> widths;
  for (auto match = std::sregex_iterator(svg.begin(), svg.end(), bar); match != std::sregex_iterator(); ++match)
    widths.push_back(std::stod((*match)[1]));
  return widths;
}

TEST(BarChart, HasBarsAsLongAsTheirValues) {
  const auto svg = to_svg({.title = "t",
                           .series = {""},
                           .groups = {{"a", {Estimate{2.0, 1.0, 3.0, 5}}}, {"b", {Estimate{4.0, 4.0, 4.0, 1}}}}});
  const auto lengths = widths(svg);
  ASSERT_EQ(lengths.size(), 2u);
  EXPECT_NEAR(lengths[1], 2.0 * lengths[0], 0.2);
  EXPECT_EQ(count(svg, "stroke-width=\"1.3\""), 1u) << "only one of them has an interval";
}

TEST(BarChart, ShowsThatNothingIsKnown) {
  const auto svg = to_svg({.title = "t", .series = {"x", "y"}, .groups = {{"a", {std::nullopt, std::nullopt}}}});
  EXPECT_TRUE(widths(svg).empty());
  EXPECT_EQ(count(svg, ">-</text>"), 2u);
}

TEST(BarChart, ReachesToBothSidesOfZero) {
  const auto svg = to_svg({.title = "t",
                           .series = {""},
                           .groups = {{"a", {Estimate{-1.0, -2.0, 0.0, 5}}}, {"b", {Estimate{1.0, 0.0, 2.0, 5}}}}});
  const auto lengths = widths(svg);
  ASSERT_EQ(lengths.size(), 2u);
  EXPECT_NEAR(lengths[0], lengths[1], 0.2);
}

TEST(BarChart, EscapesWhatPeopleWrite) {
  const auto svg = to_svg({.title = "<t> & co", .series = {""}, .groups = {}});
  EXPECT_NE(svg.find("&lt;t&gt; &amp; co"), std::string::npos);
}

}  // namespace
