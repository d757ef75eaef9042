#include "deploy/composition/placement.hpp"

#include <algorithm>
#include <set>

#include "deploy/composition/expand.hpp"
#include "deploy/composition/glob.hpp"
#include "framework/component/qos.hpp"

namespace kervan::composition {
namespace {

using config::Node;

/// How often a component crashes before `restart: quarantine` gives it a container of its own.
constexpr int kDefaultQuarantine = 3;

int count_of(const Node& node, int most) {
  const std::int64_t value = node.as_integer();
  if (value < 1 || value > most) node.fail(node.shown() + " is out of range; allowed: 1 .. " + std::to_string(most));
  return static_cast<int>(value);
}

Duration positive(const Node& node) {
  const Duration value = node.as_duration();
  if (value <= Duration::zero()) node.fail(node.shown() + " is out of range; allowed: more than 0 s");
  return value;
}

/// `restart: on-failure`, or a map with more to say.
Restart read_restart(const Node& node) {
  Restart restart;
  if (node.is_map()) node.only_keys({"policy", "max", "window", "backoff", "quarantine"});
  const Node& name = node.is_map() ? node.required("policy") : node;
  const std::string policy = name.as_choice({"never", "on-failure", "always", "quarantine"});
  restart.policy = policy == "never"    ? RestartPolicy::never
                   : policy == "always" ? RestartPolicy::always
                                        : RestartPolicy::on_failure;
  if (!node.is_map()) {
    if (policy == "quarantine") restart.quarantine = kDefaultQuarantine;
    return restart;
  }
  if (restart.policy == RestartPolicy::never && node.children.size() > 1)
    for (const Node& other : node.children)
      if (other.name != "policy")
        other.fail_at_key("'" + other.name + "' has no meaning for a container that is never started again");
  if (const Node* max = node.optional("max")) restart.max = count_of(*max, 1000);
  if (const Node* window = node.optional("window")) restart.window = positive(*window);
  if (const Node* backoff = node.optional("backoff")) {
    restart.backoff = backoff->as_duration();
    if (restart.backoff <= Duration::zero() || restart.backoff > restart.longest_backoff)
      backoff->fail(backoff->shown() + " is out of range; allowed: more than 0 s, at most " +
                    duration_text(restart.longest_backoff));
  }
  if (policy == "quarantine") restart.quarantine = std::min(kDefaultQuarantine, restart.max);
  if (const Node* quarantine = node.optional("quarantine")) {
    const std::int64_t value = quarantine->as_integer();
    // With more crashes than restarts the container would have been given up before.
    if (value < 1 || value > restart.max)
      quarantine->fail(quarantine->shown() + " is out of range; allowed: 1 .. " + std::to_string(restart.max) +
                       ", the largest number of restarts");
    restart.quarantine = static_cast<int>(value);
  }
  return restart;
}

/// Assigns components to containers and remembers what placed each, to name both when one is placed twice.
class Placement {
 public:
  explicit Placement(const std::vector<ComponentEntry>& components)
      : components_(components), placed_(components.size()) {}

  /// `pattern` is a name or pattern of components; `at` says where it stands.
  void place(const std::string& pattern, const Location& at, const std::string& container) {
    bool found = false;
    for (std::size_t i = 0; i < components_.size(); ++i) {
      if (!covers(pattern, components_[i].name)) continue;
      found = true;
      if (placed_[i].container == container) continue;
      if (!placed_[i].container.empty())
        throw ConfigError(at, "the component '" + components_[i].name + "' is already in the container '" +
                                  placed_[i].container + "' (" + to_text(placed_[i].location) +
                                  "); it can be in one only");
      placed_[i] = {container, at};
    }
    if (!found)
      throw ConfigError(at, "there is no component '" + pattern + "'" + config::hint(pattern, names(), "there are"));
  }

  /// The container of a component, nullptr if nothing placed it.
  const std::string* container_of(std::size_t component) const {
    return placed_[component].container.empty() ? nullptr : &placed_[component].container;
  }

 private:
  struct Placed {
    std::string container;
    Location location;
  };

  std::vector<std::string> names() const {
    std::set<std::string> names;
    for (const ComponentEntry& component : components_) {
      names.insert(component.name);
      if (!component.scope.empty()) names.insert(component.scope);
    }
    return {names.begin(), names.end()};
  }

  const std::vector<ComponentEntry>& components_;
  std::vector<Placed> placed_;
};

Container read_container(const Node& node, const Domain& domain) {
  require_name(node, "container");
  node.only_keys({"host", "components", "threads", "restart"});
  Container container;
  container.name = node.name;
  container.location = node.key_location;
  if (const Node* host = node.optional("host")) {
    std::vector<std::string> hosts;
    for (const Host& known : domain.hosts) hosts.push_back(known.name);
    container.host = host->as_text();
    if (std::find(hosts.begin(), hosts.end(), container.host) == hosts.end())
      host->fail("there is no host '" + container.host + "'" +
                 config::hint(container.host, hosts, "under domain.hosts"));
  }
  if (const Node* threads = node.optional("threads")) container.threads = count_of(*threads, 64);
  if (const Node* restart = node.optional("restart")) container.restart = read_restart(*restart);
  return container;
}

/// The containers of a composition while `--place` changes them.
class Containers {
 public:
  Containers(const Composition& composition, const Node* written, const std::string& implied)
      : composition_(composition), of_(composition.components.size()) {
    if (written == nullptr) {
      place_all();
      return;
    }
    if (written->map().empty())
      written->fail("there must be at least one container; leave 'containers' out to have one for all");
    Placement placement(composition.components);
    for (const Node& node : written->map()) {
      containers_.push_back(read_container(node, composition.domain));
      for (const Node& pattern : node.required("components").list())
        placement.place(pattern.as_text(), pattern.location, node.name);
    }
    for (std::size_t i = 0; i < of_.size(); ++i) {
      const ComponentEntry& component = composition.components[i];
      const std::string* container = placement.container_of(i);
      if (container == nullptr && component.name != implied)
        throw ConfigError(component.location, "the component '" + component.name +
                                                  "' is in no container; add it to one under 'containers'");
      of_[i] = container ? *container : containers_.front().name;
    }
    from_file_ = true;
  }

  /// Of the containers that it replaces only the number of threads is kept, the largest.
  void place_all() {
    Container all;
    all.name = "all";
    for (const Container& container : containers_) all.threads = std::max(all.threads, container.threads);
    containers_ = {all};
    std::fill(of_.begin(), of_.end(), all.name);
    from_file_ = false;
  }

  void place_each() {
    std::vector<Container> each;
    for (std::size_t i = 0; i < of_.size(); ++i) {
      Container container = *find(of_[i]);
      container.name = composition_.components[i].name;
      std::replace(container.name.begin(), container.name.end(), '/', '_');
      for (const Container& other : each)
        if (other.name == container.name)
          throw ConfigError({"--place each", 0, 0}, "two components would be in a container '" + container.name + "'");
      container.location = composition_.components[i].location;
      of_[i] = container.name;
      each.push_back(std::move(container));
    }
    containers_ = std::move(each);
    from_file_ = false;
  }

  void move(const std::string& container, const Location& at) {
    if (find(container) != nullptr) return;
    if (from_file_) {
      std::vector<std::string> names;
      for (const Container& known : containers_) names.push_back(known.name);
      throw ConfigError(at, "there is no container '" + container + "'" + config::hint(container, names, "there are") +
                                "; new ones can be split off --place all");
    }
    Container made;
    made.name = container;
    made.location = at;
    made.restart = containers_.front().restart;
    made.threads = containers_.front().threads;
    containers_.push_back(std::move(made));
  }

  void settle(const Placement& moved) {
    for (std::size_t i = 0; i < of_.size(); ++i)
      if (const std::string* container = moved.container_of(i)) of_[i] = *container;
  }

  std::vector<Container> result() {
    for (Container& container : containers_)
      for (std::size_t i = 0; i < of_.size(); ++i)
        if (of_[i] == container.name) container.components.push_back(composition_.components[i].name);
    std::erase_if(containers_, [](const Container& container) { return container.components.empty(); });
    return std::move(containers_);
  }

 private:
  const Container* find(const std::string& name) const {
    for (const Container& container : containers_)
      if (container.name == name) return &container;
    return nullptr;
  }

  const Composition& composition_;
  std::vector<Container> containers_;
  std::vector<std::string> of_;  ///< the container of each component
  bool from_file_ = false;       ///< they are those that the file names
};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

/// `brain=r1/*,r2`
void place_some(const std::string& option, Containers& containers, Placement& placement) {
  const Location at{"--place " + option, 0, 0};
  const std::size_t equals = option.find('=');
  if (equals == std::string::npos)
    throw ConfigError(at, "write --place all, --place each or --place CONTAINER=COMPONENT,COMPONENT");
  Node name = config::scalar("", "", at.file);
  name.name = option.substr(0, equals);
  require_name(name, "container");
  containers.move(name.name, at);
  for (const std::string& pattern : split(option.substr(equals + 1))) {
    if (pattern.empty()) throw ConfigError(at, "a component is missing; write --place CONTAINER=COMPONENT,COMPONENT");
    placement.place(pattern, at, name.name);
  }
}

}  // namespace

std::vector<Container> place_components(const Composition& composition, const Node* written, const std::string& implied,
                                        const std::vector<std::string>& options) {
  Containers containers(composition, written, implied);
  const auto count = [&](const char* word) { return std::count(options.begin(), options.end(), word); };
  if (count("all") + count("each") > 1)
    throw ConfigError({"--place", 0, 0}, "'all' and 'each' say where everything goes, so one of them is enough");
  if (count("all") > 0) containers.place_all();
  if (count("each") > 0) containers.place_each();
  Placement placement(composition.components);
  for (const std::string& option : options)
    if (option != "all" && option != "each") place_some(option, containers, placement);
  containers.settle(placement);
  return containers.result();
}

}  // namespace kervan::composition
