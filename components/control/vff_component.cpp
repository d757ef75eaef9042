#include <cstddef>
#include <string>
#include <utility>

#include "components/control/controller_shell.hpp"
#include "components/control/force_display.hpp"
#include "components/control/vff.hpp"
#include "components/mapping/sonar_mapper.hpp"

namespace kervan::control {
namespace {

using namespace std::chrono_literals;

struct VffComponentParams {
  Duration period = 100ms;
  VffParams field;
  double resolution = 0.1;
  double no_echo_limit = 2.0;
  double memory = 16.0;  // MiB
  double arrive_within = 0.3;

  template <class Visitor>
  void describe(Visitor& v) {
    v(period, "period", {.min = 0.01, .max = 1.0, .help = "Time between two commands, T of eq. 7."});
    v(field.f_cr, "f_cr",
      {.min = 0.0,
       .max = 100.0,
       .help = "Fcr: a cell of certainty C (0 .. 15) repels with Fcr C / d^2.",
       .live = true});
    v(field.f_ct, "f_ct", {.min = 0.0, .max = 100.0, .help = "Fct: how strongly the waypoint attracts.", .live = true});
    v(field.k_s, "k_s",
      {.unit = "1/s", .min = 0.0, .max = 20.0, .help = "Ks: turning rate per angle to turn.", .live = true});
    v(field.tau, "tau",
      {.unit = "s",
       .min = 0.0,
       .max = 10.0,
       .help = "Of the low-pass on the turning rate; up to the period: none.",
       .live = true});
    v(field.w, "w",
      {.min = 0.0,
       .max = 1.0,
       .help = "Share of the repulsion of what the robot drives along; 1: it is not damped.",
       .live = true});
    v(field.v_max, "v_max", {.unit = "m/s", .min = 0.0, .max = 2.0, .help = "Speed on a free course.", .live = true});
    v(field.v_min, "v_min",
      {.unit = "m/s", .min = 0.0, .max = 2.0, .help = "It drives no slower until it arrives.", .live = true});
    v(field.dead_band, "dead_band",
      {.min = 0.0, .max = 100.0, .help = "A repulsion up to this does not slow the robot.", .live = true});
    v(field.turn_rate, "turn_rate",
      {.unit = "rad/s", .min = 0.0, .max = 10.0, .help = "Highest turning rate.", .live = true});
    v(resolution, "resolution",
      {.unit = "m", .min = 0.02, .max = 1.0, .help = "Side of a cell; the window has 33 x 33."});
    v(no_echo_limit, "no_echo_limit",
      {.unit = "m",
       .min = 0.0,
       .max = 5.0,
       .help = "How far a sonar that hears no echo lowers the cells of its axis."});
    v(memory, "memory", {.unit = "", .min = 0.1, .max = 1024.0, .help = "That the certainty grid may take, in MiB."});
    describe_arrival(arrive_within, v);
  }

  VffParams of_field() const {
    VffParams params = field;
    params.period = seconds(period);
    return params;
  }

  mapping::SonarMapperParams of_grid() const {
    mapping::SonarMapperParams params;
    params.update = mapping::UpdateRule::himm;
    params.resolution = resolution;
    params.no_echo_limit = no_echo_limit;
    params.most_bytes = static_cast<std::size_t>(memory * 1024.0 * 1024.0);
    return params;
  }
};

/// Drives a robot with a virtual force field (vff.hpp), from certainty values that it gathers itself.
class VffComponent final : public ControllerShell<VffComponentParams, kervan_msgs::msg::SonarArray> {
  ForceDisplay display_{this};
  VirtualForceField field_{params_.of_field()};
  mapping::SonarMapper grid_{params_.of_grid()};  // what it knows stays true while the robot does not know where it is
  CertaintyWindow window_;
  std::string trouble_;  // since the last step

  void on_parameters_changed() override { field_.set_params(params_.of_field()); }

  void on_stand() override { field_.reset(); }

  std::string trouble() override { return std::exchange(trouble_, {}); }

  std::string hear(const kervan_msgs::msg::SonarArray& sonar, const geometry::Pose2& robot) override {
    const mapping::SonarLimits limits{static_cast<double>(sonar.min_range), static_cast<double>(sonar.max_range)};
    if (!(limits.min_range >= 0.0 && limits.max_range > limits.min_range)) return "its ranges are none";
    for (const auto& reading : sonar.readings) {
      const geometry::Pose2 transducer{static_cast<double>(reading.x), static_cast<double>(reading.y),
                                       static_cast<double>(reading.yaw)};
      switch (grid_.add(robot * transducer, static_cast<double>(reading.range), limits)) {
        case mapping::ReadingResult::echo:
        case mapping::ReadingResult::no_echo:
        case mapping::ReadingResult::not_fired: break;
        case mapping::ReadingResult::refused_range: trouble_ = "sonar: ranges that are no distance are left out"; break;
        case mapping::ReadingResult::refused_place: trouble_ = "sonar: readings from nowhere are left out"; break;
        // Blind from here on.
        case mapping::ReadingResult::refused_memory: return "the certainty grid has no memory for what it hears here";
      }
    }
    return {};
  }

  Controlled control(Time now, const RobotState& robot, const geometry::Vector2& target) override {
    const geometry::Vector2 position = robot.pose.position();
    if (!grid::has_cell(position))
      return {Steering{Outcome::fault, "the robot is too far away from its origin"}, "odom"};
    cut_window(*grid_.certainties(), position, window_);
    const VffStep step = field_.step(robot, target, window_);
    if (step.outcome != Outcome::fault) display_.show(now, frame(), position, step.attraction, step.damped);
    return {step, "odom"};
  }
};

}  // namespace
}  // namespace kervan::control

KERVAN_COMPONENT(kervan::control::VffComponent, "control/vff",
                 "Drives to a waypoint past what its sonars hear, by a virtual force field.")
