// Says that it lives, and hears others do so.
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "builtin_interfaces/msg/Time.hpp"
#include "framework/kervan.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;

struct BeaconParams {
  std::string word = "here";

  template <class Visitor>
  void describe(Visitor& v) {
    v(word, "word", {.help = "What it says on the console when it becomes active."});
  }
};

class Beacon final : public Component {
  BeaconParams params_ = parameters<BeaconParams>();
  Output<builtin_interfaces::msg::Time> out_{this, "out", qos::latched, "Its number."};
  Input<builtin_interfaces::msg::Time> in_{this, "in", qos::latched.optional(), &Beacon::on_input, "Another's."};
  Timer tick_{this, 100ms, &Beacon::on_tick};

  void on_activate(Time) override {
    log().warn("{} in {}", params_.word, ::getpid());
    builtin_interfaces::msg::Time number;
    number.sec = ::getpid();
    out_.publish(number);
  }
  void on_tick(Time) {}
  void on_input(const builtin_interfaces::msg::Time& number, Time) { log().warn("heard {}", number.sec); }
};

}  // namespace
}  // namespace kervan::test

KERVAN_COMPONENT(kervan::test::Beacon, "test/beacon", "Says that it lives, and hears others do so.")
