#include "bench_msgs/msg/Payload.hpp"
#include "framework/kervan.hpp"
#include "tests/bench/statistics.hpp"

namespace kervan::bench {
namespace {

using bench_msgs::msg::Payload;

struct RelayParams {
  bool first = false;
  Duration period = std::chrono::milliseconds(1);

  template <class Visitor>
  void describe(Visitor& v) {
    v(first, "first", {.help = "Begins the chain: publishes one message per period."});
    v(period, "period", {.min = 1e-4, .max = 10.0, .help = "Time between two messages of the first."});
  }
};

/// One link of a chain: passes every message on.
class Relay final : public Component {
  const RelayParams& params_ = parameters<RelayParams>();
  Input<Payload> in_{this, "in", qos::state.optional(), &Relay::on_message, "From the link before."};
  Output<Payload> out_{this, "out", qos::state, "To the link after."};
  std::unique_ptr<Timer> tick_ =
      params_.first ? std::make_unique<Timer>(this, params_.period, &Relay::on_tick) : nullptr;

  void on_message(const Payload& message, Time) {
    auto next = out_.loan_uncleared();
    next->stamp = message.stamp;
    next->number = message.number;
    next->data.assign(message.data.begin(), message.data.end());
    out_.publish(std::move(next));
  }

  void on_tick(Time) {
    auto message = out_.loan_uncleared();
    message->data.resize(64);
    ++message->number;
    message->stamp = now_ns();
    out_.publish(std::move(message));
  }
};

}  // namespace
}  // namespace kervan::bench

KERVAN_COMPONENT(kervan::bench::Relay, "bench/relay", "One link of a chain: passes every message on.")
