#include <spdlog/spdlog.h>

#include "components/safety/drive_guard.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"

namespace kervan::safety {
namespace {

struct DriveGuardComponentParams {
  DriveGuardParams guard;

  template <class Visitor>
  void describe(Visitor& v) {
    v(guard.period, "period", {.min = 0.005, .max = 0.2, .help = "Time between two commands to the drive."});
    v(guard.timeout, "timeout", {.min = 0.01, .max = 5.0, .help = "The drive brakes by then after the last command."});
    v(guard.travel, "travel", {.min = 0.0, .max = 1.0, .help = "Time that a command may take to the drive."});
    v(guard.max_speed, "max_speed",
      {.unit = "m/s", .min = 0.0, .max = 5.0, .help = "Highest speed, either way.", .live = true});
    v(guard.max_turn, "max_turn",
      {.unit = "rad/s", .min = 0.0, .max = 20.0, .help = "Highest turning rate.", .live = true});
    v(guard.acceleration, "acceleration",
      {.unit = "m/s2", .min = 0.01, .max = 20.0, .help = "Speeding up.", .live = true});
    v(guard.deceleration, "deceleration",
      {.unit = "m/s2", .min = 0.01, .max = 20.0, .help = "Full braking.", .live = true});
    v(guard.turn_acceleration, "turn_acceleration",
      {.unit = "rad/s2", .min = 0.01, .max = 100.0, .help = "Change of the turning rate.", .live = true});
  }
};

/// Stands between whoever steers and the drive (drive_guard.hpp): commands come as they like and leave at a steady
/// rate.
class DriveGuardComponent final : public Component {
  const DriveGuardComponentParams& params_ = checked(parameters<DriveGuardComponentParams>());
  DriveGuard guard_{params_.guard};
  // The port judges the age by when a command was received, the guard by when it was handled. They differ when this
  // component was held up, and then the port is right.
  Input<geometry_msgs::msg::TwistStamped> wanted_{this, "cmd_vel_raw", qos::command.max_age(oldest(params_.guard)),
                                                  &DriveGuardComponent::on_command, "Speed that the controller wants."};
  Output<geometry_msgs::msg::TwistStamped> cmd_vel_{this, "cmd_vel", qos::command, "Speed for the drive."};
  Timer tick_{this, params_.guard.period, &DriveGuardComponent::on_tick};
  std::string frame_;
  bool last_refused_ = false;
  Time activated_{};

  void on_activate(Time now) override { activated_ = now; }

  void on_parameters_changed() override { guard_.set_params(params_.guard); }

  static const DriveGuardComponentParams& checked(const DriveGuardComponentParams& params) {
    if (oldest(params.guard) < Duration::zero())
      throw ParameterError("timeout", "it is shorter than period and travel, so no command would ever be driven");
    return params;
  }

  /// Command that is driven for another period.
  static Duration oldest(const DriveGuardParams& guard) { return guard.timeout - guard.period - guard.travel; }

  void on_command(const geometry_msgs::msg::TwistStamped& wanted, Time now) {
    last_refused_ = !guard_.command(now, geometry::twist_of(wanted.twist));
    frame_ = wanted.header.frame_id;
  }

  void on_tick(Time now) {
    if (!wanted_.latest()) guard_.forget();
    publish(now, guard_.step(now));
    if (last_refused_)
      report_degraded("cmd_vel_raw: refused a command that is not finite");
    else if (guard_.state() == DriveState::following)
      follow();
    else if (now - activated_ >= params_.guard.period)  // At the first tick nobody can have published yet.
      report_degraded(guard_.state() == DriveState::waiting ? "cmd_vel_raw: nothing received yet"
                                                            : "cmd_vel_raw: no fresh command, braking");
  }

  void follow() {
    if (state() == ComponentState::degraded) log().info("fresh commands, driving");
    report_active();
  }

  void on_deactivate(Time now) override {
    publish(now, {});
    log().info("the last command is zero");
  }

  void on_shutdown(Time) override {
    if (guard_.refused() > 0) log().warn("refused {} commands that were not finite", guard_.refused());
  }

  void publish(Time now, const geometry::Twist2& twist) {
    auto message = cmd_vel_.loan();
    geometry::set_header(message->header, now, frame_);
    message->twist = geometry::to_message(twist);
    cmd_vel_.publish(std::move(message));
  }
};

}  // namespace
}  // namespace kervan::safety

KERVAN_COMPONENT(kervan::safety::DriveGuardComponent, "safety/drive_guard",
                 "Limits a robot's commands, and brakes when they stop coming.")
