#include "framework/runtime/status.hpp"

#include "framework/component/sample.hpp"
#include "framework/geometry/messages.hpp"
#include "kervan_msgs/msg/ComponentStatus.hpp"

namespace kervan::runtime {

kervan_msgs::msg::ComponentState to_message(ComponentState state) {
  using kervan_msgs::msg::ComponentState;
  switch (state) {
    case kervan::ComponentState::configured: return ComponentState::COMPONENT_CONFIGURED;
    case kervan::ComponentState::active: return ComponentState::COMPONENT_ACTIVE;
    case kervan::ComponentState::degraded: return ComponentState::COMPONENT_DEGRADED;
    case kervan::ComponentState::failed: return ComponentState::COMPONENT_FAILED;
    case kervan::ComponentState::stopped: return ComponentState::COMPONENT_STOPPED;
  }
  return ComponentState::COMPONENT_FAILED;
}

QosProfile status_profile() { return {.name = "status", .durability = Durability::transient_local, .trace = false}; }

StatusWriter::StatusWriter(dds::Domain& domain)
    : writer_(domain, kStatusTopic, type_support<kervan_msgs::msg::ComponentStatus>(), status_profile(),
              dds::CyclonePart::whole_profile, 0, dds::kInternal) {}

void StatusWriter::publish(const ComponentInstance& instance, const std::string& container, Time now) {
  publish(instance, container, now, false);
}

void StatusWriter::remove(const ComponentInstance& instance, const std::string& container, Time now) {
  publish(instance, container, now, true);
}

void StatusWriter::publish(const ComponentInstance& instance, const std::string& container, Time now, bool dispose) {
  const std::lock_guard lock(mutex_);
  dds::SampleBlock* block = writer_.loan(true);
  auto& message = *static_cast<kervan_msgs::msg::ComponentStatus*>(dds::mutable_value_of(block));
  message.component = instance.name();
  message.stamp = geometry::to_message(now);
  message.container = container;
  message.state = to_message(instance.state());
  message.reason = instance.reason();
  for (const auto& input : instance.inputs()) {
    const PortCounters counters = input->counters();
    auto& port = message.ports.emplace_back();
    port.name = input->name();
    port.topic = input->binding().topic;
    port.received = counters.received;
    port.handled = counters.handled;
    port.overwritten = counters.overwritten;
    port.expired = counters.expired;
    port.refused = counters.refused;
    port.not_owner = counters.not_owner;
    port.deadline_missed = counters.deadline_missed;
    port.liveliness_lost = counters.liveliness_lost;
    port.late = counters.late;
    port.lost = counters.lost;
    port.undecodable = counters.undecodable;
    port.worst_latency = seconds(counters.worst_latency);
    port.trouble = input->health().trouble();
  }
  for (const auto& output : instance.outputs()) {
    auto& port = message.ports.emplace_back();
    port.name = output->name();
    port.topic = output->binding().topic;
    port.output = true;
    port.published = output->published();
    port.trouble = output->health().trouble();
  }
  writer_.publish(block, now, dispose);
}

}  // namespace kervan::runtime
