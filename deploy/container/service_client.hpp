/// Asks a container that runs, in this process or elsewhere on the network.
#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "framework/dds/endpoint.hpp"
#include "kervan_msgs/msg/ContainerReply.hpp"
#include "kervan_msgs/msg/ContainerRequest.hpp"

namespace kervan::container {

class ServiceClient final : public dds::SampleSink {
 public:
  /// The domain must outlive the client. Throws DdsError.
  ServiceClient(dds::Domain& domain, std::string container);
  ~ServiceClient();
  ServiceClient(const ServiceClient&) = delete;
  ServiceClient& operator=(const ServiceClient&) = delete;

  /// Gives the request an id if it has none, sends it as soon as the container is there and again until it is answered.
  /// Nothing after `timeout`.
  std::optional<kervan_msgs::msg::ContainerReply> ask(kervan_msgs::msg::ContainerRequest request, Duration timeout);

  void on_sample(const dds::Arrival& arrival) noexcept override;
  void on_writer_gone(std::uint64_t) noexcept override {}
  void on_status() noexcept override {}

 private:
  void send(const kervan_msgs::msg::ContainerRequest& request);

  std::string container_;
  std::mutex mutex_;
  std::condition_variable answered_;
  std::map<std::string, kervan_msgs::msg::ContainerReply> replies_;  ///< under mutex_, by id
  std::string wanted_;                                               ///< under mutex_: the id that is waited for
  dds::Writer writer_;
  dds::Reader reader_;  ///< last: it calls into the members above
};

/// The containers that say on /kervan/containers that they are there, sorted. Waits until nothing new has come for a
/// moment, at most `patience`. A composition of one container says nothing.
std::vector<std::string> containers_heard(dds::Domain& domain, Duration patience);

/// 32 hexadecimal digits that nobody else will choose.
std::string new_request_id();

}  // namespace kervan::container
