/// How far the containers of a composition are: each publishes its kervan_msgs/msg/ContainerStatus on
/// /kervan/containers and hears the others'.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "framework/dds/endpoint.hpp"
#include "framework/runtime/spec.hpp"
#include "kervan_msgs/msg/ContainerStatus.hpp"

namespace kervan::runtime {

inline constexpr const char* kContainersTopic = "/kervan/containers";

/// The same for two specs whose components, ports, topics and profiles are the same, whatever runs where and with which
/// parameters: files of one computer have other paths on another.
std::uint64_t composition_hash(const ContainerSpec& spec);

class Members final : public dds::SampleSink {
 public:
  /// `changed` is called under Cyclone's locks when another container's status came or went. Throws DdsError.
  Members(dds::Domain& domain, const ContainerSpec& spec, std::function<void()> changed);
  ~Members();

  /// Says how far this container is.
  void publish(kervan_msgs::msg::ContainerPhase phase, const std::string& reason, Time now);

  /// Waits until all others have heard it, but not for one that does not answer.
  void wait_until_heard() const;

  struct Other {
    kervan_msgs::msg::ContainerStatus status;  ///< the latest
    bool answers = true;                       ///< false: its process was silent for longer than it promised
  };
  /// Every other container that is there, members or not, by name; also one that was there and does not answer, dead
  /// or alive.
  std::map<std::string, Other> others() const;

  /// Hash of what this container's composition consists of.
  std::uint64_t composition() const { return own_.composition; }

  void on_sample(const dds::Arrival& arrival) noexcept override;
  void on_writer_gone(std::uint64_t writer) noexcept override;
  void on_writer_lost(std::uint64_t writer) noexcept override;
  void on_writer_alive(std::uint64_t writer) noexcept override { set_answers(writer, true); }
  void on_status() noexcept override {}

 private:
  struct Heard {
    std::uint64_t writer;
    Other other;
  };

  void set_answers(std::uint64_t writer, bool answers) noexcept;

  std::function<void()> changed_;
  kervan_msgs::msg::ContainerStatus own_;
  mutable std::mutex mutex_;
  std::map<std::string, Heard> heard_;  ///< under the mutex, by container
  std::map<std::string, Heard> left_;   ///< under the mutex: the last word of those that are gone
  dds::Writer writer_;
  dds::Reader reader_;  ///< last: it calls into the members above
};

}  // namespace kervan::runtime
