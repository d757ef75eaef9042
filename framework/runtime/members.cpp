#include "framework/runtime/members.hpp"

#include <unistd.h>

#include <chrono>

#include "framework/component/sample.hpp"
#include "framework/dds/hash.hpp"
#include "framework/dds/type_support.hpp"
#include "framework/geometry/messages.hpp"

namespace kervan::runtime {

namespace {

using kervan_msgs::msg::ContainerStatus;

/// How long the end of a run may wait for containers that have not heard of it.
constexpr Duration kPatience = std::chrono::milliseconds(500);

/// The lease is what a process that died or stopped is noticed by.
QosProfile members_profile() {
  return {.name = "containers",
          .durability = Durability::transient_local,
          .lease = std::chrono::milliseconds(1500),
          .trace = false};
}

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

}  // namespace

std::uint64_t composition_hash(const ContainerSpec& spec) {
  Hash64 hash;
  hash.number(static_cast<int>(spec.clock));
  for (const ComponentSpec& component : spec.components) {
    if (component.container.empty()) continue;  // this container's own addition
    hash.text(component.name);
    hash.text(component.type);
    for (const PortBinding& port : component.ports) {
      hash.text(port.port);
      hash.text(port.topic);
      hash.number(static_cast<int>(port.direction));
      hash.text(port.type);
      hash.number(port.layout_hash);
      hash.number(static_cast<int>(port.profile.reliability));
      hash.number(static_cast<int>(port.profile.durability));
      hash.number(port.profile.depth);
      hash.number(port.profile.deadline.count());
      hash.number(port.profile.lifespan.count());
      hash.number(static_cast<int>(port.profile.ownership));
      hash.number(static_cast<int>(port.profile.liveliness));
      hash.number(port.profile.lease.count());
      for (const std::string& partition : port.profile.partition) hash.text(partition);
    }
  }
  return hash.value();
}

Members::Members(dds::Domain& domain, const ContainerSpec& spec, std::function<void()> changed)
    : changed_(std::move(changed)),
      writer_(domain, kContainersTopic, type_support<ContainerStatus>(), members_profile(),
              dds::CyclonePart::whole_profile, 0, dds::kInternal),
      reader_(domain, kContainersTopic, type_support<ContainerStatus>(), members_profile(),
              dds::CyclonePart::whole_profile, *this) {
  own_.container = spec.name;
  own_.host = host_name();
  own_.pid = getpid();
  own_.composition = composition_hash(spec);
}

Members::~Members() = default;

void Members::publish(kervan_msgs::msg::ContainerPhase phase, const std::string& reason, Time now) {
  own_.phase = phase;
  own_.reason = reason;
  own_.stamp = geometry::to_message(now);
  dds::SampleBlock* const block = writer_.loan(false);
  *static_cast<ContainerStatus*>(dds::mutable_value_of(block)) = own_;
  writer_.publish(block, now, false);
}

void Members::wait_until_heard() const { writer_.wait_for_acknowledgement(kPatience); }

std::map<std::string, Members::Other> Members::others() const {
  std::map<std::string, Other> others;
  const std::lock_guard lock(mutex_);
  for (const auto& [name, heard] : heard_) others.emplace(name, heard.other);
  return others;
}

void Members::set_answers(std::uint64_t writer, bool answers) noexcept {
  {
    const std::lock_guard lock(mutex_);
    for (auto& [name, heard] : heard_)
      if (heard.writer == writer) heard.other.answers = answers;
  }
  changed_();
}

void Members::on_sample(const dds::Arrival& arrival) noexcept {
  if (arrival.writer == writer_.handle() || dds::is_disposed(arrival.block)) return;
  const auto& status = *static_cast<const ContainerStatus*>(dds::value_of(arrival.block));
  {
    const std::lock_guard lock(mutex_);
    heard_.insert_or_assign(status.container, Heard{arrival.writer, {status}});
  }
  changed_();
}

void Members::on_writer_gone(std::uint64_t writer) noexcept {
  {
    // A container that was restarted has spoken through another writer since, and is there. One that did not answer
    // any more goes on not answering.
    const std::lock_guard lock(mutex_);
    std::erase_if(heard_, [&](const auto& entry) {
      const auto& [name, heard] = entry;
      if (heard.writer != writer || !heard.other.answers) return false;
      left_.insert_or_assign(name, heard);
      return true;
    });
  }
  changed_();
}

void Members::on_writer_lost(std::uint64_t writer) noexcept {
  {
    // It was said to be gone just before, and is not: it is silent.
    const std::lock_guard lock(mutex_);
    for (const auto& [name, heard] : left_)
      if (heard.writer == writer) heard_.emplace(name, heard);
    std::erase_if(left_, [&](const auto& entry) { return entry.second.writer == writer; });
  }
  set_answers(writer, false);
}

}  // namespace kervan::runtime
