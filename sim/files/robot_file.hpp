/// Robot models as people write them: sim/README.md describes the format, sim/robots/p3dx.yaml is an example.
#pragma once

#include <string>

#include "sim/robot_model.hpp"

namespace kervan::sim {

/// Reads a robot model. Throws ConfigError at the place in the file that cannot be used.
RobotModel load_robot_model(const std::string& path);

/// The same from a text in memory; `shown_as` stands where messages name the file.
RobotModel parse_robot_model(const std::string& text, const std::string& shown_as);

}  // namespace kervan::sim
