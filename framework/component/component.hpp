/// The base of every component. Ports, timers and parameters are members: the class body is the declaration. A
/// component is a .cpp without a header, built with kervan_component() and ended by KERVAN_COMPONENT.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "framework/component/manifest.hpp"
#include "framework/component/parameters.hpp"
#include "framework/component/ports.hpp"
#include "framework/component/request.hpp"

namespace spdlog {
class logger;
}

namespace kervan {

namespace runtime {
class ComponentInstance;
}

enum class ComponentState {
  configured,  ///< constructed, not yet running
  active,      ///< running
  degraded,    ///< running, but without something it needs; see the reason
  failed,      ///< a handler threw, or it failed itself; it gets no more samples and timers
  stopped,     ///< ended in good order
};
std::string_view to_text(ComponentState state);

/// What a component is constructed with. Only the framework makes one.
struct ComponentSetup {
  std::string name = "component";  ///< as in the composition: "r1/control"
  const ValueMap* parameters = nullptr;
  std::filesystem::path run_folder;  ///< empty when nothing is to be written
  bool describing = false;           ///< only the declarations matter: a required parameter may be missing
  std::vector<ParameterInfo>* declared = nullptr;  ///< receives the parameters, also if the constructor throws later
};

class Component {
 public:
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;
  virtual ~Component();

  const std::string& name() const { return name_; }
  ComponentState state() const { return state_; }
  const std::string& reason() const { return reason_; }  ///< why, when degraded or failed

 protected:
  Component();

  /// The parameters of the composition, checked against P's describe lines; once in a component's life. The reference
  /// stays good, and behind it live parameters change between two handlers; a copy stays as it is. Throws
  /// ParameterError.
  template <class P>
  const P& parameters() {
    declare_parameters(schema_of<P>());
    auto held = std::make_unique<detail::HeldParameters<P>>(values_);
    const P& parameters = held->parameters;
    held_ = std::move(held);
    return parameters;
  }

  /// Only the declarations are wanted: a required parameter may still have its default (an empty path, an empty map).
  bool describing() const { return describing_; }

  /// Handlers block for long (a planner): the component gets a thread of its own instead of the container's.
  void wants_own_thread() { own_thread_ = true; }

  /// All ports exist and match; runs once before the first handler.
  virtual void on_activate(Time) {}
  /// Live parameters have changed, what parameters() refers to already has the new values: pass them on to whatever
  /// keeps a copy. What it throws as ParameterError refuses the change; then it is called again, with the old values.
  virtual void on_parameters_changed() {}
  /// The run ends: say last words (a zero command). Samples published here still reach the others.
  virtual void on_deactivate(Time) {}
  /// After everybody's last words: write files, join threads. Nothing can be published any more.
  virtual void on_shutdown(Time) {}

  /// Works again, or for the first time.
  void report_active();
  /// Runs on, but not as it should: `why` is one sentence. Calling it again with the same sentence costs nothing.
  void report_degraded(std::string why);

  /// Ends the whole run in good order once everything at the present time has been handled.
  void finish(std::string why);

  /// The time of the handler that runs; for code that is not handed it.
  Time now() const;

  /// Under lockstep the same run gives the same trace every time: a handler that may take only so long counts its work
  /// instead of looking at a clock. False before the component is activated.
  bool lockstep() const;

  /// This component's logger: to the console, the run's folder and /rosout. Include <spdlog/logger.h> to use it.
  spdlog::logger& log() const;

  /// Where this run keeps its files; empty when nothing is to be written (tests, check).
  const std::filesystem::path& run_folder() const { return run_folder_; }

  /// What the component has found out about the run, in SI units: becomes part of the run's summary.json under its
  /// name, numbers rounded to the fourth decimal. For on_shutdown(); called again it replaces what was there.
  void write_figures(const ValueMap& figures) const;

 private:
  friend class InputBase;
  friend class OutputBase;
  friend class Timer;
  friend class RequestBase;
  friend class runtime::ComponentInstance;
  friend Manifest describe(const struct ComponentClass& type, const ValueMap& parameters);

  void declare_parameters(std::vector<ParameterInfo> schema);
  /// Gives live parameters new values, all of them or, throwing ParameterError, none.
  void change_parameters(const ValueMap& changes);

  std::string name_;
  bool describing_;
  ValueMap values_;  ///< as given, by the composition and later changes
  std::unique_ptr<detail::ParameterHolder> held_;
  std::vector<ParameterInfo>* declared_;  ///< only valid during construction
  std::filesystem::path run_folder_;
  std::vector<ParameterInfo> schema_;
  std::vector<InputBase*> inputs_;
  std::vector<OutputBase*> outputs_;
  std::vector<Timer*> timers_;
  std::vector<RequestBase*> requests_;
  std::vector<PortInfo*> ports_;  ///< inputs and outputs in order of declaration
  bool own_thread_ = false;
  ComponentState state_ = ComponentState::configured;
  std::string reason_;
  runtime::ComponentInstance* instance_ = nullptr;  ///< set while a container runs it
};

/// A component type: what KERVAN_COMPONENT defines and a module exports.
struct ComponentClass {
  const char* type;  ///< "control/potential_field"; also the module's path below the component folders
  const char* help;  ///< one line
  std::unique_ptr<Component> (*make)();
};

/// Constructs a component of this type with these parameters, for a container or a manifest.
/// Throws ParameterError, or ConfigError when a file that a parameter names is wrong.
std::unique_ptr<Component> construct(const ComponentClass& type, const ComponentSetup& setup);

/// The manifest of a type with these parameters, by construction. Required parameters may be missing; a constructor
/// that cannot do without them throws, unless it asks describing(). Throws what the constructor throws.
Manifest describe(const ComponentClass& type, const ValueMap& parameters);

/// The parameters of a type, known even if it cannot be constructed without some of them.
std::vector<ParameterInfo> parameters_of(const ComponentClass& type);

}  // namespace kervan

/// Ends a component's .cpp: its class, the type name it is loaded by, and one line of help.
#define KERVAN_COMPONENT(Class, type, help)                                                          \
  extern "C" __attribute__((visibility("default"))) const ::kervan::ComponentClass kervan_component; \
  const ::kervan::ComponentClass kervan_component{                                                   \
      type, help, []() -> std::unique_ptr<::kervan::Component> { return std::make_unique<Class>(); }};
