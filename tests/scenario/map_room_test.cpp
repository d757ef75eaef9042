// The shipped compositions that make maps: what they leave behind, and how good two robots' map is beside one robot's.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "framework/map_file/map_file.hpp"
#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

class MapRun {
 public:
  /// Warnings are not expected, unless the run is bound to have some.
  MapRun(const std::string& composition, const std::string& length, const Strings& more = {}, bool warns = false) {
    Command command{KERVAN_PROGRAM, {"run", composition, "--json", "--for", length, "--place", "all"}};
    command.arguments.insert(command.arguments.end(), more.begin(), more.end());
    const Result result = run(command, folder_.path());
    if (result.out.empty()) throw std::runtime_error(result.err);
    EXPECT_EQ(result.err.find("warning [") != std::string::npos, warns) << result.err;
    EXPECT_EQ(result.err.find("error ["), std::string::npos) << result.err;
    quality_ = nlohmann::json::parse(result.out)["figures"]["quality"];
  }

  double quality(const std::string& figure) const { return quality_[figure].get<double>(); }
  fs::path file(const std::string& name) const {
    for (const auto& entry : fs::directory_iterator(folder_.path() / "runs")) return entry.path() / name;
    return {};
  }

 private:
  Folder folder_;
  nlohmann::json quality_;
};

TEST(MapRoom, LeavesAPictureOfTheMapOnTheTruthAndAMapForMapServer) {
  const MapRun run("11_map_room", "60s");
  const std::string picture = text_of(run.file("map.svg"));
  for (const char* part : {"data:image/png;base64,", ">the map: occupied</text>", ">the world, truth</text>",
                           ">wall_find</text>", ">wall_follow</text>"})
    EXPECT_NE(picture.find(part), std::string::npos) << part;
  const map_file::GridMap map = map_file::load(run.file("map.yaml").string());
  EXPECT_EQ(map.resolution, 0.05);
  EXPECT_GT(std::count(map.occupancy.begin(), map.occupancy.end(), 0), 5000) << "of free cells";
  EXPECT_GT(std::count(map.occupancy.begin(), map.occupancy.end(), 100), 300) << "of occupied ones";
  EXPECT_TRUE(fs::exists(run.file("map.map")));
}

TEST(MapRoom, OfTwoRobotsIsAsGoodAsOneRobotsWithTwiceTheTime) {
  const MapRun two("12_map_two_robots", "160s");
  const MapRun one("11_map_room", "320s", {"--arg", "world=worlds/hall.yaml", "--arg", "start=[1.5 m, 0.53 m, 0 deg]"});
  EXPECT_NEAR(two.quality("accuracy"), one.quality("accuracy"), 0.01);
  EXPECT_NEAR(two.quality("near_accuracy"), one.quality("near_accuracy"), 0.01);
  EXPECT_NEAR(two.quality("coverage"), one.quality("coverage"), 0.02) << "both saw the same place";
  EXPECT_GT(two.quality("coverage"), 0.6);
}

TEST(MapRoom, ScanMatchingHoldsTheMapOfARobotWhoseWheelsDrift) {
  const MapRun wheels("11_map_room", "300s", {"--arg", "drift=0.02"});
  const MapRun matched("13_map_drifting", "300s", {}, true);  // a wall alone does not say where along it the robot is
  EXPECT_LT(matched.quality("wall_error_m"), 0.5 * wheels.quality("wall_error_m"));
  EXPECT_GT(matched.quality("near_accuracy"), wheels.quality("near_accuracy") + 0.05);
}

}  // namespace
}  // namespace kervan::test
