/// What a container answers while it runs: requests on /kervan/<container>/request, replies on
/// /kervan/<container>/reply. Every request may be repeated. The same id gets the same reply again, without a second
/// effect.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <string>

#include "framework/component/registry.hpp"
#include "framework/dds/endpoint.hpp"
#include "framework/runtime/container.hpp"
#include "framework/runtime/operations.hpp"
#include "kervan_msgs/msg/ContainerReply.hpp"
#include "kervan_msgs/msg/ContainerRequest.hpp"

namespace kervan::container {

std::string request_topic(const std::string& container);
std::string reply_topic(const std::string& container);

/// The profile of both topics.
QosProfile service_profile();

class ContainerService final : public dds::SampleSink {
 public:
  /// Replies that are remembered for repetitions.
  static constexpr std::size_t kRemembered = 256;

  /// `changed` is called after each accepted request that may have changed what the container hosts; it may throw, and
  /// then the reply says so. The container and the registry must outlive the service.
  ContainerService(runtime::Container& container, ComponentRegistry& registry, std::function<void()> changed = {});
  ~ContainerService();
  ContainerService(const ContainerService&) = delete;
  ContainerService& operator=(const ContainerService&) = delete;

  /// Carries out a request that came at `arrived`, in the thread that runs the container, or gives the reply that its
  /// id got before.
  const kervan_msgs::msg::ContainerReply& answer(const kervan_msgs::msg::ContainerRequest& request,
                                                 std::chrono::steady_clock::time_point arrived);

  void on_sample(const dds::Arrival& arrival) noexcept override;
  void on_writer_gone(std::uint64_t) noexcept override {}
  void on_status() noexcept override {}

 private:
  using Reply = kervan_msgs::msg::ContainerReply;
  using Request = kervan_msgs::msg::ContainerRequest;

  Reply carry_out(const Request& request);
  runtime::Outcome load(const Request& request);
  runtime::Outcome set(const Request& request);
  runtime::Outcome call(const Request& request);
  void describe(const std::string& component, Reply& reply) const;
  void add_parameters(const std::string& component, Reply& reply) const;
  void publish(const Reply& reply);

  runtime::Container& container_;
  ComponentRegistry& registry_;
  std::function<void()> changed_;
  std::map<std::string, Reply> replies_;  ///< by id
  std::deque<std::string> ids_;           ///< of these, oldest first
  dds::Writer writer_;
  dds::Reader reader_;  ///< last: it calls into the members above
};

}  // namespace kervan::container
