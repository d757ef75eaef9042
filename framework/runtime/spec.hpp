/// What a container is told to run: plain values, made from a composition or by a test.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/component/qos.hpp"
#include "framework/component/value.hpp"
#include "framework/dds/domain.hpp"

namespace kervan::runtime {

/// Which topic a port uses and with what quality of service.
struct PortBinding {
  std::string port;   ///< as the component names it
  std::string topic;  ///< absolute: "/r1/sonar"
  QosProfile profile;
};

struct ComponentSpec {
  std::string name;  ///< "r1/control"
  std::string type;  ///< "control/potential_field"
  ValueMap parameters = {};
  std::vector<PortBinding> ports = {};  ///< a port not listed uses "/<port>" and its declared profile
  std::string log_level = "info";  ///< trace, debug, info, warn, error or off
};

enum class ClockMode {
  wall,      ///< real time
  lockstep,  ///< logical time, as fast as the machine allows, the same trace every time
};

struct ContainerSpec {
  std::string name = "main";
  ClockMode clock = ClockMode::wall;
  unsigned threads = 1;  ///< of the dispatcher; a component stays serial whatever the number
  dds::DomainConfig domain;
  std::vector<ComponentSpec> components;  ///< in the composition's order, which is the canonical order
  std::filesystem::path run_folder;       ///< empty: nothing is written
  bool log_to_console = true;
  bool publish_log = true;  ///< on /rosout
};

}  // namespace kervan::runtime
