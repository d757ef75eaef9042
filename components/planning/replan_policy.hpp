/// When to plan again, and when to give a goal up.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "components/planning/route_place.hpp"
#include "framework/component/time.hpp"

namespace kervan::planning {

struct ReplanParams {
  double deviation = 1.0;                               ///< m, farthest from the route; 0: as far as it likes
  double progress = 0.3;                                ///< m, that the way left must become shorter
  Duration progress_within = std::chrono::seconds(20);  ///< in this time; 0: however long it takes
  Duration interval = std::chrono::milliseconds(200);   ///< between two plans, at least
  Duration retry = std::chrono::seconds(1);             ///< from a plan without a route to the next
  std::int64_t tries = 5;                               ///< plans in a row that may fail or bring no progress
  Duration time_limit{};                                ///< for a goal; 0: none
};

/// Follows a robot on its way to one goal. It plans nothing and holds no clock: it is told what happens, and asked what
/// is to be done. Every reason to plan is bounded: two plans are `interval` apart at least, and after `tries` plans
/// that failed or brought the robot no nearer to the end of its route, the goal is given up.
class ReplanPolicy {
 public:
  enum class Step {
    wait,
    plan,
    give_up,  ///< reason() says why
  };

  explicit ReplanPolicy(const ReplanParams& params) : params_(params) {}

  /// Other limits from here on; what was counted stays counted.
  void set_params(const ReplanParams& params) { params_ = params; }

  /// A goal: nothing of the one before counts, but the time of the last plan.
  void begin(Time now);

  /// The goal is reached or given up: there is nothing more to do.
  void end() { running_ = false; }

  /// A route was found, or none was and why not. Times must not go back.
  void planned(Time now, const std::vector<geometry::Vector2>& route);
  void failed(Time now, std::string_view why);

  /// Where the robot is; a position that is not finite changes nothing.
  void move(Time now, const geometry::Vector2& position);

  /// What is left of the route is no longer free: it must not be driven.
  void blocked();
  /// A new plan is wanted, for this reason.
  void ask(std::string why);

  /// What is to be done now. Asks for a plan until it is told what came of it.
  Step step(Time now);

  /// Why: to plan, or to give up.
  const std::string& reason() const { return reason_; }
  const RoutePlace& place() const { return place_; }
  /// There is a route, and nothing is known against driving it.
  bool route_is_good() const { return !place_.empty() && !blocked_; }

 private:
  void lead_nowhere(std::string why);

  ReplanParams params_;
  RoutePlace place_;
  bool running_ = false;
  bool wanted_ = false;  // a plan
  bool blocked_ = false;
  bool ever_planned_ = false;
  std::string reason_;
  std::string gave_up_;
  std::int64_t vain_ = 0;  // plans in a row that failed or brought no progress
  Time began_{};
  Time last_plan_{};
  Time not_before_{};  // the next plan
  Time progressed_at_{};
  double advanced_ = 0.0;    // m, by which the ways left became shorter, longer ones taken off
  double progressed_ = 0.0;  // advanced_ at progressed_at_
};

}  // namespace kervan::planning
