/// What can be asked of a container while it runs: load and unload components, stop and start them, change parameters,
/// and what the components themselves declare as requests. All of it happens between two handlers of the component
/// concerned, and under lockstep between two logical times. The others run on. What is refused changes nothing.
///
/// The functions that do something are for the thread that is in Container::run(), which calls what was post()ed, and,
/// while nobody is in there, for the thread that owns the container.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "framework/component/registry.hpp"
#include "framework/runtime/outcome.hpp"
#include "framework/runtime/spec.hpp"

namespace kervan::runtime {

class ComponentInstance;
class Container;

/// A parameter of a component that runs, with its present value.
struct ParameterState {
  ParameterInfo info;
  Value value;
  bool given = false;  ///< by the composition or a change; else it is the default
};

class Operations {
 public:
  /// `registry` must outlive this.
  Operations(Container& container, ComponentRegistry& registry) : container_(container), registry_(registry) {}
  Operations(const Operations&) = delete;
  Operations& operator=(const Operations&) = delete;

  /// Has `work` called at the next opportunity by the thread that runs the container. From any thread.
  void post(std::function<void()> work);
  bool pending() const { return pending_.load(); }
  void run_posted();

  /// How long an operation waits for a handler that does not return; while the run ends nobody waits.
  void set_patience(Duration patience) { patience_ = patience; }

  /// Loads and activates a component. One of the composition needs no type and has the composition's parameters and
  /// ports unless others are given. A port that is not given uses "/<scope>/<port>", as in a composition; a topic that
  /// is known here keeps its profile, another one has that which the port declares.
  Outcome load(const ComponentSpec& wanted);
  /// Last words, the end of every instance it published (in key order), then it is gone. Its code stays.
  Outcome unload(const std::string& name);
  Outcome activate(const std::string& name);
  /// Last words; it stays, handles nothing and can be activated again.
  Outcome deactivate(const std::string& name);
  /// All of `changes` or none.
  Outcome change_parameters(const std::string& name, const ValueMap& changes);

  /// A request that the component declares; its answer is the reason of the outcome.
  Outcome call(const std::string& name, const std::string& request, const ValueMap& arguments);
  /// The arguments of a request; none if there is no such component or request.
  std::vector<ParameterInfo> arguments(const std::string& name, const std::string& request) const;

  /// In order of declaration. The component must be there.
  std::vector<ParameterState> parameters(const std::string& name) const;
  /// "; did you mean 'r1/control'? there are: …": the end of a refusal that names no component of this container.
  std::string known_components(const std::string& name) const;

  /// Called after each operation that changed which components there are, whether they are active, or a parameter.
  std::function<void()> changed;

 private:
  struct Refused {
    std::string why;
  };
  template <class Work>
  Outcome attempt(Work&& work);
  ComponentInstance& find(const std::string& name) const;
  void hold(ComponentInstance& instance);
  void release(ComponentInstance& instance);
  void require_alone(const char* what) const;
  const ComponentSpec* in_composition(const std::string& name) const;
  ComponentSpec completed(const ComponentSpec& wanted) const;
  std::string difference(const ComponentInstance& there, const ComponentSpec& wanted) const;
  void bind_ports(ComponentSpec& spec, const Manifest& manifest) const;
  Manifest manifest_of(const ComponentSpec& spec) const;

  Container& container_;
  ComponentRegistry& registry_;
  Duration patience_ = std::chrono::seconds(2);
  std::mutex mutex_;
  std::vector<std::function<void()>> posted_;  ///< under mutex_
  std::atomic<bool> pending_{false};
  std::set<std::string> unloaded_;  ///< names that were here once
};

}  // namespace kervan::runtime
