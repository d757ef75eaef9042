#include "deploy/container/service_client.hpp"

#include <chrono>
#include <random>
#include <set>

#include "deploy/container/service.hpp"
#include "framework/component/sample.hpp"
#include "framework/dds/type_support.hpp"
#include "framework/dds/wall_clock.hpp"
#include "framework/runtime/members.hpp"
#include "kervan_msgs/msg/ContainerStatus.hpp"

namespace kervan::container {

namespace {

using kervan_msgs::msg::ContainerReply;
using kervan_msgs::msg::ContainerRequest;
using kervan_msgs::msg::ContainerStatus;
using Steady = std::chrono::steady_clock;

/// Between two looks at whether the container is there, and between two repetitions of a request.
constexpr auto kLook = std::chrono::milliseconds(10);
constexpr auto kRepeat = std::chrono::milliseconds(500);
/// Nothing new for so long: all have spoken.
constexpr auto kQuiet = std::chrono::milliseconds(300);

/// Keeps the names that come on /kervan/containers.
class Listener final : public dds::SampleSink {
 public:
  explicit Listener(dds::Domain& domain)
      : reader_(domain, runtime::kContainersTopic, type_support<ContainerStatus>(),
                {.name = "containers", .durability = Durability::transient_local, .trace = false},
                dds::CyclonePart::whole_profile, *this) {}

  std::vector<std::string> names(Duration patience) {
    const auto end = Steady::now() + patience;
    std::unique_lock lock(mutex_);
    for (std::size_t seen = ~std::size_t{0}; seen != names_.size() || names_.empty();) {
      const auto now = Steady::now();
      if (now >= end) break;
      seen = names_.size();
      heard_.wait_until(lock, std::min(end, now + kQuiet), [&] { return names_.size() != seen; });
    }
    return {names_.begin(), names_.end()};
  }

  void on_sample(const dds::Arrival& arrival) noexcept override {
    if (dds::is_disposed(arrival.block)) return;
    const std::lock_guard lock(mutex_);
    names_.insert(static_cast<const ContainerStatus*>(dds::value_of(arrival.block))->container);
    heard_.notify_one();
  }
  void on_writer_gone(std::uint64_t) noexcept override {}
  void on_status() noexcept override {}

 private:
  std::mutex mutex_;
  std::condition_variable heard_;
  std::set<std::string> names_;  ///< under mutex_
  dds::Reader reader_;           ///< last: it calls into the members above
};

}  // namespace

std::vector<std::string> containers_heard(dds::Domain& domain, Duration patience) {
  return Listener(domain).names(patience);
}

std::string new_request_id() {
  std::random_device random;
  std::string id;
  for (int i = 0; i < 4; ++i) {
    char digits[9];
    std::snprintf(digits, sizeof digits, "%08x", static_cast<unsigned>(random()));
    id += digits;
  }
  return id;
}

ServiceClient::ServiceClient(dds::Domain& domain, std::string container)
    : container_(std::move(container)),
      writer_(domain, request_topic(container_), type_support<ContainerRequest>(), service_profile(),
              dds::CyclonePart::whole_profile, 0, dds::kInternal),
      reader_(domain, reply_topic(container_), type_support<ContainerReply>(), service_profile(),
              dds::CyclonePart::whole_profile, *this) {}

ServiceClient::~ServiceClient() = default;

void ServiceClient::on_sample(const dds::Arrival& arrival) noexcept {
  if (dds::is_disposed(arrival.block)) return;
  const Sample<ContainerReply> reply(arrival.block);
  const std::lock_guard lock(mutex_);
  if (reply->id != wanted_) return;  // to another client
  replies_.insert_or_assign(reply->id, *reply);
  answered_.notify_one();
}

void ServiceClient::send(const ContainerRequest& request) {
  dds::SampleBlock* block = writer_.loan(false);
  *static_cast<ContainerRequest*>(dds::mutable_value_of(block)) = request;
  writer_.publish(block, dds::wall_now(), false);
}

std::optional<ContainerReply> ServiceClient::ask(ContainerRequest request, Duration timeout) {
  if (request.id.empty()) request.id = new_request_id();
  request.container = container_;
  const auto end = Steady::now() + timeout;
  {
    const std::lock_guard lock(mutex_);
    wanted_ = request.id;
  }
  auto next_send = Steady::time_point::min();
  for (auto now = Steady::now(); now < end; now = Steady::now()) {
    // Both ways must be open: a reply to a reader that is not matched yet is lost, until the request is repeated.
    const bool there = writer_.status().matched > 0 && reader_.status().matched > 0;
    if (there && now >= next_send) {
      request.timeout = std::chrono::duration<double>(end - now).count();
      send(request);
      next_send = now + kRepeat;
    }
    std::unique_lock lock(mutex_);
    const auto until = std::min(end, there ? next_send : now + kLook);
    if (answered_.wait_until(lock, until, [&] { return replies_.contains(request.id); })) {
      ContainerReply reply = std::move(replies_.at(request.id));
      replies_.clear();
      return reply;
    }
  }
  return std::nullopt;
}

}  // namespace kervan::container
