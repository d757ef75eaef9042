// The shipped composition in worlds of corners: laps, contacts and the distance to the wall, by the true poses.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sim/files/world_file.hpp"
#include "tests/experiments/lap_judge.hpp"
#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

namespace fs = std::filesystem;

struct Course {
  const char* name;
  const char* world;
  geometry::Vector2 middle;  // a lap goes round it
  const char* start;
  const char* side;
  const char* arbitration;
  int seconds;  // for a lap and a quarter
};

const Course courses[] = {
    {"corner_90_right", "corner_90", {0, 0}, "[-1 m, 2.03 m, 0 deg]", "right", "requests", 130},
    {"corner_90_left_by_ownership", "corner_90", {0, 0}, "[1 m, 2.03 m, 180 deg]", "left", "ownership", 130},
    {"corner_180_right", "corner_180", {0, 0}, "[-1.5 m, 0.53 m, 0 deg]", "right", "requests", 110},
    {"corner_180_left", "corner_180", {0, 0}, "[1.5 m, 0.53 m, 180 deg]", "left", "requests", 110},
    {"corner_thick_right_by_ownership", "corner_thick", {0, 0}, "[-1.5 m, 0.63 m, 0 deg]", "right", "ownership", 110},
    {"room_right", "room", {5, 3}, "[1.5 m, 0.53 m, 0 deg]", "right", "requests", 180},
    {"room_left_found_first", "room", {5, 3}, "[4 m, 3 m, 90 deg]", "left", "requests", 220},
};

void PrintTo(const Course& course, std::ostream* out) { *out << course.name; }

struct Drive {
  nlohmann::json summary;
  std::vector<std::string> trajectory;
  std::string log;
};

Drive drive(const Course& course) {
  const Folder folder;
  const std::vector<std::string> arguments{std::string("world=worlds/") + course.world + ".yaml",
                                           std::string("start=") + course.start, std::string("side=") + course.side,
                                           std::string("arbitration=") + course.arbitration};
  Command command{KERVAN_PROGRAM, {"run", "10_wall_follow", "--json", "--for", std::to_string(course.seconds) + "s"}};
  for (const std::string& argument : arguments) command.arguments.insert(command.arguments.end(), {"--arg", argument});
  const Result result = run(command, folder.path());
  Drive driven;
  if (result.out.empty()) throw std::runtime_error(result.err);
  driven.summary = nlohmann::json::parse(result.out);
  EXPECT_EQ(result.err.find("warning ["), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("error ["), std::string::npos) << result.err;
  for (const auto& entry : fs::directory_iterator(folder.path() / "runs")) {
    driven.trajectory = lines_of(text_of(entry.path() / "trajectory.csv"));
    driven.log = text_of(entry.path() / "log.txt");
    EXPECT_NE(text_of(entry.path() / "map.svg").find(">wall_follow</text>"), std::string::npos);
    EXPECT_NE(text_of(entry.path() / "arbitration.svg").find(">wall_follow</text>"), std::string::npos);
  }
  return driven;
}

class WallFollowing : public testing::TestWithParam<Course> {};

TEST_P(WallFollowing, GoesRoundWithoutATouchAndKeepsItsDistance) {
  const Course& course = GetParam();
  const Drive driven = drive(course);
  const sim::World world = sim::load_world(std::string(KERVAN_SOURCES) + "/sim/worlds/" + course.world + ".yaml");
  LapJudge judge(world, course.middle,
                 course.side == std::string("left") ? behavior::Side::left : behavior::Side::right);
  for (std::size_t i = 1; i < driven.trajectory.size(); ++i) {
    std::vector<std::string> cells;
    std::istringstream row(driven.trajectory[i]);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    ASSERT_GE(cells.size(), 5u);
    judge.add(std::stod(cells[0]), {std::stod(cells[2]), std::stod(cells[3]), std::stod(cells[4])});
  }
  EXPECT_GE(judge.laps(), 1.0);
  EXPECT_GT(judge.samples(), 100);
  EXPECT_GE(judge.in_band(), 0.9);
  EXPECT_EQ(driven.log.find(" touches "), std::string::npos) << driven.log;
}

INSTANTIATE_TEST_SUITE_P(Courses, WallFollowing, testing::ValuesIn(courses),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace kervan::test
