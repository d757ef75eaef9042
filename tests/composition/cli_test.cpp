// The program as a person meets it: exit codes, one line on stderr, and nothing written when something is refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/program/program.hpp"

namespace fs = std::filesystem;

namespace {

const char* const without_errors = "2>/dev/null";

struct Result {
  int code = -1;
  std::string output;  ///< what the command line lets through of stdout and stderr
};

class Program : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("kervan_cli_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  Result kervan(const std::string& arguments, const std::string& errors = "2>&1") const {
    const auto result = kervan::test::run_line(KERVAN_PROGRAM, arguments + " " + errors, folder_);
    return {result.code, result.out + result.err};
  }

  /// Refused with exit code 2 in one line, and the working folder is as it was.
  void expect_refused(const std::string& arguments, const std::string& message) const {
    const auto count = std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
    const Result result = kervan(arguments);
    EXPECT_EQ(result.code, 2) << arguments;
    EXPECT_EQ(result.output, message + "\n") << arguments;
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), count)
        << "something was written";
  }

  fs::path folder_;
};

TEST_F(Program, ChecksEveryShippedCompositionWithoutAFinding) {
  for (const auto& entry : fs::directory_iterator(SHIPPED_COMPOSITIONS)) {
    const Result result = kervan("check " + entry.path().string());
    EXPECT_EQ(result.code, 0) << entry.path() << "\n" << result.output;
  }
}

TEST_F(Program, FindsAShippedCompositionByItsName) { EXPECT_EQ(kervan("check lab").code, 0); }

TEST_F(Program, SaysWhereAValueOfAProfileComesFrom) {
  const Result result = kervan("check lab --explain /r1/sonar");
  EXPECT_EQ(result.code, 0);
  EXPECT_NE(result.output.find("reliability  best_effort  profile sensor, declared by world.r1/sonar"),
            std::string::npos)
      << result.output;
}

TEST_F(Program, ShowsWhoMeetsWhomAndWhoIsAlone) {
  const Result result = kervan("check lab");
  for (const char* row :
       {"topic            type                                writer                  reader ",
        "/r1/sonar        kervan_msgs::msg::SonarArray        world.r1/sonar          r1/control.sonar ",
        "/tf              tf2_msgs::msg::TFMessage            world./tf               -  "})
    EXPECT_NE(result.output.find(row), std::string::npos) << row << "\n" << result.output;
  EXPECT_NE(kervan("check lab --json", without_errors)
                .output.find(R"({"topic":"/tf","type":"tf2_msgs::msg::TFMessage","writer":"world./tf","reader":null,)"
                             R"("profile":"event","verdict":"nobody reads it"})"),
            std::string::npos);
}

TEST_F(Program, ShowsWhereEveryComponentIsPlaced) {
  const Result result = kervan("check lab --place drive=r1/control,r1/guard");
  EXPECT_EQ(result.code, 0);
  EXPECT_NE(result.output.find("container  host  components\n"
                               "all        -     world, r1/planner, r1/follower, report, mission\n"
                               "drive      -     r1/control, r1/guard\n"),
            std::string::npos)
      << result.output;
}

TEST_F(Program, DescribesEveryComponent) {
  const Result all = kervan("describe");
  EXPECT_EQ(all.code, 0);
  for (const char* type : {"sim/world", "planning/waypoint_astar", "control/potential_field", "safety/drive_guard"}) {
    EXPECT_NE(all.output.find(type), std::string::npos) << type;
    EXPECT_EQ(kervan(std::string("describe ") + type).code, 0) << type;
    EXPECT_EQ(kervan(std::string("describe ") + type + " --json", without_errors).output.front(), '{') << type;
  }
}

TEST_F(Program, HelpsWithEveryVerb) {
  for (const char* verb : {"", "run", "sweep", "check", "describe", "draw", "container", "systemd"})
    EXPECT_EQ(kervan(std::string(verb) + " --help").code, 0) << verb;
}

TEST_F(Program, RefusesInOneLineAndWritesNothing) {
  expect_refused(
      "", "a command is missing: run, sweep, check, describe, draw, container, systemd, link; see kervan --help");
  expect_refused("rnu lab",
                 "there is no command 'rnu'; did you mean 'run'? commands: run, sweep, check, describe, draw, "
                 "container, systemd, link");
  expect_refused(
      "run lba",
      "there is no composition 'lba'; did you mean 'lab'? there are: 02_two_robots, 03_ten_robots, "
      "10_wall_follow, 11_map_room, 12_map_two_robots, 13_map_drifting, 20_vff_rods, 21_gnron, 22_vfh_rescue, "
      "22_vfh_weights, 23_explore, 23_explore_four_robots, 23_explore_two_robots, 24_barn, 25_ompl, lab");
  expect_refused("run other.yaml", "other.yaml: there is no such file");
  expect_refused("check lab --host base", "--host base: lab has no such host; it has: none");
  expect_refused("run lab --place left=wrold",
                 "--place left=wrold: there is no component 'wrold'; did you mean 'world'? there are: mission, r1, "
                 "r1/control, r1/follower, r1/guard, r1/planner, report, world");
  expect_refused(
      "run lab --place left=world --place right=world",
      "--place right=world: the component 'world' is already in the container 'left' (--place left=world); it "
      "can be in one only");
  expect_refused("run lab --for 60", "--for 60: 60 has no unit; write e.g. 60 s");
  expect_refused("run lab --snapshots 5", "--snapshots 5: 5 has no unit; write e.g. 5 s");
  expect_refused("run lab --snapshots 0s", "--snapshots 0s: the time must be longer than 0 s");
  expect_refused("run lab --snapshots 90min",
                 "--snapshots 90min: snapshots: 5400 s is out of range; allowed: 0 .. 3600 s");
  expect_refused("run lab --snapshots", "kervan run: --snapshots: 1 required TIME missing; see kervan run --help");
  expect_refused("run lab --arg seed=-1", "--arg seed=-1: -1 is out of range; allowed: 0 .. 4294967295");
  expect_refused("run lab --arg drift=1", "--arg drift=1: 1 is out of range; allowed: 0 .. 0.5");
  expect_refused("run lab --arg controller=vfh",
                 "--arg controller=vfh: vfh is not one of potential_classic, potential_gecui");
  expect_refused(
      "check lab --explain /r1/sonra",
      "--explain /r1/sonra: lab has no such topic; did you mean '/r1/sonar'? it has: /clock, /moving, /outline, "
      "/r1/arbitration, /r1/clearance, /r1/cmd_vel, /r1/cmd_vel_raw, /r1/contact, /r1/force, /r1/goal, "
      "/r1/goal_status, /r1/goals, /r1/odom, /r1/replan, /r1/route, /r1/sonar, /r1/truth, /r1/waypoint, /result, /tf, "
      "/tiles");
}

TEST_F(Program, RefusesAMalformedWorldAtItsPlaceAndWritesNothing) {
  std::ofstream(folder_ / "world.yaml") << "kervan_world: 1\nname: lab\ncirclse: []\n";
  std::ofstream(folder_ / "c.yaml")
      << "kervan: 1\nname: c\ncomponents:\n  world: {type: sim/world, params: {map: world.yaml}}\n";
  expect_refused("run c.yaml",
                 (folder_ / "world.yaml").string() +
                     ":3:1: unknown key 'circlse'; did you mean 'circles'? allowed: kervan_world, name, segments, "
                     "circles, boxes, bitmaps, maps, low, moving");
}

TEST_F(Program, RefusesSnapshotsWhereNothingDrawsAMap) {
  std::ofstream(folder_ / "c.yaml") << "kervan: 1\nname: c\ncomponents:\n  world: {type: sim/world, params: {map: "
                                       "worlds/lab.yaml}}\n";
  expect_refused("run c.yaml --snapshots 5s",
                 "--snapshots 5s: 'c' has no component that draws a map; add one of type observe/map_report");
}

TEST_F(Program, DrawsAWorldByItsNameOrFile) {
  const Result named = kervan("draw rods");
  EXPECT_EQ(named.code, 0);
  EXPECT_EQ(named.output, "rods.svg\n");
  std::ofstream(folder_ / "mine.yaml") << "kervan_world: 1\nname: mine\nsegments: [[[0 m, 0 m], [1 m, 0 m]]]\n";
  EXPECT_EQ(kervan("draw mine.yaml --out picture.svg").output, "picture.svg\n");
  std::string text;
  std::getline(std::ifstream(folder_ / "picture.svg"), text, '\0');
  EXPECT_NE(text.find(">mine</tspan>"), std::string::npos);
  EXPECT_NE(text.find("M0.0000,0.0000 L1.0000,0.0000"), std::string::npos);
}

TEST_F(Program, DrawsThePlanOfAWorldsWalls) {
  std::ofstream(folder_ / "mine.yaml") << "kervan_world: 1\nname: mine\nsegments: [[[0 m, 0.02 m], [1 m, 0.02 m]]]\n"
                                          "circles: [{center: [2 m, 2 m], radius: 0.5 m}]\n";
  EXPECT_EQ(kervan("draw mine.yaml --plan plan.yaml").output, "plan.yaml\n");
  EXPECT_TRUE(fs::exists(folder_ / "plan.yaml"));
  EXPECT_TRUE(fs::exists(folder_ / "plan.png"));
  expect_refused("draw mine.yaml --plan plan.png", "plan.png: a map of map_server ends with .yaml");
  EXPECT_FALSE(kervan("draw mine.yaml --plan nowhere/plan.yaml").code == 0);
}

TEST_F(Program, RefusesToDrawWhatIsNoWorld) {
  expect_refused("draw",
                 "kervan draw: a world is missing; name a shipped one, such as lab, or a file; see kervan draw "
                 "--help");
  expect_refused("draw other.yaml", "other.yaml: there is no such file");
  expect_refused("draw lab --out nowhere/lab.svg", "nowhere/lab.svg: cannot be written");
  std::ofstream(folder_ / "broken.yaml") << "kervan_world: 1\nname: lab\nwalls: []\n";
  expect_refused("draw broken.yaml",
                 "broken.yaml:3:1: unknown key 'walls'; allowed: kervan_world, name, segments, circles, "
                 "boxes, bitmaps, maps, low, moving");
  const Result misspelt = kervan("draw ofice");
  EXPECT_EQ(misspelt.code, 2);
  EXPECT_TRUE(misspelt.output.starts_with("there is no world 'ofice'; did you mean 'office'? there are: clutter, "))
      << misspelt.output;
}

TEST_F(Program, RefusesARobotThatStandsInAWall) {
  std::ofstream(folder_ / "c.yaml") << "kervan: 1\nname: c\ncomponents:\n  world:\n    type: sim/world\n    params:\n"
                                       "      map: worlds/lab.yaml\n"
                                       "      robots: {r1: {model: robots/p3dx.yaml, start: [8.2 m, 6.5 m, 0 deg]}}\n";
  expect_refused("run c.yaml", "c.yaml:8:53: robots.r1.start: the robot would stand in an obstacle of lab");
}

TEST_F(Program, GivesErrorsAsJsonOnTheLastLineToo) {
  EXPECT_EQ(kervan("check lab --json --arg drift=1", without_errors).output,
            R"({"result":"error","error":{"message":"1 is out of range; allowed: 0 .. 0.5","file":"--arg drift=1"}})"
            "\n");
}

}  // namespace
