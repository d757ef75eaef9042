/// A composition as its file says it, with arguments filled in and templates expanded, but not yet compared with what
/// the components say of themselves; resolve.hpp does that.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "deploy/composition/links.hpp"
#include "framework/component/parameters.hpp"
#include "framework/component/time.hpp"
#include "framework/config/node.hpp"

namespace kervan::composition {

enum class ClockMode { wall, sim, lockstep };
std::string_view to_text(ClockMode mode);

struct Clock {
  ClockMode mode = ClockMode::wall;
  std::optional<Duration> step;  ///< the parameter `step` of the component that writes /clock, if it is given here
  Location step_location = {};
  double pace = 1.0;       ///< simulated time over wall time; 0 is as fast as possible
  Location location = {};  ///< of its mode
};

struct Host {
  std::string name;
  std::string interface;  ///< of the network, empty if any
  std::string address;    ///< where the others find it, empty if on the same machine
  Location location = {};
};

struct Domain {
  int id = 0;
  std::string tag;        ///< only those with the same tag see each other; empty: all without one
  bool multicast = true;  ///< whether the network carries it
  std::vector<Host> hosts;
};

/// One component instance. What its type must confirm (parameters, ports) is kept as written.
struct ComponentEntry {
  std::string name;       ///< "world", "r1/control"
  std::string scope;      ///< the template instance it belongs to ("r1"), empty for the file's own components
  config::Node type;      ///< "control/potential_field"
  config::Node params;    ///< a map
  config::Node remap;     ///< a map: port -> topic or component/port
  config::Node strength;  ///< a map: output -> strength under exclusive ownership
  std::string log_level;  ///< trace, debug, info, warn, error or off
  Location location;      ///< where its name stands
};

struct ProfileEntry {
  std::string name;
  config::Node settings;  ///< `extends` and the values
};

struct TopicEntry {
  std::string pattern;    ///< absolute, may hold wildcards
  config::Node settings;  ///< `qos`, `external` and the values
};

enum class RestartPolicy {
  never,
  on_failure,  ///< after a crash, a kill, a hang
  always,      ///< also when the container was ended from outside
};

/// What becomes of a container whose process ended before the run did. Under clock lockstep none is started again.
struct Restart {
  RestartPolicy policy = RestartPolicy::on_failure;
  int max = 5;  ///< more restarts than this within `window` end the attempts
  Duration window = std::chrono::seconds(30);
  Duration backoff = std::chrono::milliseconds(100);  ///< before the first restart; doubled for each one after it
  Duration longest_backoff = std::chrono::seconds(5);
  int quarantine = 0;  ///< a component that crashed so often within `window` gets a container of its own; 0: never
};

struct Container {
  std::string name;
  std::string host;                     ///< empty: whichever runs it
  std::vector<std::string> components;  ///< full names, in the composition's order
  int threads = 1;
  Restart restart;
  Location location;
};

/// An argument, or a parameter of a template: declared like a component's parameter.
struct Argument {
  ParameterInfo info;
  std::optional<config::Node> value;  ///< given, or the default; none for a declaration that must be given
  Location location;
};

struct Composition {
  std::string name;
  std::string help;
  std::string file;              ///< as shown in messages
  std::filesystem::path folder;  ///< relative paths are looked up here first
  std::vector<Argument> arguments;
  Clock clock;
  Domain domain;
  Links links;                 ///< between the hosts, where they are emulated
  std::string host;            ///< the one that `--host` says this is; empty: not said
  bool emulate_hosts = false;  ///< this machine plays all of them, over a network of its own
  std::vector<ProfileEntry> profiles;
  std::vector<TopicEntry> topics;
  std::vector<ComponentEntry> components;  ///< in the file's order, a template's where its instance stands
  std::vector<Container> containers;       ///< every component is in exactly one

  const ComponentEntry* component(std::string_view full_name) const;
};

}  // namespace kervan::composition
