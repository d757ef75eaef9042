#include "framework/runtime/clock_reader.hpp"

#include <utility>

#include "framework/component/sample.hpp"
#include "framework/dds/type_support.hpp"
#include "framework/geometry/messages.hpp"
#include "rosgraph_msgs/msg/Clock.hpp"

namespace kervan::runtime {

std::optional<ClockWriter> clock_writer(const ContainerSpec& spec) {
  for (const ComponentSpec& component : spec.components)
    for (const PortBinding& port : component.ports)
      if (port.topic == kClockTopic && port.direction == PortDirection::output)
        return ClockWriter{component.name, component.container, port.profile.reliability};
  return std::nullopt;
}

ClockReader::ClockReader(dds::Domain& domain, ContainerClock& clock, Reliability reliability)
    : clock_(clock),
      reader_(domain, kClockTopic, type_support<rosgraph_msgs::msg::Clock>(),
              {.name = "clock", .reliability = reliability, .trace = false}, dds::CyclonePart::untimed, *this) {}

void ClockReader::on_move(std::function<void()> moved) {
  const std::lock_guard lock(mutex_);
  moved_ = std::move(moved);
}

bool ClockReader::wait_for_first(Steady::time_point deadline) {
  std::unique_lock lock(mutex_);
  return first_.wait_until(lock, deadline, [this] { return heard_; });
}

Duration ClockReader::silence() const {
  const std::lock_guard lock(mutex_);
  return Steady::now() - last_;
}

bool ClockReader::writer_gone() const {
  const std::lock_guard lock(mutex_);
  return gone_;
}

void ClockReader::on_sample(const dds::Arrival& arrival) noexcept {
  if (dds::is_disposed(arrival.block)) return;
  const auto& message = *static_cast<const rosgraph_msgs::msg::Clock*>(dds::value_of(arrival.block));
  const std::lock_guard lock(mutex_);
  clock_.move_to(geometry::time_of(message.clock));
  last_ = Steady::now();
  gone_ = false;
  if (!std::exchange(heard_, true)) first_.notify_all();
  if (moved_) moved_();
}

void ClockReader::on_writer_gone(std::uint64_t) noexcept {
  const std::lock_guard lock(mutex_);
  gone_ = true;
}

}  // namespace kervan::runtime
