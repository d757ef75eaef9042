/// The component around every behaviour: its ports, its senses, its request. What differs is the declaration.
#pragma once

#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/behavior/senses.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/BumperState.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "kervan_msgs/msg/StallState.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace kervan::behavior {

/// Who decides: an arbiter that reads everybody's requests, or DDS, by the strength of those who write the command.
enum class Arbitration { requests, ownership };

/// `Declaration` has: a type `Behaviour` with `Params`, step() and set_params(); the constants `name`, `priority` and
/// `hold`; and describe(Behaviour::Params&, visitor), one line a parameter.
template <class Declaration>
struct BehaviourComponentParams {
  Duration period = std::chrono::milliseconds(50);
  Duration valid_for = std::chrono::milliseconds(150);
  std::int64_t priority = Declaration::priority;
  std::int64_t hold = Declaration::hold;
  Arbitration arbitration = Arbitration::requests;
  SensesParams senses;
  typename Declaration::Behaviour::Params behaviour;

  template <class Visitor>
  void describe(Visitor& v) {
    v(period, "period", {.min = 0.01, .max = 1.0, .help = "Time between two requests."});
    v(valid_for, "valid_for", {.min = 0.01, .max = 5.0, .help = "The arbiter forgets a request after this time."});
    v(priority, "priority",
      {.min = 1, .max = 1000, .help = "Of its request; the strength of its command, under ownership."});
    v(hold, "hold", {.min = 0, .max = 1000, .help = "Added to the priority while it drives; not under ownership."});
    v(arbitration, "arbitration",
      {.choices = {"requests", "ownership"}, .help = "Who decides: the arbiter, or DDS by strength."});
    v(senses.side, "side", {.choices = {"right", "left"}, .help = "Where the wall is that the robot follows."});
    v(senses.remember, "remember", {.min = 0.0, .max = 600.0, .help = "How long a contact counts as an obstacle."});
    v(senses.nose, "nose", {.unit = "m", .min = 0.0, .max = 5.0, .help = "From base_link to the front of the robot."});
    v(senses.tail, "tail", {.unit = "m", .min = 0.0, .max = 5.0, .help = "From base_link to its rear."});
    v(senses.half_width, "half_width",
      {.unit = "m",
       .min = 0.0,
       .max = 5.0,
       .help = "From the middle to where a stalled wheel's obstacle is taken to be."});
    Declaration::describe(behaviour, v);
  }
};

/// Publishes what its behaviour wants, every period, as a keyed MotionRequest; under ownership also as a command, as
/// long as it wants to drive. Wants nothing, and reports `degraded`, while sonars or odometry are missing or stale.
template <class Declaration>
class BehaviourComponent final : public Component {
  using Params = BehaviourComponentParams<Declaration>;

  const Params& params_ = checked(parameters<Params>());
  Senses senses_{params_.senses};
  typename Declaration::Behaviour behaviour_{params_.behaviour};
  Input<kervan_msgs::msg::SonarArray> sonar_{this, "sonar", qos::sensor.max_age(std::chrono::milliseconds(500)),
                                             &BehaviourComponent::on_sonar, "What the sonars hear."};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor.max_age(std::chrono::milliseconds(500)),
                                       "Where the robot is by its wheels."};
  Input<kervan_msgs::msg::BumperState> bumpers_{this, "bumpers", qos::latched.optional(), "Which bumpers are pressed."};
  Input<kervan_msgs::msg::StallState> stall_{this, "stall", qos::latched.optional(), "Which wheels are stalled."};
  Output<kervan_msgs::msg::MotionRequest> request_{this, "motion_request", qos::command, "What it wants."};
  std::optional<Output<geometry_msgs::msg::TwistStamped>> command_ = command();
  Timer tick_{this, params_.period, &BehaviourComponent::on_tick};
  std::vector<SonarReading> readings_;
  std::vector<geometry::Vector2> pressed_;
  std::string misfit_;
  bool driving_ = false;  // under ownership: its last command may still count
  Time activated_{};

  static const Params& checked(const Params& params) {
    if (params.valid_for <= params.period)
      throw ParameterError("valid_for",
                           "it is no longer than the period, so each request would be forgotten before the next");
    return params;
  }

  std::optional<Output<geometry_msgs::msg::TwistStamped>> command() {
    if (params_.arbitration != Arbitration::ownership) return std::nullopt;
    return std::optional<Output<geometry_msgs::msg::TwistStamped>>(
        std::in_place, this, "cmd_vel_raw", qos::command.strength(static_cast<int>(params_.priority)),
        "Speed wanted of base_link, while it wants to drive.");
  }

  void on_activate(Time now) override { activated_ = now; }

  void on_parameters_changed() override { behaviour_.set_params(params_.behaviour); }

  void on_sonar(const kervan_msgs::msg::SonarArray& sonar, Time now) {
    readings_.clear();
    for (const auto& reading : sonar.readings)
      readings_.push_back(
          {{static_cast<double>(reading.x), static_cast<double>(reading.y), static_cast<double>(reading.yaw)},
           static_cast<double>(reading.range)});
    misfit_ = senses_.hear(readings_, static_cast<double>(sonar.max_range), now);
  }

  void on_tick(Time now) {
    const std::string why = trouble(now);
    if (why.empty()) {
      if (senses_.absurd())
        report_degraded("sonar: negative ranges are left out");
      else
        report_active();
      return publish(now, senses_.unmirrored(behaviour_.step(senses_.at(now))));
    }
    // At the first tick nobody can have published yet.
    if (now - activated_ >= params_.period) report_degraded(why);
    publish(now, no_wish("it does not know enough"));
  }

  /// Looks at all sensors; one sentence if that is not enough to want anything.
  std::string trouble(Time now) {
    for (std::string why : {sonar_.missing(), odom_.missing()})
      if (!why.empty()) return why;
    if (!misfit_.empty()) return "sonar: " + misfit_;
    const auto& odometry = *odom_.latest();
    if (!senses_.move(geometry::pose_of(odometry.pose.pose), geometry::twist_of(odometry.twist.twist)))
      return "odom: the pose is not finite";
    pressed_.clear();
    if (const auto* bumpers = bumpers_.latest())
      for (const auto& segment : bumpers->segments)
        if (segment.pressed) pressed_.emplace_back(static_cast<double>(segment.x), static_cast<double>(segment.y));
    senses_.press(pressed_, now);
    if (const auto* stall = stall_.latest()) senses_.stall({stall->left, stall->right}, now);
    return {};
  }

  void publish(Time now, const Wish& wish) {
    auto request = request_.loan();
    request->behaviour = Declaration::name;
    geometry::set_header(request->header, now, frame());
    request->priority = static_cast<std::int32_t>(params_.priority);
    // DDS knows strength alone, so nobody is to believe in more.
    request->hold = command_ ? 0 : static_cast<std::int32_t>(params_.hold);
    request->active = wish.active;
    request->valid_for = geometry::to_message(params_.valid_for);
    request->twist = geometry::to_message(wish.twist);
    request->why = wish.why;
    request_.publish(std::move(request));
    if (command_ && wish.active) publish_command(now, wish.twist);
    driving_ = wish.active;
  }

  void publish_command(Time now, const geometry::Twist2& twist) {
    auto command = command_->loan();
    geometry::set_header(command->header, now, frame());
    command->twist = geometry::to_message(twist);
    command_->publish(std::move(command));
  }

  std::string frame() const {
    const auto* odometry = odom_.latest();
    return odometry ? odometry->child_frame_id : std::string();
  }

  void on_deactivate(Time now) override {
    if (command_ && driving_) publish_command(now, {});
    publish(now, no_wish("it has ended"));
  }

  void on_shutdown(Time) override {
    if (senses_.refused() > 0) log().warn("left out {} readings of sensors that cannot be", senses_.refused());
  }
};

}  // namespace kervan::behavior
