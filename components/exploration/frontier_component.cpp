#include <spdlog/spdlog.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/exploration/frontier_choice.hpp"
#include "components/exploration/frontier_map.hpp"
#include "components/grid/messages.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "kervan_msgs/msg/Contact.hpp"
#include "kervan_msgs/msg/FrontierClaim.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace kervan::exploration {
namespace {

using namespace std::chrono_literals;
using geometry::Vector2;
using kervan_msgs::msg::ExplorationState;
using kervan_msgs::msg::FrontierClaim;
using kervan_msgs::msg::GoalState;

struct FrontierParams {
  FrontierMapParams map;
  FrontierChoiceParams choice;
  double memory = 256.0;
  double arrive_within = 0.4;
  double seen_within = 1.0;
  Duration patience = 60s;
  Duration period = 500ms;
  double enough = 0.0;
  bool end_run = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v(map.radius, "radius",
      {.unit = "m",
       .min = 0.0,
       .max = 5.0,
       .help = "No obstacle may be nearer to the robot's middle; as its planner has it."});
    v(map.occupied_above, "occupied_above",
      {.min = 0.0, .max = 99.0, .help = "Per cent; a cell that is occupied with more is an obstacle."});
    v(map.least_length, "least_length",
      {.unit = "m", .min = 0.0, .max = 100.0, .help = "Shorter frontiers are left out."});
    v(map.most_length, "most_length",
      {.unit = "m", .min = 0.1, .max = 100.0, .help = "Longer frontiers are cut into several."});
    v(map.escape, "escape",
      {.unit = "m",
       .min = 0.0,
       .max = 10.0,
       .help = "How far a robot that is too near to an obstacle may go to a free place."});
    v(memory, "memory", {.unit = "", .min = 0.1, .max = 16384.0, .help = "That the map may take, in MiB."});
    v(choice.gain, "gain", {.min = 0.0, .max = 100.0, .help = "Metres of way that a metre of frontier is worth."});
    v(choice.separation, "separation",
      {.unit = "m", .min = 0.0, .max = 100.0, .help = "To what another robot has chosen, at least."});
    v(choice.aside, "aside", {.min = 0.0, .max = 3600.0, .help = "For so long a frontier that failed is put aside."});
    v(arrive_within, "arrive_within",
      {.unit = "m", .min = 0.01, .max = 10.0, .help = "A frontier is reached by a robot this near to it."});
    v(seen_within, "seen_within",
      {.unit = "m",
       .min = 0.01,
       .max = 10.0,
       .help = "A frontier with nothing unknown so near to it is not driven to any more."});
    v(patience, "patience", {.min = 1.0, .max = 3600.0, .help = "A frontier not reached by then is put aside."});
    v(period, "period", {.min = 0.05, .max = 60.0, .help = "Time between two looks at the map."});
    v(enough, "enough",
      {.unit = "m2",
       .min = 0.0,
       .max = 1e9,
       .help = "Done when so much is known to be free; 0: when there is no frontier any more."});
    v(end_run, "end_run", {.help = "Ends the run when everybody is done."});
  }

  FrontierMapParams of_map() const {
    FrontierMapParams params = map;
    params.most_bytes = static_cast<std::size_t>(memory * 1024.0 * 1024.0);
    return params;
  }
};

/// Sends a robot to frontiers of the map until there are none (frontier_map.hpp, frontier_choice.hpp). Robots that
/// share a map tell each other what they have chosen.
class FrontierComponent final : public Component {
  const FrontierParams& params_ = parameters<FrontierParams>();
  FrontierMap map_{params_.of_map()};
  FrontierChoice choice_{params_.choice};
  Input<kervan_msgs::msg::MapTile> tiles_{this, "tiles", qos::latched, &FrontierComponent::on_tile, "The map."};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor.max_age(1s), "Where the robot is, in the map."};
  Input<kervan_msgs::msg::GoalStatus> status_{this, "goal_status", qos::latched.optional(),
                                              &FrontierComponent::on_status, "What has become of the goal."};
  Input<FrontierClaim> claims_{this, "claims", qos::latched.optional(), &FrontierComponent::on_claim,
                               "What all robots have chosen, this one too."};
  Input<kervan_msgs::msg::Contact> contact_{this, "contact", qos::event.optional(), "Every touch of the robot."};
  Output<geometry_msgs::msg::PoseStamped> goal_{this, "goal", qos::latched, "Place of the frontier to drive to."};
  Output<FrontierClaim> claim_{this, "claim", qos::latched, "What this robot has chosen."};
  Timer tick_{this, params_.period, &FrontierComponent::on_tick};
  ExplorationState state_ = ExplorationState::EXPLORATION_WAITING;
  std::optional<Vector2> place_;
  Time chosen_at_{};
  std::string goal_id_;
  bool failed_ = false;  ///< so says the planner of the present goal
  std::uint64_t chosen_ = 0, put_aside_ = 0, yielded_ = 0, contacts_ = 0, refused_ = 0;
  std::optional<Time> done_at_;
  std::vector<std::pair<double, double>> coverage_;  ///< s, m2
  double path_ = 0.0;
  std::optional<Vector2> last_;
  Time activated_{};

  void on_activate(Time now) override {
    activated_ = now;
    publish_claim(now);
  }

  void on_tile(const kervan_msgs::msg::MapTile& tile, Time) {
    if (!map_.put(grid::view_of(tile))) ++refused_;
  }

  void on_status(const kervan_msgs::msg::GoalStatus& status, Time) {
    if (status.goal_id == goal_id_) failed_ = status.state == GoalState::GOAL_FAILED;
  }

  /// Somebody who chose the same place before this robot did keeps it.
  void on_claim(const FrontierClaim& claim, Time now) {
    if (claim.robot == name() || !place_ || claim.state != ExplorationState::EXPLORATION_DRIVING) return;
    if ((Vector2(claim.x, claim.y) - *place_).norm() >= params_.choice.separation) return;
    const Time theirs = geometry::time_of(claim.header.stamp);
    if (theirs < chosen_at_ || (theirs == chosen_at_ && claim.robot < name())) {
      ++yielded_;
      place_.reset();
      choose(now);
    }
  }

  void on_tick(Time now) {
    contacts_ += contact_.take().size();
    if (const auto* odometry = odom_.latest()) {
      const Vector2 here = geometry::position_of(odometry->pose.pose);
      if (last_ && here.allFinite()) path_ += (here - *last_).norm();
      if (here.allFinite()) last_ = here;
    }
    if (coverage_.empty() || seconds(now - activated_) >= coverage_.back().first + 10.0)
      coverage_.emplace_back(seconds(now - activated_), map_.free_area());
    choose(now);
  }

  void choose(Time now) {
    if (map_.empty() || !odom_.latest()) {
      if (now - activated_ < 5s) return;  // A map takes its time until there is something to publish.
      return report_degraded(odom_.latest() ? tiles_.missing() : odom_.missing());
    }
    const Vector2 here = geometry::position_of(odom_.latest()->pose.pose);
    if (!here.allFinite()) return report_degraded("odom: the pose is not finite");
    const auto& frontiers = map_.find(here);
    if (place_) {
      const bool arrived = (*place_ - here).norm() <= params_.arrive_within;
      if (knows_enough() || !map_.open_near(*place_, params_.seen_within)) {
        place_.reset();  // It has been seen, by this robot or another one, or need not be.
      } else if (failed_ || arrived || now - chosen_at_ >= params_.patience) {
        log().info("frontier at ({:.2f}, {:.2f}) is put aside: {}", place_->x(), place_->y(),
                   failed_   ? "there is no way to it"
                   : arrived ? "nothing new is seen from it"
                             : "it takes too long");
        ++put_aside_;
        choice_.put_aside(now, *place_);
        place_.reset();
      }
    }
    if (!place_) decide(now, frontiers);
    if (refused_ > 0)
      report_degraded("tiles: " + std::string(map_.why()));
    else
      report_active();
    if (params_.end_run && state_ == ExplorationState::EXPLORATION_DONE && all_done()) finish("all is explored");
  }

  void decide(Time now, const std::vector<Frontier>& frontiers) {
    std::vector<Vector2> taken;
    for (const auto& claim : claims_.instances())
      if (claim->robot != name() && claim->state == ExplorationState::EXPLORATION_DRIVING)
        taken.emplace_back(claim->x, claim->y);
    const Choice choice = knows_enough() ? Choice::explored : choice_.choose(now, frontiers, taken);
    const ExplorationState before =
        std::exchange(state_, choice == Choice::chosen    ? ExplorationState::EXPLORATION_DRIVING
                              : choice == Choice::waiting ? ExplorationState::EXPLORATION_WAITING
                                                          : ExplorationState::EXPLORATION_DONE);
    if (choice == Choice::chosen) {
      place_ = choice_.chosen().place;
      chosen_at_ = now;
      failed_ = false;
      ++chosen_;
      publish_goal(now);
    }
    if (choice == Choice::explored && !done_at_) {
      done_at_ = now;
      log().info("explored: {:.1f} m2 are free", map_.free_area());
    }
    if (choice != Choice::explored) done_at_.reset();
    if (choice == Choice::chosen || state_ != before) publish_claim(now);
  }

  bool knows_enough() const { return params_.enough > 0.0 && map_.free_area() >= params_.enough; }

  bool all_done() const {
    for (const auto& claim : claims_.instances())
      if (claim->robot != name() && claim->state != ExplorationState::EXPLORATION_DONE) return false;
    return true;
  }

  void publish_goal(Time now) {
    auto goal = goal_.loan();
    geometry::set_header(goal->header, now, "map");
    goal->pose = geometry::to_message(geometry::Pose2{place_->x(), place_->y(), 0.0});
    goal_id_ = geometry::goal_id_of(goal->header.stamp);
    goal_.publish(std::move(goal));
  }

  void publish_claim(Time now) {
    auto claim = claim_.loan();
    claim->robot = name();
    geometry::set_header(claim->header, now, "map");
    claim->state = state_;
    if (place_) {
      claim->x = place_->x();
      claim->y = place_->y();
    }
    claim_.publish(std::move(claim));
  }

  void on_shutdown(Time now) override {
    contacts_ += contact_.take().size();
    if (refused_ > 0) log().warn("left out {} tiles", refused_);
    coverage_.emplace_back(seconds(now - activated_), map_.free_area());
    ValueList coverage;
    Value to_95;
    for (const auto& [time, area] : coverage_) {
      coverage.push_back(ValueList{time, area});
      if (to_95.empty() && area >= 0.95 * coverage_.back().second) to_95 = time;
    }
    write_figures({{"explored", done_at_.has_value()},
                   {"explored_after_s", done_at_ ? Value(seconds(*done_at_ - activated_)) : Value()},
                   {"area_95_after_s", to_95},
                   {"area_m2", map_.free_area()},
                   {"frontiers", static_cast<std::int64_t>(chosen_)},
                   {"put_aside", static_cast<std::int64_t>(put_aside_)},
                   {"yielded", static_cast<std::int64_t>(yielded_)},
                   {"contacts", static_cast<std::int64_t>(contacts_)},
                   {"path_m", path_},
                   {"coverage", std::move(coverage)}});
  }
};

}  // namespace
}  // namespace kervan::exploration

KERVAN_COMPONENT(kervan::exploration::FrontierComponent, "exploration/frontier",
                 "Sends a robot to where its map ends, until nothing is unknown that it can reach.")
