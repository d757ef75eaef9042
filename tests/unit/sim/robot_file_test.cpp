// Robot files: the shipped ones hold what their sources say, and every mistake is named at its place.
#include "sim/files/robot_file.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "tests/unit/config/refused.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using test::refused;

TEST(RobotFile, TheP3DxIsThatOfItsTable) {
  EXPECT_EQ(p3dx().name, "p3dx");
  EXPECT_EQ(p3dx().drive.speed, 1.0);
  EXPECT_EQ(p3dx().drive.turn_rate, 1.74);
  EXPECT_EQ(p3dx().drive.acceleration, 0.3);
  EXPECT_EQ(p3dx().drive.deceleration, 0.6);
  EXPECT_EQ(p3dx().drive.angular_acceleration, 1.74);
  EXPECT_NEAR(p3dx().outline.circumradius(), 0.32, 0.001);
  double front = 0.0, rear = 0.0, left = 0.0;
  for (const Vector2& corner : p3dx().outline.corners()) {
    front = std::max(front, corner.x());
    rear = std::min(rear, corner.x());
    left = std::max(left, corner.y());
  }
  EXPECT_EQ(front, 0.211);
  EXPECT_EQ(rear, -0.300);
  EXPECT_EQ(left, 0.200);
}

TEST(RobotFile, TheP3AtIsThatOfItsTable) {
  const RobotModel model = load_robot_model(KERVAN_SIM_FOLDER "/robots/p3at.yaml");
  EXPECT_EQ(model.name, "p3at");
  EXPECT_EQ(model.drive.speed, 0.6);
  EXPECT_EQ(model.drive.turn_rate, 0.75);
  ASSERT_EQ(model.sonars.poses.size(), 16u);
  EXPECT_NEAR(model.sonars.poses[3].x, 0.245, 1e-12);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(model.sonars.poses[i].y, -model.sonars.poses[7 - i].y) << "sonar " << i;
    EXPECT_EQ(model.sonars.poses[8 + i].x, model.sonars.poses[15 - i].x) << "sonar " << 8 + i;
  }
  for (const Pose2& pose : model.sonars.poses) EXPECT_TRUE(model.outline.contains(pose.position()));
  ASSERT_TRUE(model.laser);
  EXPECT_EQ(model.laser->beams, 181);
  EXPECT_NEAR(beam_spacing(*model.laser), pi / 180.0, 1e-15);
  EXPECT_EQ(model.laser->pose.x, 0.125);
  EXPECT_EQ(model.laser->max_range, 32.767);
}

TEST(RobotFile, TheJackalIsThatOfBarn) {
  const RobotModel model = load_robot_model(KERVAN_SIM_FOLDER "/robots/jackal.yaml");
  EXPECT_EQ(model.name, "jackal");
  EXPECT_EQ(model.drive.speed, 2.0);
  EXPECT_NEAR(model.outline.circumradius(), std::hypot(0.254, 0.215), 1e-12);
  EXPECT_TRUE(model.sonars.poses.empty());
  ASSERT_TRUE(model.laser);
  EXPECT_EQ(model.laser->beams, 720);
  EXPECT_NEAR(model.laser->field_of_view, 1.5 * pi, 1e-12);
}

constexpr const char* smallest_robot =
    "kervan_robot: 1\n"
    "name: r\n"
    "outline: [[1 m, 0 m], [-1 m, 1 m], [-1 m, -1 m]]\n"
    "drive: {type: differential, track: 1 m, speed: 1 m/s, turn_rate: 1 rad/s, acceleration: 1 m/s2, deceleration: 1 "
    "m/s2, "
    "angular_acceleration: 1 rad/s2}\n";

std::string robot_refusal(const std::string& from, const std::string& to) {
  std::string text = smallest_robot;
  text.replace(text.find(from), from.size(), to);
  return refused([&] { parse_robot_model(text, "r.yaml"); });
}

TEST(RobotFile, ARobotMayHaveNothingButABodyAndADrive) {
  const RobotModel model = parse_robot_model(smallest_robot, "r.yaml");
  EXPECT_TRUE(model.sonars.poses.empty());
  EXPECT_FALSE(model.laser);
  EXPECT_TRUE(model.bumpers.front.empty() && model.bumpers.rear.empty());
  EXPECT_EQ(model.odometry.drift, 0.0);
}

TEST(RobotFile, EveryMistakeIsNamedAtItsPlace) {
  EXPECT_EQ(robot_refusal("[-1 m, 1 m], [-1 m, -1 m]", "[-1 m, -1 m], [-1 m, 1 m]"),
            "r.yaml:3:10: outline: the corners of an outline must be convex and counter-clockwise");
  EXPECT_EQ(robot_refusal("differential", "omni"), "r.yaml:4:15: type: omni is not one of differential, synchro");
  EXPECT_EQ(robot_refusal("differential", "synchro"),
            "r.yaml:4:24: unknown key 'track'; allowed: type, speed, turn_rate, acceleration, deceleration, "
            "angular_acceleration");
  EXPECT_EQ(robot_refusal("track: 1 m, ", ""), "r.yaml:4:8: drive: the key 'track' is missing");
  EXPECT_EQ(robot_refusal("track: 1 m", "track: 0 m"),
            "r.yaml:4:36: track: 0 m is out of range; allowed: above 0, at most 10 m");
  EXPECT_EQ(robot_refusal("speed: 1 m/s", "speed: 0 m/s"),
            "r.yaml:4:48: speed: 0 m/s is out of range; allowed: above 0, at most 100 m/s");
  EXPECT_EQ(robot_refusal("speed: 1 m/s, ", ""), "r.yaml:4:8: drive: the key 'speed' is missing");
  EXPECT_EQ(
      robot_refusal("name: r", "name: r\nsonars: {min_range: 2 m, max_range: 1 m, field_of_view: 1 rad, poses: []}"),
      "r.yaml:3:21: min_range: 2 m is out of range; allowed: above 0, at most 1 m");
  const auto laser_refusal = [](const std::string& from, const std::string& to) {
    std::string laser =
        "laser: {pose: [0 m, 0 m, 0 deg], beams: 181, field_of_view: 180 deg, min_range: 5 cm, "
        "max_range: 8 m}";
    laser.replace(laser.find(from), from.size(), to);
    return robot_refusal("name: r", "name: r\n" + laser);
  };
  EXPECT_EQ(laser_refusal("beams: 181", "beams: 1"), "r.yaml:3:41: beams: 1 is out of range; allowed: 2 .. 100000");
  EXPECT_EQ(laser_refusal("beams: 181, ", ""), "r.yaml:3:8: laser: the key 'beams' is missing");
  EXPECT_EQ(laser_refusal("180 deg", "360 deg"),
            "r.yaml:3:61: field_of_view: the first and the last beam would be the same; a full turn of n beams has "
            "(n - 1) / n of it");
  EXPECT_EQ(laser_refusal("min_range: 5 cm", "min_range: 9 m"),
            "r.yaml:3:81: min_range: 9 m is out of range; allowed: above 0, at most 8 m");
}

TEST(RobotFile, EveryMistakeInTheArraysOfSonarsIsNamedAtItsPlace) {
  const auto refusal = [](const std::string& arrays) {
    return robot_refusal(
        "name: r",
        "name: r\nsonars: {min_range: 1 m, max_range: 2 m, field_of_view: 1 rad,\n  poses: [[0 m, 0 m, "
        "0 deg], [0 m, 0 m, 1 deg], [0 m, 0 m, 2 deg]],\n  arrays: " +
            arrays + "}");
  };
  EXPECT_EQ(refusal("[[0, 1, 2]]"), "nothing was refused");
  EXPECT_EQ(refusal("[[0, 1], [3]]"), "r.yaml:5:21: arrays[1][0]: 3 is out of range; allowed: 0 .. 2");
  EXPECT_EQ(refusal("[[0, -1]]"), "r.yaml:5:16: arrays[0][1]: -1 is out of range; allowed: 0 .. 2");
  EXPECT_EQ(refusal("[[0, 1], [2, 0]]"), "r.yaml:5:24: arrays[1][1]: transducer 0 is in an array already");
  EXPECT_EQ(refusal("[[0, 1], []]"), "r.yaml:5:20: arrays[1]: an array needs at least one transducer");
  EXPECT_EQ(refusal("[[2, 0]]"), "r.yaml:5:11: arrays: transducer 1 is in no array");
}

TEST(RobotFile, EveryMistakeInTheBumpersIsNamedAtItsPlace) {
  const auto refusal = [](const std::string& bumpers) {
    return robot_refusal("name: r", "name: r\nbumpers: " + bumpers);
  };
  EXPECT_EQ(refusal("{length: 1 m, rear: [[-1 m, 0 m, 180 deg]]}"), "nothing was refused");
  EXPECT_EQ(refusal("{rear: [[-1 m, 0 m, 180 deg]]}"), "r.yaml:3:10: bumpers: the key 'length' is missing");
  EXPECT_EQ(refusal("{length: 0 m, rear: [[-1 m, 0 m, 180 deg]]}"),
            "r.yaml:3:19: length: 0 m is out of range; allowed: above 0, at most 10 m");
  EXPECT_EQ(refusal("{length: 1 m}"), "r.yaml:3:10: bumpers: there must be segments in front, rear or both");
  EXPECT_EQ(refusal("{length: 1 m, side: []}"), "r.yaml:3:24: unknown key 'side'; allowed: length, front, rear");
  EXPECT_EQ(refusal("{length: 1 m, rear: [[-1 m, 0 m]]}"),
            "r.yaml:3:31: rear[0]: expected a pose [x m, y m, yaw deg], found a list of 2");
  EXPECT_EQ(refusal("{length: 1 m, rear: [[-1 m, 0 m, 180 deg], [-0.9 m, 0 m, 180 deg]]}"),
            "r.yaml:3:53: rear[1]: the segment lies 100 mm within the hull of body and bumpers; it must lie on the "
            "outside");
  EXPECT_EQ(refusal("{length: 1 m, front: [[11 m, 0 m, 0 deg]]}"),
            "r.yaml:3:32: front[0]: is farther than 10 m from the origin of base_link");
}

TEST(RobotFile, ABodyWithoutWidthCannotWearBumpers) {
  EXPECT_EQ(robot_refusal("outline: [[1 m, 0 m], [-1 m, 1 m], [-1 m, -1 m]]",
                          "outline: [[9 m, -1e-9 m], [9 m, 1e-9 m], [-9 m, 0 m]]\n"
                          "bumpers: {length: 1e-9 m, rear: [[-9 m, 0 m, 180 deg]]}"),
            "r.yaml:4:10: bumpers: body and bumpers have no hull: an outline needs at least 3 corners");
}

TEST(RobotFile, EveryMistakeInTheOdometryIsNamedAtItsPlace) {
  const auto refusal = [](const std::string& odometry) {
    return robot_refusal("name: r", "name: r\nodometry: " + odometry);
  };
  EXPECT_EQ(refusal("{drift: 0, wheel_error: 0, wheel_slip: 0 m, resolution: 1 mm}"), "nothing was refused");
  EXPECT_EQ(refusal("{drift: 0, wheel_error: 0, wheel_slip: 0 m}"),
            "r.yaml:3:11: odometry: the key 'resolution' is missing");
  EXPECT_EQ(refusal("{drift: -0.1, wheel_error: 0, wheel_slip: 0 m, resolution: 0 m}"),
            "r.yaml:3:19: drift: -0.1 is out of range; allowed: 0 .. 0.5");
  EXPECT_EQ(refusal("{drift: 0, wheel_error: 0, wheel_slip: 2 m, resolution: 0 m}"),
            "r.yaml:3:50: wheel_slip: 2 m is out of range; allowed: 0 .. 1 m");
}

RobotModel shipped(const std::string& name) { return load_robot_model(KERVAN_SIM_FOLDER "/robots/" + name + ".yaml"); }

TEST(RobotFile, TheK2aIsRoundAndLooksAroundEvery15Degrees) {
  const RobotModel model = shipped("k2a");
  EXPECT_EQ(model.drive_type, DriveType::synchro);
  EXPECT_EQ(model.track, 0.0);
  EXPECT_EQ(model.drive.speed, 0.78);
  EXPECT_NEAR(model.drive.turn_rate, 120.0 * pi / 180.0, 1e-12);
  EXPECT_NEAR(model.outline.circumradius(), 0.4, 1e-4);
  for (const Vector2& corner : model.outline.corners()) EXPECT_NEAR(corner.norm(), 0.4, 1e-4);
  ASSERT_EQ(model.sonars.poses.size(), 24u);
  for (std::size_t i = 0; i < 24; ++i) {
    const Pose2& pose = model.sonars.poses[i];
    EXPECT_NEAR(geometry::wrap_angle(pose.yaw - static_cast<double>(i) * pi / 12.0), 0.0, 1e-12) << "sonar " << i;
    EXPECT_NEAR((pose.position() - 0.39 * geometry::heading(pose.yaw)).norm(), 0.0, 1e-4) << "sonar " << i;
    EXPECT_TRUE(model.outline.contains(pose.position())) << "sonar " << i;
  }
  // All of them within four slots of 40 ms, and those of a slot 60 degrees apart.
  ASSERT_EQ(model.sonars.arrays.size(), 6u);
  for (const auto& array : model.sonars.arrays) ASSERT_EQ(array.size(), 4u);
  for (std::size_t slot = 0; slot < 4; ++slot)
    for (std::size_t a = 1; a < 6; ++a) EXPECT_EQ(model.sonars.arrays[a][slot], model.sonars.arrays[a - 1][slot] + 4);
}

TEST(RobotFile, ThePioneersHaveTwoArraysOfEight) {
  for (const char* name : {"p3dx", "p3at"}) {
    const auto arrays = shipped(name).sonars.arrays;
    ASSERT_EQ(arrays.size(), 2u);
    for (std::uint16_t i = 0; i < 8; ++i) {
      EXPECT_EQ(arrays[0].at(i), i);
      EXPECT_EQ(arrays[1].at(i), 8 + i);
    }
  }
}

TEST(RobotFile, TheTracksAreThoseOfTheOdometry) {
  EXPECT_NEAR(shipped("p3dx").track, 2e-3 / 0.0056, 5e-4);
  EXPECT_NEAR(shipped("p3at").track, 2e-3 / 0.0034, 5e-4);
  EXPECT_NEAR(shipped("jackal").track, 1.5 * 0.37559, 5e-5);
}

TEST(RobotFile, TheBumpersOfTheP3DxAreThoseOfTheirTable) {
  constexpr int front[5][3] = {{170, -220, -52}, {240, -120, -19}, {260, 0, 0}, {240, 120, 19}, {170, 220, 52}};
  constexpr int rear[5][3] = {{-250, 220, 128}, {-320, 120, 161}, {-340, 0, 180}, {-320, -120, 199}, {-250, -220, 232}};
  const BumperMount& bumpers = p3dx().bumpers;
  EXPECT_NEAR(bumpers.length, 0.105, 1e-12);
  ASSERT_EQ(bumpers.front.size(), 5u);
  ASSERT_EQ(bumpers.rear.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i)
    for (const auto& [pose, row] : {std::pair{bumpers.front[i], front[i]}, std::pair{bumpers.rear[i], rear[i]}}) {
      EXPECT_NEAR(pose.x, 1e-3 * row[0], 1e-12);
      EXPECT_NEAR(pose.y, 1e-3 * row[1], 1e-12);
      EXPECT_NEAR(pose.yaw, row[2] * pi / 180.0, 1e-12);
    }
}

TEST(RobotFile, EveryBumperIsAnEdgeOfTheRobotThatWearsIt) {
  constexpr double rounded = 1e-4;  // m; as the files' figures are
  for (const char* name : {"p3dx", "p3at", "k2a"})
    for (const BumperSet set : {BumperSet::front, BumperSet::rear, BumperSet::both}) {
      const RobotModel bare = shipped(name), model = with_bumpers(bare, set);
      for (const Vector2& corner : bare.outline.corners())
        EXPECT_LT(model.outline.clearance(Circle{corner, 1e-9}).distance, 1e-6) << name;
      const double half = 0.5 * model.bumpers.length;
      for (const Pose2& segment : fitted_bumpers(model))
        for (const double along : {-half, 0.0, half}) {
          EXPECT_LT(model.outline.clearance(Circle{segment * Vector2(0.0, along), 1e-9}).distance, rounded) << name;
          EXPECT_FALSE(model.outline.contains(segment * Vector2(2e-3, along))) << name;
        }
    }
}

TEST(RobotFile, ARobotWearsTheBumpersThatItsModelHas) {
  EXPECT_TRUE(fitted_bumpers(p3dx()).empty());
  EXPECT_EQ(fitted_bumpers(with_bumpers(p3dx(), BumperSet::rear)).size(), 5u);
  EXPECT_EQ(fitted_bumpers(with_bumpers(p3dx(), BumperSet::both)).size(), 10u);
  const auto why = [](BumperSet set) {
    try {
      with_bumpers(shipped("jackal"), set);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("nothing was refused");
  };
  EXPECT_EQ(why(BumperSet::none), "nothing was refused");
  EXPECT_EQ(why(BumperSet::rear), "the model jackal has no rear bumpers");
  EXPECT_EQ(why(BumperSet::both), "the model jackal has no front bumpers");
}

}  // namespace
}  // namespace kervan::sim
