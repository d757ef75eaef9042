#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "framework/kervan.hpp"
#include "framework/runtime/container.hpp"
#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/ArbitrationState.hpp"
#include "kervan_msgs/msg/MissionResult.hpp"
#include "kervan_msgs/msg/Outline.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/Path.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "tests/component/map_fixtures.hpp"
#include "tf2_msgs/msg/TFMessage.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;

/// Plays a run of one robot that drives 1 m along x at 1 m/s.
class Script final : public Component {
  Output<nav_msgs::msg::Odometry> truth_{this, "r1/truth", qos::state, "Truth."};
  Output<nav_msgs::msg::Odometry> odom_{this, "r1/odom", qos::sensor, "Odometry."};
  Output<nav_msgs::msg::Path> route_{this, "r1/route", qos::latched, "Route."};
  Output<geometry_msgs::msg::PoseStamped> goal_{this, "r1/goal", qos::latched, "Goal."};
  Output<kervan_msgs::msg::SonarArray> sonar_{this, "r1/sonar", qos::sensor, "Sonars."};
  Output<sensor_msgs::msg::LaserScan> scan_{this, "r1/scan", qos::sensor, "Laser."};
  Output<tf2_msgs::msg::TFMessage> tf_{this, "/tf", qos::event, "Where the laser is mounted."};
  Output<kervan_msgs::msg::Outline> world_{this, "world", qos::latched, "World."};
  Output<kervan_msgs::msg::Outline> moving_{this, "moving", qos::state, "A box that drives along."};
  Output<kervan_msgs::msg::ArbitrationState> arbitration_{this, "r1/arbitration", qos::event, "Who drives."};
  Output<kervan_msgs::msg::MissionResult> result_{this, "result", qos::latched, "Result."};
  Timer tick_{this, 50ms, &Script::on_tick};

  void on_activate(Time) override {
    kervan_msgs::msg::Outline world;
    world.segments.push_back({-1.0, -1.0, 5.0, -1.0});
    world.circles.push_back({2.0, 1.0, 0.3});
    world_.publish(world);
    goal_.publish(pose_at(1.0, 0.0));
    nav_msgs::msg::Path route;
    route.poses = {pose_at(0.0, 0.0), pose_at(1.0, 0.0)};
    route_.publish(route);
  }

  void on_tick(Time now) {
    const double x = std::min(1.0, seconds(now));
    auto truth = odometry_at({x, 0.0, 0.0}, {1.0, 0.0});
    truth.header.stamp = geometry::to_message(now);
    truth_.publish(truth);
    kervan_msgs::msg::Outline moving;
    moving.polygons.resize(1);
    for (const auto& [dx, dy] : {std::pair{0.0f, 0.0f}, {0.25f, 0.0f}, {0.25f, 0.25f}, {0.0f, 0.25f}})
      moving.polygons[0].corners.push_back({static_cast<float>(x) + 2.0f + dx, 2.5f + dy});
    moving_.publish(moving);
    kervan_msgs::msg::ArbitrationState state;
    state.behaviour = x < 0.5 ? "wall_follow" : "front_avoid";
    state.priority = x < 0.5 ? 20 : 50;
    if (x >= 0.5) state.waiting.emplace_back("wall_follow");
    arbitration_.publish(state);
    sense(now);
    odom_.publish(odometry_at({x, 0.02, 0.0}));
    if (now < Time(2s)) return;
    kervan_msgs::msg::MissionResult result;
    result.result = kervan_msgs::msg::MissionOutcome::MISSION_SUCCESS;
    result.robots.resize(1);
    result.robots[0].robot = "r1";
    result.robots[0].reached = true;
    result_.publish(result);
  }

  /// Every 0.2 s: a sonar that looks ahead and hears something at 2 m, one that hears nothing, and three beams to the
  /// right of a laser 0.1 m ahead of the centre.
  void sense(Time now) {
    if (now.time_since_epoch() % 200ms != Duration::zero()) return;
    tf2_msgs::msg::TFMessage tf;
    tf.transforms.resize(1);
    tf.transforms[0].header.frame_id = "r1/base_link";
    tf.transforms[0].child_frame_id = "r1/laser";
    tf.transforms[0].transform.translation.x = 0.1;
    tf.transforms[0].transform.rotation.w = 1.0;
    tf_.publish(tf);
    kervan_msgs::msg::SonarArray sonar;
    geometry::set_header(sonar.header, now, "r1/base_link");
    sonar.field_of_view = 0.5f;
    sonar.max_range = 5.0f;
    sonar.readings = {{.x = 0.2f, .y = 0.0f, .yaw = 0.0f, .range = 2.0f},
                      {.x = 0.0f, .y = 0.2f, .yaw = 1.5f, .range = std::numeric_limits<float>::infinity()}};
    sonar_.publish(sonar);
    sensor_msgs::msg::LaserScan scan;
    geometry::set_header(scan.header, now, "r1/laser");
    scan.angle_min = -1.5707964f;
    scan.angle_increment = 0.1f;
    scan.ranges = {1.0f, 1.0f, 1.0f};
    scan_.publish(scan);
  }
};

std::string content_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// A folder that is gone when the test ends.
struct TemporaryFolder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / ("map_report_test_" + std::to_string(getpid()));
  TemporaryFolder() { std::filesystem::create_directories(path); }
  ~TemporaryFolder() { std::filesystem::remove_all(path); }
};

void run(const std::filesystem::path& folder, Duration length, double snapshots = 0.0, bool goals = true) {
  static const ComponentClass script = define<Script>("test/script");
  ComponentRegistry registry(ComponentRegistry::default_folders());
  registry.add(script);
  runtime::ContainerSpec spec;
  spec.clock = runtime::ClockMode::lockstep;
  spec.domain.id = 201;
  spec.domain.network = false;
  spec.log_to_console = false;
  spec.run_folder = folder;
  spec.components = {
      {.name = "script", .type = "test/script", .parameters = {}, .ports = {}},
      {.name = "report",
       .type = "observe/map_report",
       .parameters = {{"robots", ValueList{"r1"}}, {"title", "lab"}, {"snapshots", snapshots}, {"goals", goals}},
       .ports = {}}};
  runtime::Container container(spec, registry);
  container.activate();
  container.advance(Time(length));
  container.end();
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(MapReportComponent, DrawsTheWayOfAMovingObstacleAndItsPlacesAtTheTimesOfTheSnapshots) {
  // Those of before the end are not filled.
  const auto before_the_end = [](const std::string& svg) {
    const std::string outline = " \" fill=\"none\" stroke=\"#9aa5b1\"";
    int count = 0;
    for (auto at = svg.find(outline); at != std::string::npos; at = svg.find(outline, at + 1)) ++count;
    return count;
  };
  const TemporaryFolder folder;
  run(folder.path, 3s);
  const std::string svg = content_of(folder.path / "map.svg");
  EXPECT_TRUE(has(svg, "moving obstacle"));
  EXPECT_TRUE(has(svg, ",-2.6250 L3.1250,-2.6250")) << "the way of its middle";
  EXPECT_EQ(before_the_end(svg), 1) << "at the start";
  run(folder.path, 2500ms, 1.0);
  EXPECT_EQ(before_the_end(content_of(folder.path / "map.svg")), 3) << "after 0, 1 and 2 s";
}

TEST(MapReportComponent, WritesTheDrivenPathTenTimesASecond) {
  const TemporaryFolder folder;
  run(folder.path, 3s);
  const std::string table = content_of(folder.path / "trajectory.csv");
  EXPECT_TRUE(table.starts_with("t_s,robot,x_m,y_m,yaw_rad,odom_x_m,odom_y_m,odom_yaw_rad,v_mps,w_radps\n"));
  EXPECT_TRUE(has(table, "\n2.000,r1,1.0000,0.0000,0.00000,1.0000,0.0200,0.00000,1.0000,0.00000\n")) << table;
  EXPECT_GE(std::count(table.begin(), table.end(), '\n'), 30);
}

TEST(MapReportComponent, DrawsTheRunAtItsEnd) {
  const TemporaryFolder folder;
  run(folder.path, 3s);
  const std::string map = content_of(folder.path / "map.svg");
  EXPECT_TRUE(has(map, ">lab</tspan>"));
  EXPECT_TRUE(has(map, ">success</tspan>"));
  EXPECT_TRUE(has(map, ">reached the goal</tspan>"));
  EXPECT_TRUE(has(map, "M-1.0000,1.0000 L5.0000,1.0000")) << "the wall of the world";
}

TEST(MapReportComponent, ShowsWhichBehaviourWasInChargeWhereAndWhen) {
  const TemporaryFolder folder;
  run(folder.path, 3s);
  const std::string map = content_of(folder.path / "map.svg");
  EXPECT_TRUE(has(map, ">front_avoid</text>"));
  EXPECT_TRUE(has(map, ">wall_follow</text>"));
  const std::string timeline = content_of(folder.path / "arbitration.svg");
  EXPECT_TRUE(has(timeline, ">lab: who drives r1</text>"));
  EXPECT_TRUE(has(timeline, ">front_avoid</text>"));
}

TEST(MapReportComponent, MarksAnUnfinishedRunAsAborted) {
  const TemporaryFolder folder;
  run(folder.path, 1s);
  EXPECT_TRUE(has(content_of(folder.path / "map.svg"), ">aborted</tspan>"));
}

TEST(MapReportComponent, SaysNothingOfGoalsUnlessTheyAreToBeShown) {
  const TemporaryFolder folder;
  run(folder.path, 1s, 0.0, false);
  const std::string map = content_of(folder.path / "map.svg");
  EXPECT_FALSE(has(map, ">aborted</tspan>"));
  EXPECT_FALSE(has(map, ">did not reach the goal</tspan>"));
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(MapReportComponent, ShowsWhatTheSensorsSawEverySoOften) {
  const TemporaryFolder folder;
  run(folder.path, 1500ms, 0.4);
  const std::string map = content_of(folder.path / "map.svg");
  for (const char* time : {">0 s<", ">0.4 s<", ">0.8 s<", ">1.2 s<"}) EXPECT_EQ(count(map, time), 1u) << time;
  EXPECT_FALSE(has(map, ">0.2 s<"));
  // Where the robot truly was: at 0.4 m, with the transducer 0.2 m ahead.
  EXPECT_TRUE(has(map, "points=\"0.6000,0.0000 ")) << map;
  EXPECT_TRUE(has(map, "points=\"0.5000,0.0000 0.5000,1.0000 ")) << "the sweep begins at the laser, to the right";
  EXPECT_EQ(count(map, "fill-opacity=\"0.1\""), 2u * 4u + 1u) << "a cone and a sweep each time, and the legend";
}

TEST(MapReportComponent, ShowsNothingOfTheSensorsUnlessAskedTo) {
  const TemporaryFolder folder;
  run(folder.path, 1500ms);
  EXPECT_EQ(count(content_of(folder.path / "map.svg"), "fill-opacity=\"0.1\""), 0u);
}

TEST(MapReportComponent, DrawsTheMapThatIsMade) {
  const TemporaryFolder folder;
  {
    Harness harness("observe/map_report", {{"robots", ValueList{"r1"}}}, folder.path);
    harness.feed("r1/truth", odometry_at({}));
    harness.feed("tiles", map_tile({0, 0}, {0, 0, 99}));
    harness.feed("tiles", map_tile({-1, 0}, {50}));
    harness.advance(1s);
    EXPECT_EQ(harness.state(), ComponentState::active);
  }
  const std::string map = content_of(folder.path / "map.svg");
  EXPECT_TRUE(has(map, "<image x=\"-3.2000\" y=\"-0.0500\" width=\"3.3500\" height=\"0.0500\"")) << map;
}

TEST(MapReportComponent, LeavesOutTilesThatDoNotFitAndSaysSo) {
  const TemporaryFolder folder;
  {
    Harness harness("observe/map_report", {{"robots", ValueList{"r1"}}}, folder.path);
    kervan_msgs::msg::MapTile odd = map_tile({1, 0}, {99});
    odd.resolution = std::numeric_limits<float>::quiet_NaN();
    harness.feed("tiles", odd);
    harness.feed("tiles", map_tile({0, 0}, {0, 0, 99}));
    odd.resolution = 0.1f;
    harness.feed("tiles", odd);
    harness.advance(1s);
    EXPECT_EQ(harness.state(), ComponentState::degraded);
    EXPECT_EQ(harness.reason(), "tiles: those with cells or sizes of another kind are left out");
  }
  EXPECT_TRUE(has(content_of(folder.path / "map.svg"), "<image x=\"0.0000\" y=\"-0.0500\" width=\"0.1500\""));
}

TEST(MapReportComponent, WritesNothingWithoutAFolder) {
  Harness harness("observe/map_report", {{"robots", ValueList{"r1"}}});
  harness.feed("r1/truth", odometry_at({}));
  harness.advance(1s);
  EXPECT_NE(harness.state(), ComponentState::failed) << harness.reason();
}

}  // namespace
}  // namespace kervan::test
