/// What the component sim/world can be asked while it runs: the arguments of its requests.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "framework/kervan.hpp"
#include "sim/robot.hpp"

namespace kervan::sim {

struct StepArguments {
  std::int64_t steps = 1;

  template <class Visitor>
  void describe(Visitor& v) {
    v(steps, "steps", {.min = 1, .max = 1e6, .help = "How many."});
  }
};

struct SpawnArguments {
  std::string robot;
  std::optional<Pose2> pose;

  template <class Visitor>
  void describe(Visitor& v) {
    v(robot, "robot", {.help = "One of the parameter robots that is not in the world.", .required = true});
    v(pose, "pose", {.min = -1e6, .max = 1e6, .help = "Pose of base_link in map; else its start."});
  }
};

struct RemoveArguments {
  std::string robot;

  template <class Visitor>
  void describe(Visitor& v) {
    v(robot, "robot", {.help = "Its name.", .required = true});
  }
};

struct TeleportArguments {
  std::string robot;
  Pose2 pose;

  template <class Visitor>
  void describe(Visitor& v) {
    v(robot, "robot", {.help = "Its name.", .required = true});
    v(pose, "pose", {.min = -1e6, .max = 1e6, .help = "Pose of base_link in map.", .required = true});
  }
};

}  // namespace kervan::sim
