#include "framework/component/component.hpp"

#include <stdexcept>

#include "framework/dds/type_support.hpp"
#include "framework/runtime/container.hpp"
#include "framework/runtime/instance.hpp"

namespace kervan {

namespace {

/// What the component under construction is made with: its members ask for it before its constructor's body runs.
thread_local const ComponentSetup* current_setup = nullptr;

PortInfo port_info(std::string name, PortDirection direction, const TypeSupport& type, PortQos qos, std::string help) {
  return {std::move(name), direction, type.name, type.layout_hash, type.keyed, qos, std::move(help)};
}

}  // namespace

const TypeSupport& detail::require_layout(const TypeSupport& type, std::uint64_t compiled) {
  if (type.layout_hash == compiled) return type;
  throw std::runtime_error(std::string("it was built with another layout of ") + type.name +
                           " than the library of that package which is loaded; build both from the same IDL");
}

std::string_view to_text(ComponentState state) {
  switch (state) {
    case ComponentState::configured: return "configured";
    case ComponentState::active: return "active";
    case ComponentState::degraded: return "degraded";
    case ComponentState::failed: return "failed";
    case ComponentState::stopped: return "stopped";
  }
  return "unknown";
}

Component::Component() {
  if (!current_setup) throw std::logic_error("a component is made by kervan::construct(), a container or a harness");
  name_ = current_setup->name;
  describing_ = current_setup->describing;
  declared_ = current_setup->declared;
  if (current_setup->parameters) values_ = *current_setup->parameters;
  run_folder_ = current_setup->run_folder;
}

Component::~Component() = default;

void Component::declare_parameters(std::vector<ParameterInfo> schema) {
  schema_ = std::move(schema);
  if (declared_) *declared_ = schema_;
  if (held_) throw std::logic_error("a component has one struct of parameters");
  validate(schema_, values_, !describing_);
}

void Component::change_parameters(const ValueMap& changes) {
  if (changes.empty()) return;
  if (!held_) throw ParameterError(changes.begin()->first, "there is no such parameter; this component has none");
  ValueMap wanted = values_;
  for (const auto& [name, value] : changes) wanted[name] = value;
  validate(schema_, wanted);
  require_live(schema_, changes);
  const auto use = [this](const ValueMap& values) {
    held_->load(values);
    on_parameters_changed();
  };
  if (wanted == values_) return;
  try {
    use(wanted);
  } catch (const ParameterError&) {
    use(values_);
    throw;
  }
  values_ = std::move(wanted);
}

void Component::report_active() {
  if (instance_ && state_ != ComponentState::failed) instance_->set_state(ComponentState::active, {});
}

void Component::report_degraded(std::string why) {
  if (instance_ && state_ != ComponentState::failed) instance_->set_state(ComponentState::degraded, std::move(why));
}

void Component::finish(std::string why) {
  if (instance_) instance_->container().request_finish(instance_->index(), std::move(why));
}

bool Component::lockstep() const {
  return instance_ && instance_->container().spec().clock == runtime::ClockMode::lockstep;
}

Time Component::now() const { return instance_ ? instance_->instant().time : Time{}; }

spdlog::logger& Component::log() const {
  if (!instance_) throw std::logic_error("log() is for handlers: a component has no logger while it is constructed");
  return instance_->log();
}

InputBase::InputBase(Component* owner, std::string name, const TypeSupport& type, PortQos qos, Deliver deliver,
                     std::string help)
    : info_(port_info(std::move(name), PortDirection::input, type, qos, std::move(help))),
      type_(type),
      deliver_(std::move(deliver)) {
  owner->inputs_.push_back(this);
  owner->ports_.push_back(&info_);
}

dds::SampleBlock* InputBase::latest_block() const { return port_ ? port_->latest() : nullptr; }

std::vector<dds::SampleBlock*> InputBase::take_blocks() {
  return port_ ? port_->take() : std::vector<dds::SampleBlock*>();
}

std::vector<dds::SampleBlock*> InputBase::instance_blocks() const {
  return port_ ? port_->instances() : std::vector<dds::SampleBlock*>();
}

bool InputBase::waiting() const { return port_ && port_->waiting(); }

std::string InputBase::missing() const { return port_ ? port_->missing() : info_.name + ": not connected yet"; }

OutputBase::OutputBase(Component* owner, std::string name, const TypeSupport& type, PortQos qos, std::string help)
    : info_(port_info(std::move(name), PortDirection::output, type, qos, std::move(help))), type_(type) {
  owner->outputs_.push_back(this);
  owner->ports_.push_back(&info_);
}

dds::SampleBlock* OutputBase::loan_block(bool cleared) {
  if (!port_) throw std::logic_error("output " + info_.name + " can be used in handlers, not in the constructor");
  return port_->loan(cleared);
}

void OutputBase::publish_block(dds::SampleBlock* block, bool dispose) {
  using Operation = runtime::OutputPort::Operation;
  port_->publish(block, dispose ? Operation::dispose : Operation::write);
}

void OutputBase::assert_alive() {
  if (!port_) throw std::logic_error("output " + info_.name + " can be used in handlers, not in the constructor");
  port_->assert_alive();
}

Timer::Timer(Component* owner, Duration period, std::function<void(Time)> handler)
    : period_(period), handler_(std::move(handler)) {
  if (period <= Duration::zero()) throw ParameterError("period", "a timer's period must be longer than 0 s");
  owner->timers_.push_back(this);
}

RequestBase::RequestBase(Component* owner, RequestInfo info, Handler handler)
    : info_(std::move(info)), handler_(std::move(handler)) {
  owner->requests_.push_back(this);
}

std::unique_ptr<Component> construct(const ComponentClass& type, const ComponentSetup& setup) {
  struct Scope {
    const ComponentSetup* outer;
    explicit Scope(const ComponentSetup* setup) : outer(std::exchange(current_setup, setup)) {}
    ~Scope() { current_setup = outer; }
  };
  const Scope scope(&setup);
  return type.make();
}

Manifest describe(const ComponentClass& type, const ValueMap& parameters) {
  ComponentSetup setup;
  setup.name = type.type;
  setup.parameters = &parameters;
  setup.describing = true;
  const std::unique_ptr<Component> component = construct(type, setup);
  Manifest manifest;
  manifest.type = type.type;
  manifest.help = type.help;
  manifest.parameters = component->schema_;
  for (const PortInfo* port : component->ports_) manifest.ports.push_back(*port);
  for (const Timer* timer : component->timers_) manifest.timers.push_back({timer->period()});
  for (const RequestBase* request : component->requests_) manifest.requests.push_back(request->info());
  manifest.own_thread = component->own_thread_;
  return manifest;
}

std::vector<ParameterInfo> parameters_of(const ComponentClass& type) {
  std::vector<ParameterInfo> declared;
  ComponentSetup setup;
  setup.name = type.type;
  setup.describing = true;
  setup.declared = &declared;
  try {
    construct(type, setup);
  } catch (const ConfigError&) {  // it cannot do without a file that a parameter must name
  } catch (const ParameterError&) {
  }
  return declared;
}

const PortInfo* Manifest::port(const std::string& name) const {
  for (const PortInfo& port : ports)
    if (port.name == name) return &port;
  return nullptr;
}

const ParameterInfo* Manifest::parameter(const std::string& name) const {
  for (const ParameterInfo& parameter : parameters)
    if (parameter.name == name) return &parameter;
  return nullptr;
}

}  // namespace kervan
