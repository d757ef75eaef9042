/// Publishes how each component is: kervan_msgs/msg/ComponentStatus on /kervan/status, keyed by component, latched.
#pragma once

#include <mutex>

#include "framework/dds/endpoint.hpp"
#include "framework/runtime/instance.hpp"
#include "kervan_msgs/msg/ComponentStatus.hpp"

namespace kervan::runtime {

inline constexpr const char* kStatusTopic = "/kervan/status";

class StatusWriter {
 public:
  explicit StatusWriter(dds::Domain& domain);

  void publish(const ComponentInstance& instance, const std::string& container, Time now);
  /// The component is no longer here: its last status, as one that disposes of the instance.
  void remove(const ComponentInstance& instance, const std::string& container, Time now);

 private:
  void publish(const ComponentInstance& instance, const std::string& container, Time now, bool dispose);

  std::mutex mutex_;
  dds::Writer writer_;
};

kervan_msgs::msg::ComponentState to_message(ComponentState state);

/// The profile of the status topic; it names containers, so it stays out of the trace.
QosProfile status_profile();

}  // namespace kervan::runtime
