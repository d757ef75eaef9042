/// The shipped worlds: every one loads, its starts are free, and a robot gets everywhere.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <queue>
#include <regex>

#include "sim/files/robot_file.hpp"
#include "sim/files/world_file.hpp"

namespace kervan::sim {
namespace {

namespace fs = std::filesystem;

/// A line of a world's comment: "start of a p3dx: [1.50 m, 6.00 m, 0 deg]  at the left wall".
struct Start {
  std::string robot;
  Pose2 pose;
};

std::vector<Start> starts_in(const fs::path& file) {
  static const std::regex form(R"(# start of a (\w+): \[(\S+) m, (\S+) m, (\S+) deg\].*)");
  std::vector<Start> starts;
  std::ifstream text(file);
  for (std::string line; std::getline(text, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, form)) continue;
    starts.push_back(
        {match[1], {std::stod(match[2]), std::stod(match[3]), std::stod(match[4]) * std::numbers::pi / 180.0}});
  }
  return starts;
}

std::vector<std::string> names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(KERVAN_SIM_FOLDER "/worlds"))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

class ShippedWorld : public testing::TestWithParam<std::string> {
 protected:
  fs::path file_ = fs::path(KERVAN_SIM_FOLDER "/worlds") / (GetParam() + ".yaml");
  World world_ = load_world(file_.string());
};

TEST_P(ShippedWorld, HasTheNameOfItsFileAndSaysWhatIsFromAPaper) {
  EXPECT_EQ(world_.name(), GetParam());
  std::ifstream text(file_);
  std::string comment;
  for (std::string line; std::getline(text, line) && line.starts_with("#");) comment += line + "\n";
  EXPECT_TRUE(std::regex_search(comment, std::regex("paper|hall"))) << "what is printed and what is ours?\n" << comment;
}

TEST_P(ShippedWorld, HasRoomAtEveryStart) {
  const std::vector<Start> starts = starts_in(file_);
  EXPECT_FALSE(starts.empty()) << "a comment names where a robot may begin";
  for (const Start& start : starts) {
    const RobotModel model = load_robot_model(KERVAN_SIM_FOLDER "/robots/" + start.robot + ".yaml");
    EXPECT_GT(world_.clearance(model.outline, start.pose).distance, 0.15) << start.robot;
  }
}

/// Cells of 0.1 m in which the centre of a disc of 0.42 m may be, which is a P3-AT that turns on the spot.
class FreeCells {
 public:
  FreeCells(const World& world, const Vector2& low, const Vector2& high)
      : low_(low), columns_(count(high.x() - low.x())), free_(columns_ * count(high.y() - low.y())) {
    for (std::size_t i = 0; i < free_.size(); ++i) free_[i] = !world.nearest(center(i), 0.42);
  }

  Vector2 center(std::size_t cell) const {
    return low_ + 0.1 * Vector2(static_cast<double>(cell % columns_) + 0.5, static_cast<double>(cell / columns_) + 0.5);
  }

  /// Takes away all that can be reached from `start`; returns one that cannot.
  std::optional<Vector2> out_of_reach(const Vector2& start) {
    std::queue<std::size_t> reached;
    const auto reach = [&](std::size_t cell) {
      if (cell < free_.size() && std::exchange(free_[cell], 0) != 0) reached.push(cell);
    };
    reach(static_cast<std::size_t>((start.y() - low_.y()) / 0.1) * columns_ +
          static_cast<std::size_t>((start.x() - low_.x()) / 0.1));
    for (; !reached.empty(); reached.pop())
      for (const std::size_t next :
           {reached.front() - 1, reached.front() + 1, reached.front() - columns_, reached.front() + columns_})
        reach(next);
    return island();
  }

 private:
  static std::size_t count(double length) { return static_cast<std::size_t>(std::lround(length / 0.1)); }

  /// The middle of a patch of 5 by 5 cells; what is smaller is a gap between pieces of furniture.
  std::optional<Vector2> island() const {
    for (std::size_t cell = 2 * columns_ + 2; cell + 2 * columns_ + 2 < free_.size(); ++cell) {
      bool all = true;
      for (std::size_t row = 0; row < 5 && all; ++row)
        for (std::size_t column = 0; column < 5 && all; ++column)
          all = free_[cell - 2 * columns_ - 2 + row * columns_ + column] != 0;
      if (all) return center(cell);
    }
    return std::nullopt;
  }

  Vector2 low_;
  std::size_t columns_;
  std::vector<unsigned char> free_;
};

TEST_P(ShippedWorld, LetsARobotGetEverywhereWithinItsWalls) {
  Vector2 low = Vector2::Constant(infinity), high = -low;
  for (const Segment& segment : world_.segments())
    for (const Vector2& end : {segment.a, segment.b}) {
      low = low.cwiseMin(end);
      high = high.cwiseMax(end);
    }
  const std::vector<Start> starts = starts_in(file_);
  ASSERT_FALSE(starts.empty());
  if (world_.segments().size() < 4 || GetParam() == "room") GTEST_SKIP() << "it has no rectangle of walls around it";
  FreeCells cells(world_, low, high);
  const auto island = cells.out_of_reach(starts.front().pose.position());
  EXPECT_FALSE(island) << "nobody gets to (" << island->x() << ", " << island->y() << ")";
}

INSTANTIATE_TEST_SUITE_P(All, ShippedWorld, testing::ValuesIn(names()), [](const auto& world) { return world.param; });

}  // namespace
}  // namespace kervan::sim
