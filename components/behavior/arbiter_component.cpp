#include <spdlog/spdlog.h>

#include <optional>
#include <string>

#include "components/behavior/arbiter.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/ArbitrationState.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"

namespace kervan::behavior {
namespace {

using namespace std::chrono_literals;

enum class Arbitration { requests, ownership };

struct ArbiterParams {
  Duration period = 50ms;
  Arbitration arbitration = Arbitration::requests;

  template <class Visitor>
  void describe(Visitor& v) {
    v(period, "period", {.min = 0.005, .max = 0.2, .help = "Time between two decisions."});
    v(arbitration, "arbitration",
      {.choices = {"requests", "ownership"}, .help = "Who decides: the arbiter, or DDS by strength."});
  }
};

/// Commands what the strongest behaviour requests (arbiter.hpp), every period, and zero if none does. Under ownership
/// the behaviours command by themselves: it says who drives, and commands zero with strength 0, which counts while none
/// of them commands.
class ArbiterComponent final : public Component {
  const ArbiterParams& params_ = parameters<ArbiterParams>();
  Arbiter arbiter_{params_.period};
  Input<kervan_msgs::msg::MotionRequest> requests_{this, "motion_request", qos::command, &ArbiterComponent::on_request,
                                                   "What each behaviour wants."};
  Output<geometry_msgs::msg::TwistStamped> cmd_vel_{this, "cmd_vel_raw", qos::command, "Speed wanted of base_link."};
  Output<kervan_msgs::msg::ArbitrationState> state_{this, "arbitration", qos::event,
                                                    "Who drives, and who would like to."};
  Timer tick_{this, params_.period, &ArbiterComponent::on_tick};
  std::string frame_;
  std::optional<std::string> refused_;  // the behaviour whose last request was
  std::string driving_;
  Time activated_{};

  void on_activate(Time now) override { activated_ = now; }

  void on_request(const Sample<kervan_msgs::msg::MotionRequest>& sample, Time now) {
    if (sample.disposed()) return arbiter_.withdraw(sample->behaviour);
    Request request;
    request.behaviour = sample->behaviour;
    request.priority = sample->priority;
    request.hold = sample->hold;
    request.active = sample->active;
    request.valid_for = geometry::duration_of(sample->valid_for);
    request.twist = geometry::twist_of(sample->twist);
    request.why = sample->why;
    const bool taken = arbiter_.take(now, request);
    if (taken && !sample->header.frame_id.empty()) frame_ = sample->header.frame_id;
    if (!taken)
      refused_ = sample->behaviour;
    else if (refused_ == sample->behaviour)
      refused_.reset();
  }

  void on_tick(Time now) {
    const Decision decision = arbiter_.decide(now);
    command(now, params_.arbitration == Arbitration::ownership ? geometry::Twist2{} : decision.twist);
    publish(now, decision);
    if (decision.behaviour != driving_)
      log().info("{} drives: {}", decision.behaviour.empty() ? "nobody" : decision.behaviour, decision.why);
    driving_ = decision.behaviour;
    if (refused_) return report_degraded("motion_request: refused one of '" + *refused_ + "' that cannot be");
    if (!decision.behaviour.empty()) return report_active();
    // At the first tick nobody can have published yet.
    if (now - activated_ >= 2 * params_.period) report_degraded("the robot stands: " + decision.why);
  }

  void on_deactivate(Time now) override { command(now, {}); }

  void on_shutdown(Time) override {
    if (arbiter_.refused() > 0) log().warn("refused {} requests that could not be", arbiter_.refused());
  }

  void command(Time now, const geometry::Twist2& twist) {
    auto message = cmd_vel_.loan();
    geometry::set_header(message->header, now, frame_);
    message->twist = geometry::to_message(twist);
    cmd_vel_.publish(std::move(message));
  }

  void publish(Time now, const Decision& decision) {
    auto message = state_.loan();
    geometry::set_header(message->header, now, frame_);
    message->behaviour = decision.behaviour;
    message->priority = decision.priority;
    message->why = decision.why;
    message->waiting = decision.waiting;
    message->expired = decision.expired;
    state_.publish(std::move(message));
  }
};

}  // namespace
}  // namespace kervan::behavior

KERVAN_COMPONENT(kervan::behavior::ArbiterComponent, "behavior/arbiter",
                 "Lets the behaviour drive whose request has the highest priority.")
