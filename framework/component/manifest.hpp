/// What a component says of itself: the one source that check, describe, the documentation, the schema and tests read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/component/parameters.hpp"
#include "framework/component/qos.hpp"

namespace kervan {

enum class PortDirection { input, output };

struct PortInfo {
  std::string name;  ///< relative ("sonar", "r1/odom") or absolute ("/tf")
  PortDirection direction = PortDirection::input;
  std::string type;  ///< "sensor_msgs::msg::LaserScan"
  std::uint64_t layout_hash = 0;
  bool keyed = false;
  PortQos qos = qos::state;
  std::string help;
};

struct TimerInfo {
  Duration period{};
};

struct RequestInfo {
  std::string name;
  std::vector<ParameterInfo> arguments;
  std::string help;
};

/// Obtained by constructing the component and reading what its members declared; no DDS, no running component. Ports
/// may depend on the parameters, so a manifest belongs to a type and the values it was constructed with.
struct Manifest {
  std::string type;  ///< "control/potential_field"
  std::string help;
  std::vector<ParameterInfo> parameters;
  std::vector<PortInfo> ports;  ///< in order of declaration
  std::vector<TimerInfo> timers;
  std::vector<RequestInfo> requests;  ///< in order of declaration
  bool own_thread = false;            ///< its handlers block, so it gets a thread of its own

  const PortInfo* port(const std::string& name) const;
  const ParameterInfo* parameter(const std::string& name) const;
};

}  // namespace kervan
