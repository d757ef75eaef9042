#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/Contact.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class BarnScoreComponent : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("barn_score_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static void be_at(Harness& harness, double y) {
    auto truth = odometry_at({-2.25, y, 0.0});
    geometry::set_header(truth.header, harness.now(), "map");
    harness.feed("truth", truth);
    harness.advance(1s);
  }

  std::string figures() const {
    for (const auto& entry : fs::directory_iterator(folder_)) {
      std::ifstream file(entry.path());
      if (entry.path().filename().string().starts_with("figures-")) return {std::istreambuf_iterator<char>(file), {}};
    }
    return "no figures";
  }

  fs::path folder_;
  ValueMap params_{{"goals", points({{-2.25, 13.0}})}, {"reference", 10.0}};
};

TEST_F(BarnScoreComponent, LeavesItsFiguresInTheRunsFolder) {
  Harness harness("observe/barn_score", params_, folder_);
  for (int i = 0; i <= 10; ++i) be_at(harness, 3.0 + i);
  harness.end();
  EXPECT_EQ(figures(),
            "{\"metric\": 0.5, \"outcome\": \"success\", \"path_m\": 9, \"reference_m\": 10, \"time_s\": 8}\n");
}

TEST_F(BarnScoreComponent, AContactIsACollision) {
  Harness harness("observe/barn_score", params_, folder_);
  be_at(harness, 3.0);
  be_at(harness, 4.0);
  harness.feed("contact", kervan_msgs::msg::Contact{});
  be_at(harness, 13.0);
  harness.end();
  EXPECT_NE(figures().find("\"outcome\": \"collision\""), std::string::npos) << figures();
}

TEST_F(BarnScoreComponent, SaysThatNobodyTellsItTheTruth) {
  Harness harness("observe/barn_score", params_);
  harness.advance(1s);
  EXPECT_EQ(harness.state(), ComponentState::degraded);
  EXPECT_EQ(harness.reason(), "truth: nothing received yet");
}

TEST_F(BarnScoreComponent, RefusesToBeWithoutAGoal) {
  try {
    Harness harness("observe/barn_score", {{"goals", ValueList{}}});
    FAIL() << "accepted";
  } catch (const ParameterError& error) {
    EXPECT_EQ(error.parameter(), "subject.goals");
    EXPECT_EQ(error.message(), "there is no goal; write e.g. [[1 m, 2 m]]");
  }
}

}  // namespace
}  // namespace kervan::test
