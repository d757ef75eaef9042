#include <gtest/gtest.h>

#include "sim/files/world_file.hpp"
#include "tests/unit/config/refused.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using test::refused;

TEST(WorldFile, TheLabIsThePapersLaboratory) {
  const World world = load_world(KERVAN_SIM_FOLDER "/worlds/lab.yaml");
  EXPECT_EQ(world.name(), "lab");
  ASSERT_EQ(world.segments().size(), 5u);
  EXPECT_EQ(world.segments()[4].a, Vector2(16.40, 7.30));
  EXPECT_EQ(world.segments()[4].b, Vector2(16.40, 9.30));
  ASSERT_EQ(world.circles().size(), 1u);
  EXPECT_EQ(world.circles()[0].center, Vector2(8.20, 6.59));
  EXPECT_EQ(world.circles()[0].radius, 0.30);
  // The outer walls close: from inside, every direction ends at one.
  for (int i = 0; i < 360; ++i) {
    const auto hit = world.cast({{20.0, 12.0}, geometry::heading(i * pi / 180.0)});
    ASSERT_TRUE(hit) << i << " degrees";
  }
  EXPECT_NEAR(world.cast({{0.0, 0.0}, {0.0, -1.0}})->distance, 1.5, 1e-12);
  EXPECT_NEAR(world.cast({{20.0, 12.0}, {1.0, 0.0}})->distance, 12.0, 1e-12);
  EXPECT_NEAR(world.cast({{20.0, 12.0}, {0.0, 1.0}})->distance, 5.5, 1e-12);
}

TEST(WorldFile, BoxesMayBeTurned) {
  const World world = parse_world(
      "kervan_world: 1\n"
      "name: box\n"
      "boxes:\n"
      "  - {center: [3 m, 0 m], size: [200 cm, 1 m], yaw: 90 deg}\n",
      "box.yaml");
  ASSERT_EQ(world.boxes().size(), 1u);
  EXPECT_NEAR(world.cast({{0.0, 0.0}, {1.0, 0.0}})->distance, 2.5, 1e-12);
  EXPECT_TRUE(world.segments().empty());
}

TEST(WorldFile, LowAndMovingObstaclesHaveTheirOwnPlaces) {
  const World world = parse_world(
      "kervan_world: 1\n"
      "name: w\n"
      "low:\n"
      "  segments: [[[0 m, 0 m], [1 m, 0 m]]]\n"
      "  circles: [{center: [3 m, 0 m], radius: 10 cm}]\n"
      "  boxes: [{center: [5 m, 0 m], size: [1 m, 1 m]}]\n"
      "moving:\n"
      "  - {name: cart, radius: 0.3 m, path: [{at: 0 s, pose: [1 m, 2 m, 0 deg]}, {at: 2 s, pose: [3 m, 2 m, 0 "
      "deg]}]}\n"
      "  - name: door\n"
      "    size: [80 cm, 4 cm]\n"
      "    repeat: true\n"
      "    path:\n"
      "      - {at: 1 s, pose: [0 m, 0 m, 0 deg]}\n"
      "      - {at: 3 s, pose: [0 m, 0 m, 90 deg]}\n"
      "      - {at: 5 s, pose: [0 m, 0 m, 0 deg]}\n",
      "w.yaml");
  EXPECT_TRUE(world.segments().empty() && world.circles().empty() && world.boxes().empty());
  EXPECT_EQ(world.low().segments().size(), 1u);
  EXPECT_EQ(world.low().circles().size(), 1u);
  EXPECT_EQ(world.low().boxes().size(), 1u);
  ASSERT_EQ(world.moving().size(), 2u);
  const MovingObstacle &cart = world.moving()[0], &door = world.moving()[1];
  EXPECT_EQ(cart.name, "cart");
  EXPECT_NEAR(cart.outline.circumradius(), 0.3, 1e-12);
  EXPECT_FALSE(cart.repeat);
  EXPECT_EQ(pose_at(cart, std::chrono::seconds(1)), (Pose2{2.0, 2.0, 0.0}));
  EXPECT_NEAR(door.outline.circumradius(), std::hypot(0.4, 0.02), 1e-12);
  EXPECT_TRUE(door.repeat);
  EXPECT_NEAR(pose_at(door, std::chrono::seconds(2 + 4)).yaw, 0.25 * pi, 1e-12);
}

std::string world_refusal(const std::string& lines) {
  return refused([&] { parse_world("kervan_world: 1\nname: w\n" + lines, "w.yaml"); });
}

TEST(WorldFile, EveryMistakeIsNamedAtItsPlace) {
  EXPECT_EQ(world_refusal("walls: []\n"),
            "w.yaml:3:1: unknown key 'walls'; allowed: kervan_world, name, segments, circles, boxes, bitmaps, maps, "
            "low, moving");
  EXPECT_EQ(world_refusal("circle: []\n"),
            "w.yaml:3:1: unknown key 'circle'; did you mean 'circles'? allowed: kervan_world, name, segments, circles, "
            "boxes, bitmaps, maps, low, moving");
  EXPECT_EQ(world_refusal("circles:\n  - {center: [1 m, 2 m]}\n"),
            "w.yaml:4:5: circles[0]: the key 'radius' is missing");
  EXPECT_EQ(world_refusal("circles:\n  - {center: [1 m, 2 m], radius: -0.3 m}\n"),
            "w.yaml:4:34: radius: -0.3 m is out of range; allowed: above 0, at most 1000000 m");
  EXPECT_EQ(world_refusal("circles:\n  - {center: [1 m, 2 m], radius: 0 m}\n"),
            "w.yaml:4:34: radius: 0 m is out of range; allowed: above 0, at most 1000000 m");
  EXPECT_EQ(world_refusal("circles:\n  - {center: [.nan m, 2 m], radius: 1 m}\n"),
            "w.yaml:4:15: center[0]: '.nan m' is not a length; write a number and a unit, e.g. 1 m");
  EXPECT_EQ(world_refusal("circles:\n  - {center: [1 m, 2 m], radius: 0.3 kg}\n"),
            "w.yaml:4:34: radius: 0.3 kg is not a length; allowed units: m, cm, mm, km");
  EXPECT_EQ(world_refusal("circles:\n  - {center: [1 m, 2 m], radius: 0.3}\n"),
            "w.yaml:4:34: radius: 0.3 has no unit; write e.g. 0.3 m");
  EXPECT_EQ(world_refusal("circles:\n  - {center: [1 m, 2 m], radius: 1 m, radius: 2 m}\n"),
            "w.yaml:4:39: duplicate key 'radius'; it was first given at line 4");
  EXPECT_EQ(world_refusal("segments:\n  - [[1 m, 2 m], [1 m, 2 m]]\n"),
            "w.yaml:4:5: segments[0]: both ends of the segment are the same point; a segment needs a length");
  EXPECT_EQ(world_refusal("segments:\n  - [[1 m, 2 m], [1 m, 2 m], [3 m, 4 m]]\n"),
            "w.yaml:4:5: segments[0]: expected the two ends of a segment [[x m, y m], [x m, y m]], found a list of 3");
  EXPECT_EQ(world_refusal("segments:\n  - [[1 m, 2 m], [1 m, 2e6 m]]\n"),
            "w.yaml:4:24: segments[0][1][1]: 2e6 m is out of range; allowed: -1000000 .. 1000000 m");
  EXPECT_EQ(world_refusal("segments: 3\n"), "w.yaml:3:11: segments: expected a list, found 3");
  EXPECT_EQ(world_refusal("boxes:\n  - {center: [1 m, 2 m], size: [1 m, 0 m]}\n"),
            "w.yaml:4:38: size[1]: 0 m is out of range; allowed: above 0, at most 1000000 m");
  EXPECT_EQ(world_refusal("boxes:\n  - {center: [1 m, 2 m], size: [1 m, 1 m], yaw: 1 m}\n"),
            "w.yaml:4:49: yaw: 1 m is not an angle; allowed units: rad, deg");
  EXPECT_EQ(refused([] { parse_world("name: w\n", "w.yaml"); }), "w.yaml:1:1: the key 'kervan_world' is missing");
  EXPECT_EQ(refused([] { parse_world("kervan_world: 2\nname: w\n", "w.yaml"); }),
            "w.yaml:1:15: kervan_world: 2 is not a known version of this format; allowed: 1");
  EXPECT_EQ(refused([] { load_world("no/such/world.yaml"); }),
            "no/such/world.yaml: cannot read the file: No such file or directory");
}

TEST(WorldFile, MistakesInLowAndMovingObstaclesAreNamedAtTheirPlace) {
  EXPECT_EQ(world_refusal("low:\n  bitmaps: []\n"),
            "w.yaml:4:3: unknown key 'bitmaps'; allowed: segments, circles, boxes");
  EXPECT_EQ(world_refusal("low:\n  circles: [{center: [1 m, 2 m], radius: 0 m}]\n"),
            "w.yaml:4:42: radius: 0 m is out of range; allowed: above 0, at most 1000000 m");
  const auto moving = [](const std::string& entry) { return world_refusal("moving:\n  - {" + entry + "}\n"); };
  const std::string path = "path: [{at: 0 s, pose: [1 m, 2 m, 0 deg]}]";
  EXPECT_EQ(moving("name: c, radius: 1 m"), "w.yaml:4:5: moving[0]: the key 'path' is missing");
  EXPECT_EQ(moving("radius: 1 m, " + path), "w.yaml:4:5: moving[0]: the key 'name' is missing");
  EXPECT_EQ(moving("name: '', radius: 1 m, " + path), "w.yaml:4:12: name: a moving obstacle needs a name");
  EXPECT_EQ(moving("name: c, " + path),
            "w.yaml:4:5: moving[0]: a moving obstacle has either a 'radius' or a 'size', neither is given");
  EXPECT_EQ(moving("name: c, radius: 1 m, size: [1 m, 1 m], " + path),
            "w.yaml:4:5: moving[0]: a moving obstacle has either a 'radius' or a 'size', not both");
  EXPECT_EQ(moving("name: c, radius: 1 m, path: []"),
            "w.yaml:4:34: path: a path needs at least one waypoint {at: 0 s, pose: [x m, y m, yaw deg]}");
  EXPECT_EQ(moving("name: c, radius: 1 m, path: [{at: -1 s, pose: [1 m, 2 m, 0 deg]}]"),
            "w.yaml:4:40: at: -1 s is out of range; allowed: 0 s and later");
  EXPECT_EQ(moving("name: c, radius: 1 m, path: [{at: 0 s, pose: [1 m, 2e6 m, 0 deg]}]"),
            "w.yaml:4:57: pose[1]: 2e6 m is out of range; allowed: -1000000 .. 1000000 m");
  EXPECT_EQ(
      moving("name: c, radius: 1 m, path: [{at: 3 s, pose: [1 m, 2 m, 0 deg]}, {at: 3 s, pose: [1 m, 2 m, 0 deg]}]"),
      "w.yaml:4:76: at: 3 s is not later than the waypoint before it");
  EXPECT_EQ(moving("name: c, radius: 1 m, repeat: true, " + path),
            "w.yaml:4:48: path: a path that repeats needs at least two waypoints");
  EXPECT_EQ(
      moving("name: c, radius: 1 m, repeat: true, path: [{at: 0 s, pose: [1 m, 2 m, 0 deg]}, {at: 3 s, pose: [1 m, 2 "
             "m, 9 deg]}]"),
      "w.yaml:4:101: pose: a path that repeats must end where it began");
  EXPECT_EQ(
      world_refusal("moving:\n  - {name: c, radius: 1 m, " + path + "}\n  - {name: c, radius: 1 m, " + path + "}\n"),
      "w.yaml:5:12: name: c is the name of another moving obstacle");
}

}  // namespace
}  // namespace kervan::sim
