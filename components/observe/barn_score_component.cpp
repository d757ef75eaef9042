#include <string>
#include <vector>

#include "components/observe/barn_score.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "kervan_msgs/msg/Contact.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace kervan::observe {
namespace {

using namespace std::chrono_literals;

struct BarnScoreComponentParams {
  BarnScoreParams score;
  std::vector<geometry::Vector2> goals;

  template <class Visitor>
  void describe(Visitor& v) {
    v(goals, "goals",
      {.unit = "m", .min = -1e6, .max = 1e6, .help = "In the map; the last one counts.", .required = true});
    v(score.reference, "reference",
      {.unit = "m", .min = 0.0, .max = 1e6, .help = "Length of the world's reference path; 0: there is no metric."});
    v(score.reference_speed, "reference_speed",
      {.unit = "m/s", .min = 0.01, .max = 100.0, .help = "At which it is driven in the optimal time."});
    v(score.begun_after, "begun_after",
      {.unit = "m", .min = 0.0, .max = 10.0, .help = "How far from its start the robot is when the clock starts."});
    v(score.within, "within",
      {.unit = "m", .min = 0.01, .max = 100.0, .help = "This near to the goal it has succeeded."});
    v(score.limit, "limit", {.unit = "s", .min = 1.0, .max = 1e6, .help = "On the clock, after which it has failed."});
  }

  BarnScoreParams of_score() const {
    BarnScoreParams params = score;
    if (!goals.empty()) params.goal = goals.back();
    return params;
  }
};

/// Judges a run as BARN does (barn_score.hpp), for the run's summary. It does not end the run.
class BarnScoreComponent final : public Component {
  const BarnScoreComponentParams& params_ = checked(parameters<BarnScoreComponentParams>());
  BarnScore score_{params_.of_score()};
  // A contact comes before the truth of the same step.
  Input<kervan_msgs::msg::Contact> contact_{this, "contact", qos::event, &BarnScoreComponent::on_contact,
                                            "Every touch of the robot."};
  Input<nav_msgs::msg::Odometry> truth_{this, "truth", qos::state, &BarnScoreComponent::on_truth,
                                        "Its true pose and speed."};
  Timer tick_{this, 500ms, &BarnScoreComponent::on_tick};
  Time activated_{};

  const BarnScoreComponentParams& checked(const BarnScoreComponentParams& params) const {
    if (params.goals.empty() && !describing())
      throw ParameterError("goals", "there is no goal; write e.g. [[1 m, 2 m]]");
    return params;
  }

  void on_activate(Time now) override { activated_ = now; }

  void on_contact(const kervan_msgs::msg::Contact&, Time) { score_.contact(); }

  void on_truth(const nav_msgs::msg::Odometry& truth, Time) {
    score_.truth(seconds(geometry::time_of(truth.header.stamp).time_since_epoch()),
                 geometry::position_of(truth.pose.pose));
  }

  void on_tick(Time now) {
    if (const std::string missing = truth_.missing(); missing.empty())
      report_active();
    else if (now - activated_ >= 500ms)  // At the first tick nobody can have published yet.
      report_degraded(missing);
  }

  void on_shutdown(Time) override {
    write_figures({{"outcome", std::string(to_text(score_.outcome()))},
                   {"time_s", score_.time()},
                   {"path_m", score_.length()},
                   {"reference_m", params_.score.reference},
                   {"metric", score_.metric()}});
  }
};

}  // namespace
}  // namespace kervan::observe

KERVAN_COMPONENT(kervan::observe::BarnScoreComponent, "observe/barn_score",
                 "Judges a robot's way through a world of BARN.")
