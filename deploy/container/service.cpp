#include "deploy/container/service.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <exception>

#include "deploy/container/parameter_text.hpp"
#include "framework/component/sample.hpp"
#include "framework/dds/type_support.hpp"
#include "framework/dds/wall_clock.hpp"
#include "framework/runtime/status.hpp"

namespace kervan::container {

namespace {

using kervan_msgs::msg::ContainerReply;
using kervan_msgs::msg::ContainerRequest;
using kervan_msgs::msg::ContainerVerb;
using kervan_msgs::msg::NamedText;
using runtime::Outcome;
using Steady = std::chrono::steady_clock;

std::string decimal(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

/// Parses the values that are known; those that are not are left as texts, for the refusal that names them.
ValueMap values_of(const std::vector<NamedText>& given, const std::vector<ParameterInfo>& schema) {
  ValueMap values;
  for (const NamedText& one : given) {
    const auto info = std::ranges::find(schema, one.name, &ParameterInfo::name);
    if (values.contains(one.name)) throw ParameterError(one.name, "is given twice");
    values[one.name] = info == schema.end() ? Value(one.text) : parameter_from_text(*info, one.text);
  }
  return values;
}

/// A container's name as part of a topic's, which takes letters, digits and _ alone. Two names may become one: whoever
/// reads the topic looks for its own name in the request or reply.
std::string topic_part(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

}  // namespace

std::string request_topic(const std::string& container) { return "/kervan/" + topic_part(container) + "/request"; }
std::string reply_topic(const std::string& container) { return "/kervan/" + topic_part(container) + "/reply"; }

QosProfile service_profile() { return {.name = "service", .depth = 100, .trace = false}; }

ContainerService::ContainerService(runtime::Container& container, ComponentRegistry& registry,
                                   std::function<void()> changed)
    : container_(container),
      registry_(registry),
      changed_(std::move(changed)),
      writer_(container.domain(), reply_topic(container.spec().name), type_support<ContainerReply>(), service_profile(),
              dds::CyclonePart::whole_profile, 0, dds::kInternal),
      reader_(container.domain(), request_topic(container.spec().name), type_support<ContainerRequest>(),
              service_profile(), dds::CyclonePart::whole_profile, *this) {}

ContainerService::~ContainerService() = default;

void ContainerService::on_sample(const dds::Arrival& arrival) noexcept {
  if (dds::is_disposed(arrival.block)) return;
  const auto arrived = Steady::now();
  container_.operations().post([this, arrived, request = Sample<ContainerRequest>(arrival.block)] {
    if (request->container == container_.spec().name) publish(answer(*request, arrived));
  });
}

const ContainerReply& ContainerService::answer(const ContainerRequest& request, Steady::time_point arrived) {
  if (const auto known = replies_.find(request.id); known != replies_.end()) return known->second;
  const double age = std::chrono::duration<double>(Steady::now() - arrived).count();
  Reply reply;
  if (age > request.timeout)
    reply.reason = "not carried out: the request has waited for " + decimal(age) +
                   " s, and its sender only waits for " + decimal(request.timeout) + " s";
  else
    reply = carry_out(request);
  reply.id = request.id;
  reply.container = container_.spec().name;
  ids_.push_back(request.id);
  if (ids_.size() > kRemembered) {
    replies_.erase(ids_.front());
    ids_.pop_front();
  }
  return replies_[request.id] = std::move(reply);
}

ContainerReply ContainerService::carry_out(const ContainerRequest& request) {
  runtime::Operations& operations = container_.operations();
  // Whoever asks has to hear of a handler that does not come back before its own time is up.
  operations.set_patience(from_seconds(std::clamp(0.8 * request.timeout, 0.0, 60.0)));
  const bool of_all = request.component.empty() && (request.verb == ContainerVerb::CONTAINER_STATE ||
                                                    request.verb == ContainerVerb::CONTAINER_SNAPSHOT);
  const bool survives = request.verb != ContainerVerb::CONTAINER_STATE &&
                        request.verb != ContainerVerb::CONTAINER_SNAPSHOT &&
                        request.verb != ContainerVerb::CONTAINER_CALL;
  Outcome outcome;
  switch (request.verb) {
    case ContainerVerb::CONTAINER_STATE:
    case ContainerVerb::CONTAINER_SNAPSHOT:
      outcome = of_all || container_.find(request.component)
                    ? Outcome{true, ""}
                    : Outcome{false, "there is no component '" + request.component + "' in container '" +
                                         container_.spec().name + "'" + operations.known_components(request.component)};
      break;
    case ContainerVerb::CONTAINER_LOAD: outcome = load(request); break;
    case ContainerVerb::CONTAINER_UNLOAD: outcome = operations.unload(request.component); break;
    case ContainerVerb::CONTAINER_ACTIVATE: outcome = operations.activate(request.component); break;
    case ContainerVerb::CONTAINER_DEACTIVATE: outcome = operations.deactivate(request.component); break;
    case ContainerVerb::CONTAINER_SET: outcome = set(request); break;
    case ContainerVerb::CONTAINER_CALL: outcome = call(request); break;
  }
  if (outcome.accepted && survives && changed_) {
    try {
      changed_();
    } catch (const std::exception& error) {
      outcome.reason +=
          std::string(outcome.reason.empty() ? "" : "; ") + "done, but it will not survive a restart: " + error.what();
    }
  }
  Reply reply;
  reply.accepted = outcome.accepted;
  reply.reason = outcome.reason;
  if (!reply.accepted) return reply;
  for (const auto& instance : container_.instances()) {
    if (!of_all && instance->name() != request.component) continue;
    describe(instance->name(), reply);
    if (request.verb == ContainerVerb::CONTAINER_SNAPSHOT || request.verb == ContainerVerb::CONTAINER_SET)
      add_parameters(instance->name(), reply);
  }
  if (request.verb == ContainerVerb::CONTAINER_SET)
    std::erase_if(reply.parameters, [&](const auto& parameter) {
      return std::ranges::find(request.parameters, parameter.name, &NamedText::name) == request.parameters.end();
    });
  return reply;
}

Outcome ContainerService::load(const ContainerRequest& request) {
  runtime::ComponentSpec spec{.name = request.component, .type = request.type, .log_level = request.log_level};
  static const std::vector<std::string> levels = {"trace", "debug", "info", "warn", "error", "off"};
  if (!request.log_level.empty() && std::ranges::find(levels, request.log_level) == levels.end())
    return {false, "'" + request.log_level + "' is no level of the log; allowed: trace, debug, info, warn, error, off"};
  std::string type = request.type;
  for (const runtime::ComponentSpec& known : container_.spec().components)
    if (type.empty() && known.name == request.component) type = known.type;
  try {
    const ComponentClass* found = type.empty() ? nullptr : registry_.find(type);
    spec.parameters = values_of(request.parameters, found ? parameters_of(*found) : std::vector<ParameterInfo>());
  } catch (const std::exception& error) {
    return {false, "'" + type + "' cannot be loaded: " + error.what()};
  }
  for (const NamedText& port : request.ports) spec.ports.push_back({.port = port.name, .topic = port.text});
  return container_.operations().load(spec);
}

Outcome ContainerService::set(const ContainerRequest& request) {
  std::vector<ParameterInfo> schema;
  for (const auto& parameter : container_.operations().parameters(request.component)) schema.push_back(parameter.info);
  try {
    return container_.operations().change_parameters(request.component, values_of(request.parameters, schema));
  } catch (const ParameterError& error) {
    return {false, error.what()};
  }
}

Outcome ContainerService::call(const ContainerRequest& request) {
  runtime::Operations& operations = container_.operations();
  try {
    return operations.call(request.component, request.request,
                           values_of(request.parameters, operations.arguments(request.component, request.request)));
  } catch (const ParameterError& error) {
    return {false, error.what()};
  }
}

void ContainerService::describe(const std::string& component, ContainerReply& reply) const {
  const runtime::ComponentInstance* instance = container_.find(component);
  auto& described = reply.components.emplace_back();
  described.name = component;
  described.type = instance->type();
  const auto [state, reason] = instance->status();
  described.state = runtime::to_message(state);
  described.reason = reason;
  if (const double inside = seconds(instance->time_in_handler()); inside > 1.0)
    described.reason += (reason.empty() ? "" : "; ") + ("in a handler for " + decimal(inside) + " s");
  described.loaded = std::ranges::count(container_.spec().loaded, component, &runtime::ComponentSpec::name) != 0;
}

void ContainerService::add_parameters(const std::string& component, ContainerReply& reply) const {
  for (const runtime::ParameterState& parameter : container_.operations().parameters(component)) {
    auto& shown = reply.parameters.emplace_back();
    shown.component = component;
    shown.name = parameter.info.name;
    shown.value = to_parameter_text(parameter.info, parameter.value);
    shown.live = parameter.info.live;
    shown.given = parameter.given;
  }
}

void ContainerService::publish(const ContainerReply& reply) {
  dds::SampleBlock* block = writer_.loan(false);
  *static_cast<ContainerReply*>(dds::mutable_value_of(block)) = reply;
  writer_.publish(block, dds::wall_now(), false);
}

}  // namespace kervan::container
