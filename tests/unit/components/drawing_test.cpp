#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "components/observe/decimal.hpp"
#include "components/observe/map_drawing.hpp"
#include "components/observe/svg_writer.hpp"
#include "components/observe/trajectory_csv.hpp"

namespace kervan::observe {
namespace {

using geometry::Vector2;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

MapDrawing small_run() {
  MapDrawing drawing;
  drawing.title = "lab";
  drawing.result = "failed";
  drawing.world.walls = {{{-1.5, -1.5}, {32.0, -1.5}}, {{32.0, -1.5}, {32.0, 17.5}}};
  drawing.world.circles = {{{8.2, 6.59}, 0.3}};
  drawing.nodes = {{0.0, 0.0}, {4.0, 3.0}, {20.0, 3.0}};
  DrawnRobot robot;
  robot.name = "r1";
  robot.route = {{0.0, 0.0}, {4.0, 3.0}};
  robot.truth = {{0.0, 0.0}, {2.0, 1.6}, {3.8, 3.0}};
  robot.odometry = {{0.0, 0.0}, {3.9, 3.0}};
  robot.goal = Vector2(4.0, 3.0);
  robot.closest = Vector2(3.8, 3.0);
  robot.figures = {{"error", "0.200 m"}};
  drawing.robots = {robot};
  return drawing;
}

TEST(MapDrawing, HasAViewBoxInMetresAroundTheWorld) {
  const std::string svg = to_svg(small_run());
  double x = 0, y = 0, width = 0, height = 0;
  const auto at = svg.find("viewBox=\"");
  ASSERT_NE(at, std::string::npos);
  ASSERT_EQ(std::sscanf(svg.c_str() + at, "viewBox=\"%lf %lf %lf %lf\"", &x, &y, &width, &height), 4);
  EXPECT_LT(x, -1.5);
  EXPECT_LT(y, -17.5);
  EXPECT_GT(x + width, 32.0);
  EXPECT_GT(y + height, 1.5);
  EXPECT_LT(width, 40.0);
}

TEST(MapDrawing, TurnsYAroundSoThatLeftIsUp) {
  EXPECT_TRUE(has(to_svg(small_run()), "M32.0000,1.5000 L32.0000,-17.5000"));
}

TEST(MapDrawing, ShowsTheResultTheFiguresAndTheWaypointsNumbers) {
  const std::string svg = to_svg(small_run());
  EXPECT_TRUE(has(svg, ">lab</tspan>"));
  EXPECT_TRUE(has(svg, ">failed</tspan>"));
  EXPECT_TRUE(has(svg, ">did not reach the goal</tspan>"));
  EXPECT_TRUE(has(svg, ">0.200 m</text>"));
  for (const char* number : {">0</text>", ">1</text>", ">2</text>"}) EXPECT_TRUE(has(svg, number)) << number;
  EXPECT_TRUE(has(svg, ">goal of r1</text>"));
}

TEST(MapDrawing, ExplainsTheSignsItHasAndNoOthers) {
  MapDrawing drawing = small_run();
  for (const char* sign :
       {">driven, truth<", ">driven, by odometry<", ">planned route<", ">goal<", ">closest approach<"})
    EXPECT_TRUE(has(to_svg(drawing), sign)) << sign;
  EXPECT_FALSE(has(to_svg(drawing), ">contact<"));

  DrawnRobot& robot = drawing.robots[0];
  robot.contacts = {{1.0, 1.0}};
  robot.goal.reset();
  robot.closest.reset();
  robot.route.clear();
  const std::string svg = to_svg(drawing);
  EXPECT_TRUE(has(svg, ">contact<"));
  for (const char* sign : {">goal<", ">tolerance<", ">closest approach<", ">planned route<"})
    EXPECT_FALSE(has(svg, sign)) << sign;
}

TEST(MapDrawing, EscapesWhatPeopleWrite) {
  MapDrawing drawing = small_run();
  drawing.title = "a<b & \"c\"";
  EXPECT_TRUE(has(to_svg(drawing), "a&lt;b &amp; &quot;c&quot;"));
}

TEST(MapDrawing, NeverWritesANumberThatIsNotFinite) {
  MapDrawing drawing = small_run();
  drawing.robots[0].truth.insert(drawing.robots[0].truth.begin() + 1, Vector2(nan, nan));
  drawing.robots[0].contacts.emplace_back(nan, 0.0);
  drawing.robots[0].closest = Vector2(nan, nan);
  drawing.world.circles.push_back({{nan, nan}, 1.0});
  const std::string svg = to_svg(drawing);
  EXPECT_FALSE(has(svg, "nan"));
  EXPECT_FALSE(has(svg, "inf"));
  EXPECT_FALSE(has(svg, "=\",")) << "an empty number";
}

TEST(MapDrawing, IsAValidPictureOfNothing) {
  const std::string svg = to_svg({});
  EXPECT_TRUE(has(svg, "<svg "));
  EXPECT_TRUE(has(svg, "</svg>"));
  EXPECT_FALSE(has(svg, "inf"));
}

TEST(MapDrawing, IsTheSameForTheSameRun) { EXPECT_EQ(to_svg(small_run()), to_svg(small_run())); }

TEST(MapDrawing, ShowsWhatTheSensorsSawWithTheTimeBesideIt) {
  MapDrawing drawing = small_run();
  EXPECT_FALSE(has(to_svg(drawing), "seen by its sensors"));
  drawing.robots[0].snapshots = {{0.0, {1.0, 1.0, 0.0}, {{{1.0, 1.0}, {3.0, 1.5}, {3.0, 0.5}}}},
                                 {2.5, {2.0, 1.0, 0.0}, {{{2.0, 1.0}, {nan, 1.5}}}}};
  const std::string svg = to_svg(drawing);
  EXPECT_TRUE(has(svg, ">0 s</text>"));
  EXPECT_TRUE(has(svg, ">2.5 s</text>"));
  EXPECT_TRUE(
      has(svg, "points=\"1.0000,-1.0000 3.0000,-1.5000 3.0000,-0.5000 \" fill=\"#1769aa\" fill-opacity=\"0.1\""));
  EXPECT_TRUE(has(svg, "seen by its sensors"));
  EXPECT_FALSE(has(svg, "nan"));
}

TEST(MapDrawing, WithoutRobotsIsAPictureOfTheWorldWithoutALegend) {
  MapDrawing drawing = small_run();
  drawing.robots.clear();
  const std::string svg = to_svg(drawing);
  EXPECT_TRUE(has(svg, "M32.0000,1.5000 L32.0000,-17.5000"));
  EXPECT_FALSE(has(svg, "driven"));
}

TEST(MapDrawing, ShowsTheKnownPartOfAMapUnderTheOutlineOfTheTruth) {
  MapDrawing drawing = small_run();
  EXPECT_FALSE(has(to_svg(drawing), "<image"));
  EXPECT_FALSE(has(to_svg(drawing), ">the map: occupied</text>"));
  drawing.map.emplace(0.05, std::int8_t{-1}, std::size_t{1} << 20);
  EXPECT_FALSE(has(to_svg(drawing), "<image")) << "nothing is known";
  drawing.map->cover({0, 0, 64, 64});
  *drawing.map->place({20, 10}) = 100;
  *drawing.map->place({39, 19}) = 0;
  const std::string svg = to_svg(drawing);
  EXPECT_TRUE(has(svg, "<image x=\"1.0000\" y=\"-1.0000\" width=\"1.0000\" height=\"0.5000\"")) << svg;
  EXPECT_TRUE(has(svg, "href=\"data:image/png;base64,iVBORw0KGgo")) << "as every PNG begins";
  EXPECT_TRUE(has(svg, ">the map: occupied</text>"));
  EXPECT_TRUE(has(svg, "r=\"0.3000\" fill=\"none\" stroke=\"#e0342b\"")) << "the world's circle";
  EXPECT_LT(svg.find("<image"), svg.find("#e0342b"));
}

TEST(MapDrawing, GrowsWithItsMap) {
  MapDrawing drawing = small_run();
  drawing.map.emplace(0.5, std::int8_t{-1}, std::size_t{1} << 20);
  drawing.map->cover({-64, -64, 64, 64});
  *drawing.map->place({-40, -40}) = 0;
  EXPECT_TRUE(has(to_svg(drawing), ">-20</text>")) << "a line of the scale";
}

TEST(Snapshot, AConeReachesFromTheTransducerToTheArcOfItsRange) {
  const double fov = 0.5;
  const Polyline area = cone({1.0, 2.0, std::numbers::pi / 2.0}, fov, 3.0);
  ASSERT_GE(area.size(), 3u);
  EXPECT_EQ(area.front(), Vector2(1.0, 2.0));
  for (std::size_t i = 1; i < area.size(); ++i) EXPECT_NEAR((area[i] - area[0]).norm(), 3.0, 1e-12);
  EXPECT_NEAR(area[1].x(), 1.0 + 3.0 * std::sin(0.25), 1e-12) << "from the right, seen along its axis,";
  EXPECT_NEAR(area.back().x(), 1.0 - 3.0 * std::sin(0.25), 1e-12) << "to the left";
  for (const double silent : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()})
    EXPECT_TRUE(cone({}, fov, silent).empty()) << silent;
}

TEST(Snapshot, ASweepIsBrokenWhereABeamMetNothing) {
  constexpr float none = std::numeric_limits<float>::infinity();
  const std::vector<float> ranges{2.0f, 2.0f, none, 1.0f, 1.0f, 1.0f, -none, 3.0f};
  const auto areas = sweep({1.0, 0.0, 0.0}, -0.2, 0.1, ranges);
  ASSERT_EQ(areas.size(), 2u) << "one beam alone is no area";
  ASSERT_EQ(areas[0].size(), 3u);
  EXPECT_EQ(areas[0][0], Vector2(1.0, 0.0));
  EXPECT_NEAR(areas[0][1].y(), 2.0 * std::sin(-0.2), 1e-12);
  EXPECT_NEAR(areas[1][1].y(), std::sin(0.1), 1e-12);
  EXPECT_TRUE(sweep({}, 0.0, 0.1, {}).empty());
}

TEST(Snapshot, ABodyIsMovedBackAlongItsArc) {
  const auto straight = moved_back({5.0, 1.0, 0.0}, {0.5, 0.0}, 2.0);
  EXPECT_NEAR(straight.x, 4.0, 1e-12);
  EXPECT_NEAR(straight.y, 1.0, 1e-12);
  // A quarter of a circle of radius 1 around (0, 1), from (0, 0).
  const auto curved = moved_back({1.0, 1.0, std::numbers::pi / 2.0}, {1.0, 1.0}, std::numbers::pi / 2.0);
  EXPECT_NEAR(curved.x, 0.0, 1e-12);
  EXPECT_NEAR(curved.y, 0.0, 1e-12);
  EXPECT_NEAR(curved.yaw, 0.0, 1e-12);
}

TEST(Simplified, KeepsCornersAndDropsWhatLiesOnALine) {
  const Polyline line{{0, 0}, {1, 0.001}, {2, 0}, {2, 1}, {2, 2}};
  EXPECT_EQ(simplified(line, 0.01), (Polyline{{0, 0}, {2, 0}, {2, 2}}));
}

TEST(Simplified, MovesNoPointFartherThanTheTolerance) {
  Polyline circle;
  for (int i = 0; i <= 1000; ++i) circle.emplace_back(std::cos(0.00628 * i), std::sin(0.00628 * i));
  const Polyline few = simplified(circle, 0.01);
  EXPECT_LT(few.size(), 40u);
  for (std::size_t i = 1; i < few.size(); ++i)
    EXPECT_GE(((few[i - 1] + few[i]) / 2.0).norm(), 1.0 - 0.0101) << "a chord's middle is farthest from the circle";
}

TEST(Simplified, KeepsARobotThatStandsStillOrReturns) {
  EXPECT_EQ(simplified(Polyline(100, Vector2(1, 1)), 0.01).size(), 2u);
  EXPECT_EQ(simplified({{0, 0}, {5, 0}, {0, 0}}, 0.01).size(), 3u);
  EXPECT_TRUE(simplified({}, 0.01).empty());
}

TEST(TrajectoryCsv, WritesOneRowARobotAndInstant) {
  const TrajectoryRow row{1.25, "r1", {1.0, -2.5, 0.5}, geometry::Pose2{1.01, -2.49, 0.51}, {0.5, -0.1}};
  EXPECT_EQ(to_csv(row), "1.250,r1,1.0000,-2.5000,0.50000,1.0100,-2.4900,0.51000,0.5000,-0.10000");
}

TEST(TrajectoryCsv, LeavesUnknownFieldsEmpty) {
  const TrajectoryRow row{0.0, "r1", {0.0, nan, 0.0}, std::nullopt, {-0.00001, 0.0}};
  EXPECT_EQ(to_csv(row), "0.000,r1,0.0000,,0.00000,,,,0.0000,0.00000");
}

TEST(TrajectoryCsv, HasAsManyColumnsAsItsHeader) {
  const auto commas = [](std::string_view text) { return std::count(text.begin(), text.end(), ','); };
  EXPECT_EQ(commas(to_csv({})), commas(trajectory_header));
}

TEST(Decimal, IsFixedAndHasNoNegativeZero) {
  EXPECT_EQ(decimal(-0.0004, 3), "0.000");
  EXPECT_EQ(decimal(-0.0006, 3), "-0.001");
  EXPECT_EQ(decimal(1234.5, 0), "1234");
  EXPECT_EQ(decimal(1e300, 2), "");
}

}  // namespace
}  // namespace kervan::observe
