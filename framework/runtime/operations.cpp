#include "framework/runtime/operations.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "framework/dds/wall_clock.hpp"
#include "framework/runtime/container.hpp"
#include "framework/runtime/dispatcher.hpp"
#include "framework/runtime/instance.hpp"

namespace kervan::runtime {

namespace {

std::string in_quotes(const std::string& name) { return "'" + name + "'"; }

std::string joined(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list.empty() ? "none" : list;
}

std::string hint(const std::string& word, const std::vector<std::string>& known, const std::string& label) {
  const auto near = nearest(word, known);
  return (near ? "; did you mean " + in_quotes(*near) + "? " : "; ") + label + ": " + joined(known);
}

/// Letters, digits, underscores; slashes between the parts; each part begins with a letter.
bool is_name(std::string_view text) {
  bool begins = true;
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    if (begins ? !std::isalpha(u) : c != '/' && c != '_' && !std::isalnum(u)) return false;
    begins = c == '/';
  }
  return !begins;
}

bool is_topic(std::string_view text) { return text.starts_with('/') && is_name(text.substr(1)); }

/// The topic that a port of this component has in a composition that says nothing else.
std::string topic_of(const std::string& component, const std::string& port) {
  if (port.starts_with('/')) return port;
  const std::size_t slash = component.rfind('/');
  return "/" + (slash == std::string::npos ? "" : component.substr(0, slash + 1)) + port;
}

template <class Names>
void add_name(Names& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

}  // namespace

void Operations::post(std::function<void()> work) {
  {
    const std::lock_guard lock(mutex_);
    posted_.push_back(std::move(work));
    pending_ = true;
  }
  container_.wake();
}

void Operations::run_posted() {
  if (!pending_.load(std::memory_order_relaxed)) return;
  std::vector<std::function<void()>> work;
  {
    const std::lock_guard lock(mutex_);
    work.swap(posted_);
    pending_ = false;
  }
  for (const auto& one : work) one();
}

template <class Work>
Outcome Operations::attempt(Work&& work) {
  try {
    Outcome outcome{true, work()};
    if (changed) changed();
    return outcome;
  } catch (const Refused& refused) {
    return {false, refused.why};
  } catch (const std::exception& error) {
    return {false, error.what()};
  }
}

std::string Operations::known_components(const std::string& name) const {
  std::vector<std::string> names;
  for (const auto& instance : container_.instances()) names.push_back(instance->name());
  return hint(name, names, "there are");
}

ComponentInstance& Operations::find(const std::string& name) const {
  if (ComponentInstance* instance = container_.find(name)) return *instance;
  throw Refused{"there is no component " + in_quotes(name) + " in container " + in_quotes(container_.spec().name) +
                known_components(name)};
}

void Operations::hold(ComponentInstance& instance) {
  Dispatcher* const dispatcher = instance.dispatcher.load();
  if (!dispatcher) return;  // lockstep, between two times: nobody is in any component
  const auto until = std::chrono::steady_clock::now() + patience_;
  const auto give_up = [&] { return container_.ending() || std::chrono::steady_clock::now() >= until; };
  if (dispatcher->hold(instance, give_up)) return;
  if (container_.ending()) throw Refused{"the container is ending"};
  char seconds_in_it[32];
  std::snprintf(seconds_in_it, sizeof seconds_in_it, "%.1f s", seconds(instance.time_in_handler()));
  throw Refused{in_quotes(instance.name()) + " has been in a handler for " + seconds_in_it + " and did not come back"};
}

void Operations::release(ComponentInstance& instance) {
  if (instance.take_status_due(container_.present().time)) container_.publish_status(instance);
  if (Dispatcher* const dispatcher = instance.dispatcher.load()) dispatcher->release(instance);
}

/// Peers in lockstep know each other's writers and readers, and wait for exactly these.
void Operations::require_alone(const char* what) const {
  if (container_.spec().clock == ClockMode::lockstep && container_.spec().members.size() > 1)
    throw Refused{std::string("under lockstep a container that has peers cannot ") + what +
                  " components: all of them would have to know it at one logical time"};
}

const ComponentSpec* Operations::in_composition(const std::string& name) const {
  for (const ComponentSpec& component : container_.spec().components)
    if (component.name == name) return &component;
  return nullptr;
}

/// What was asked for, with what the composition says of the component, if it knows it.
ComponentSpec Operations::completed(const ComponentSpec& wanted) const {
  const ComponentSpec* known = in_composition(wanted.name);
  if (known && !is_local(container_.spec(), *known))
    throw Refused{in_quotes(wanted.name) + " belongs to container " + in_quotes(known->container)};
  if (!known || (!wanted.type.empty() && wanted.type != known->type)) {
    if (wanted.type.empty())
      throw Refused{"the composition knows no component " + in_quotes(wanted.name) +
                    ", so its type is needed; there are: " + joined(registry_.names())};
    return wanted;
  }
  ComponentSpec spec = *known;
  for (const auto& [name, value] : wanted.parameters) spec.parameters[name] = value;
  for (const PortBinding& port : wanted.ports) {
    std::erase_if(spec.ports, [&](const PortBinding& old) { return old.port == port.port; });
    spec.ports.push_back(port);
  }
  if (!wanted.log_level.empty()) spec.log_level = wanted.log_level;
  return spec;
}

/// In what a component that is there is not what was asked for; empty if it is.
std::string Operations::difference(const ComponentInstance& there, const ComponentSpec& wanted) const {
  if (!wanted.type.empty() && wanted.type != there.type()) return "a " + there.type();
  for (const ParameterState& parameter : parameters(there.name())) {
    const auto other = wanted.parameters.find(parameter.info.name);
    if (other != wanted.parameters.end() && other->second != parameter.value)
      return "with " + parameter.info.name + " = " + to_text(parameter.value);
  }
  const auto differs = [&](const PortBinding& is) {
    return std::any_of(wanted.ports.begin(), wanted.ports.end(),
                       [&](const PortBinding& port) { return port.port == is.port && port.topic != is.topic; });
  };
  for (const auto& port : there.inputs())
    if (differs(port->binding())) return "with " + port->name() + " on " + port->binding().topic;
  for (const auto& port : there.outputs())
    if (differs(port->binding())) return "with " + port->name() + " on " + port->binding().topic;
  return {};
}

Manifest Operations::manifest_of(const ComponentSpec& spec) const {
  try {
    const ComponentClass* type = registry_.find(spec.type);
    if (!type)
      throw Refused{"there is no component type " + in_quotes(spec.type) +
                    hint(spec.type, registry_.names(), "there are")};
    return describe(*type, spec.parameters);
  } catch (const std::exception& error) {
    throw Refused{in_quotes(spec.type) + " cannot be loaded: " + error.what()};
  }
}

/// Gives every port its topic, and every topic one profile.
void Operations::bind_ports(ComponentSpec& spec, const Manifest& manifest) const {
  std::vector<std::string> names;
  for (const PortInfo& port : manifest.ports) names.push_back(port.name);
  for (const PortBinding& given : spec.ports)
    if (!manifest.port(given.port))
      throw Refused{in_quotes(spec.type) + " has no port " + in_quotes(given.port) + hint(given.port, names, "it has")};

  std::vector<PortBinding> bindings;
  for (const PortInfo& port : manifest.ports) {
    PortBinding binding{.port = port.name,
                        .topic = topic_of(spec.name, port.name),
                        .profile = builtin_profile(port.qos.profile()).value(),
                        .direction = port.direction,
                        .type = port.type,
                        .layout_hash = port.layout_hash,
                        .optional = port.qos.is_optional()};
    for (const PortBinding& given : spec.ports)
      if (given.port == port.name) {
        binding.topic = given.topic;
        binding.profile = given.type.empty() ? binding.profile : given.profile;
      }
    if (!is_topic(binding.topic))
      throw Refused{"port " + in_quotes(port.name) + ": " + in_quotes(binding.topic) +
                    " is no topic; write an absolute name, such as " + topic_of(spec.name, port.name)};
    const auto meet = [&](const PortBinding& other, const std::string& type) {
      if (other.topic != binding.topic) return;
      if (!type.empty() && type != binding.type)
        throw Refused{"port " + in_quotes(port.name) + " carries " + binding.type + ", but " + binding.topic +
                      " carries " + type};
      binding.profile = other.profile;
    };
    for (const ComponentSpec& component : container_.spec().components)
      for (const PortBinding& other : component.ports) meet(other, other.type);
    for (const auto& instance : container_.instances()) {
      for (const auto& other : instance->inputs()) meet(other->binding(), other->type().name);
      for (const auto& other : instance->outputs()) meet(other->binding(), other->type().name);
    }
    bindings.push_back(std::move(binding));
  }
  spec.ports = std::move(bindings);
}

Outcome Operations::load(const ComponentSpec& wanted) {
  if (const ComponentInstance* there = container_.find(wanted.name)) {
    const std::string other = difference(*there, wanted);
    if (other.empty()) return {true, "already loaded"};
    return {false, in_quotes(wanted.name) + " is loaded already, " + other + "; unload it first"};
  }
  return attempt([&]() -> std::string {
    require_alone("load");
    if (!is_name(wanted.name))
      throw Refused{in_quotes(wanted.name) +
                    " is no name of a component; allowed: letters, digits and underscores, with slashes between parts"};
    ComponentSpec spec = completed(wanted);
    if (spec.log_level.empty()) spec.log_level = "info";
    bind_ports(spec, manifest_of(spec));
    ComponentInstance* instance = nullptr;
    try {
      instance = &container_.add(spec);
    } catch (const std::exception& error) {
      throw Refused{in_quotes(spec.type) + " cannot be loaded: " + error.what()};
    }
    instance->activate(container_.present());
    if (instance->state() == ComponentState::failed) {
      const std::string why = instance->reason();
      container_.remove(*instance);
      throw Refused{in_quotes(spec.type) + " cannot be loaded: " + why};
    }
    const ComponentSpec* known = in_composition(spec.name);
    if (known && known->type == spec.type && wanted.parameters.empty() && wanted.ports.empty())
      std::erase(container_.spec_.absent, spec.name);  // it is as the composition has it
    else
      container_.spec_.loaded.push_back(std::move(spec));
    // Before a thread may be in it: afterwards the component publishes its status itself.
    if (instance->take_status_due(container_.present().time)) container_.publish_status(*instance);
    container_.attach(*instance);
    return "";
  });
}

Outcome Operations::unload(const std::string& name) {
  if (!container_.find(name)) {
    const auto& absent = container_.spec().absent;
    if (unloaded_.contains(name) || std::find(absent.begin(), absent.end(), name) != absent.end())
      return {true, "already unloaded"};
  }
  return attempt([&]() -> std::string {
    ComponentInstance& instance = find(name);
    require_alone("unload");
    hold(instance);
    const Instant now = container_.present();
    instance.deactivate(now);
    for (const auto& output : instance.outputs()) output->dispose_all();
    instance.shutdown(now);
    container_.remove(instance);
    unloaded_.insert(name);
    std::erase(container_.spec_.inactive, name);
    std::erase_if(container_.spec_.loaded, [&](const ComponentSpec& spec) { return spec.name == name; });
    if (in_composition(name)) add_name(container_.spec_.absent, name);
    return "";
  });
}

Outcome Operations::activate(const std::string& name) {
  return attempt([&]() -> std::string {
    ComponentInstance& instance = find(name);
    hold(instance);
    const bool active = instance.running();
    const bool failed = instance.state() == ComponentState::failed;
    std::optional<std::string> failure;
    if (failed)
      failure = " has failed: " + instance.reason() + "; unload it and load it again";
    else if (!active) {
      instance.activate(container_.present());
      if (instance.state() == ComponentState::failed) failure = " failed: " + instance.reason();
    }
    release(instance);
    if (failure) throw Refused{in_quotes(name) + *failure};
    std::erase(container_.spec_.inactive, name);
    return active ? "already active" : "";
  });
}

Outcome Operations::deactivate(const std::string& name) {
  return attempt([&]() -> std::string {
    ComponentInstance& instance = find(name);
    hold(instance);
    const bool active = instance.running();
    const bool failed = instance.state() == ComponentState::failed;
    const std::string why = instance.reason();
    if (active) {
      instance.deactivate(container_.present());
      instance.stop("deactivated on request");
    }
    release(instance);
    if (failed) throw Refused{in_quotes(name) + " has failed: " + why};
    add_name(container_.spec_.inactive, name);
    return active ? "" : "already inactive";
  });
}

Outcome Operations::change_parameters(const std::string& name, const ValueMap& changes) {
  return attempt([&]() -> std::string {
    ComponentInstance& instance = find(name);
    hold(instance);
    std::optional<std::string> refused;
    if (instance.state() == ComponentState::failed)
      refused = in_quotes(name) + " has failed: " + instance.reason();
    else
      refused = instance.change_parameters(changes, container_.present());
    release(instance);
    if (refused) throw Refused{*refused};
    for (auto* list : {&container_.spec_.components, &container_.spec_.loaded})
      for (ComponentSpec& spec : *list)
        if (spec.name == name) spec.parameters = instance.values();
    return "";
  });
}

Outcome Operations::call(const std::string& name, const std::string& request, const ValueMap& arguments) {
  return attempt([&]() -> std::string {
    ComponentInstance& instance = find(name);
    std::vector<std::string> names;
    const RequestBase* wanted = nullptr;
    for (const RequestBase* one : instance.requests()) {
      names.push_back(one->info().name);
      if (one->info().name == request) wanted = one;
    }
    if (!wanted)
      throw Refused{in_quotes(name) + " has no request " + in_quotes(request) + hint(request, names, "it has")};
    hold(instance);
    Outcome outcome;
    if (instance.running())
      outcome = instance.call(*wanted, arguments, container_.present());
    else
      outcome.reason = in_quotes(name) + " does not run, it is " + std::string(to_text(instance.state()));
    release(instance);
    if (!outcome.accepted) throw Refused{outcome.reason};
    return outcome.reason;
  });
}

std::vector<ParameterInfo> Operations::arguments(const std::string& name, const std::string& request) const {
  if (const ComponentInstance* instance = container_.find(name))
    for (const RequestBase* one : instance->requests())
      if (one->info().name == request) return one->info().arguments;
  return {};
}

std::vector<ParameterState> Operations::parameters(const std::string& name) const {
  std::vector<ParameterState> states;
  const ComponentInstance* instance = container_.find(name);
  if (!instance) return states;
  for (const ParameterInfo& info : instance->schema()) {
    const auto value = instance->values().find(info.name);
    const bool given = value != instance->values().end() && !value->second.empty();
    states.push_back({info, given ? value->second : info.default_value, given});
  }
  return states;
}

}  // namespace kervan::runtime
