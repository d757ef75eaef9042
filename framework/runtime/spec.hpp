/// What a container is told to run: plain values, made from a composition or by a test.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/component/manifest.hpp"
#include "framework/component/qos.hpp"
#include "framework/component/value.hpp"
#include "framework/dds/domain.hpp"

namespace kervan::runtime {

/// Which topic a port uses and with what quality of service.
struct PortBinding {
  std::string port;   ///< as the component names it
  std::string topic;  ///< absolute: "/r1/sonar"
  QosProfile profile = {};
  PortDirection direction = PortDirection::input;
  std::string type = {};             ///< as in IDL: "sensor_msgs::msg::Range"
  std::uint64_t layout_hash = 0;     ///< of the type; 0 if not known
  bool optional = false;             ///< an input that may stay without a writer
  std::optional<int> strength = {};  ///< of an output under exclusive ownership; none: as its component declares
};

struct ComponentSpec {
  std::string name;            ///< "r1/control"
  std::string type = {};       ///< "control/potential_field"
  std::string container = {};  ///< where it runs; empty: here
  ValueMap parameters = {};
  /// In the order of declaration. Of a component that runs elsewhere all must be listed; of one that runs here, a port
  /// that is not listed uses "/<port>" and its declared profile.
  std::vector<PortBinding> ports = {};
  std::string log_level = "info";  ///< trace, debug, info, warn, error or off
};

enum class ClockMode {
  wall,      ///< real time
  sim,       ///< the simulator's time: the container that writes /clock runs it at a pace, the others follow
  lockstep,  ///< logical time, as fast as the machine allows, the same trace every time
};

/// The same for every container of a composition but for `name` and what was changed while it ran (`loaded`, `absent`,
/// `inactive` and live parameters), so that all agree on members, order and peers.
struct ContainerSpec {
  std::string name = "main";
  std::vector<std::string> members = {};  ///< the composition's containers, this one included; empty: only this one
  ClockMode clock = ClockMode::wall;
  double pace = 1.0;     ///< clock sim: simulated time over wall time; 0 is as fast as possible
  unsigned threads = 1;  ///< of the dispatcher; a component stays serial whatever the number
  dds::DomainConfig domain;
  std::vector<ComponentSpec> components;   ///< all of the composition, in its order, which is the canonical order
  std::vector<ComponentSpec> loaded = {};  ///< here on request, beside the composition's or in place of an absent one
  std::vector<std::string> absent = {};    ///< components of the composition that were unloaded here
  std::vector<std::string> inactive = {};  ///< components that are here but do not run
  std::filesystem::path run_folder;        ///< empty: nothing is written
  bool log_to_console = true;
  bool publish_log = true;  ///< on /rosout
};

/// Whether this container runs the component.
inline bool is_local(const ContainerSpec& spec, const ComponentSpec& component) {
  return component.container.empty() || component.container == spec.name;
}

}  // namespace kervan::runtime
