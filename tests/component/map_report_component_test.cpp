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
#include "kervan_msgs/msg/MissionResult.hpp"
#include "kervan_msgs/msg/Outline.hpp"
#include "nav_msgs/msg/Path.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;

/// Plays a run of one robot that drives 1 m along x at 1 m/s.
class Script final : public Component {
  Output<nav_msgs::msg::Odometry> truth_{this, "r1/truth", qos::state, "Truth."};
  Output<nav_msgs::msg::Odometry> odom_{this, "r1/odom", qos::sensor, "Odometry."};
  Output<nav_msgs::msg::Path> route_{this, "r1/route", qos::latched, "Route."};
  Output<geometry_msgs::msg::PoseStamped> goal_{this, "r1/goal", qos::latched, "Goal."};
  Output<kervan_msgs::msg::Outline> world_{this, "world", qos::latched, "World."};
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
    truth_.publish(odometry_at({x, 0.0, 0.0}, {1.0, 0.0}));
    odom_.publish(odometry_at({x, 0.02, 0.0}));
    if (now < Time(2s)) return;
    kervan_msgs::msg::MissionResult result;
    result.result = kervan_msgs::msg::MissionOutcome::MISSION_SUCCESS;
    result.robots.resize(1);
    result.robots[0].robot = "r1";
    result.robots[0].reached = true;
    result_.publish(result);
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

void run(const std::filesystem::path& folder, Duration length) {
  static const ComponentClass script = define<Script>("test/script");
  ComponentRegistry registry(ComponentRegistry::default_folders());
  registry.add(script);
  runtime::ContainerSpec spec;
  spec.clock = runtime::ClockMode::lockstep;
  spec.domain.id = 201;
  spec.domain.network = false;
  spec.log_to_console = false;
  spec.run_folder = folder;
  spec.components = {{.name = "script", .type = "test/script", .parameters = {}, .ports = {}},
                     {.name = "report",
                      .type = "observe/map_report",
                      .parameters = {{"robots", ValueList{"r1"}}, {"title", "lab"}},
                      .ports = {}}};
  runtime::Container container(spec, registry);
  container.activate();
  container.advance(Time(length));
  container.end();
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

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

TEST(MapReportComponent, MarksAnUnfinishedRunAsAborted) {
  const TemporaryFolder folder;
  run(folder.path, 1s);
  EXPECT_TRUE(has(content_of(folder.path / "map.svg"), ">aborted</tspan>"));
}

TEST(MapReportComponent, WritesNothingWithoutAFolder) {
  Harness harness("observe/map_report", {{"robots", ValueList{"r1"}}});
  harness.feed("r1/truth", odometry_at({}));
  harness.advance(1s);
  EXPECT_NE(harness.state(), ComponentState::failed) << harness.reason();
}

}  // namespace
}  // namespace kervan::test
