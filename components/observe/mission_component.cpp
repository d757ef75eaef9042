#include <spdlog/spdlog.h>

#include <cmath>
#include <deque>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/observe/decimal.hpp"
#include "components/observe/mission_memory.hpp"
#include "components/observe/mission_score.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "kervan_msgs/msg/Contact.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "kervan_msgs/msg/MissionResult.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "sensor_msgs/msg/Range.hpp"

namespace kervan::observe {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using kervan_msgs::msg::MissionOutcome;

struct RobotGoals {
  std::vector<geometry::Vector2> at;

  template <class Visitor>
  void describe(Visitor& v) {
    v(at, "at",
      {.unit = "m",
       .min = -1e6,
       .max = 1e6,
       .help = "Goals in the map, to be reached in this order.",
       .required = true});
  }
};

struct MissionComponentParams {
  std::map<std::string, RobotGoals> goals;
  MissionParams mission;
  Duration period = 20ms;

  template <class Visitor>
  void describe(Visitor& v) {
    v(goals, "goals", {.help = "What each robot has to reach, by the robot's name.", .required = true});
    v(mission.tolerance, "tolerance",
      {.unit = "m", .min = 0.001, .max = 100.0, .help = "A robot standing this near to its goal has reached it."});
    v(mission.timeout, "timeout", {.min = 0.1, .max = 1e6, .help = "After this the mission has failed."});
    v(mission.rest_time, "rest_time", {.min = 0.0, .max = 60.0, .help = "How long a robot must stand at a goal."});
    v(mission.standing, "standing", {.help = "Whether a robot must stand at a goal; else it is enough to come near."});
    v(mission.contact_ends, "contact_ends", {.help = "Whether the mission has failed when a robot touches something."});
    v(period, "period", {.min = 0.001, .max = 1.0, .help = "Time between two looks at the robots."});
  }
};

/// One robot of the mission: its ports and its score.
class Contender {
 public:
  Contender(Component* owner, const std::string& name, const MissionParams& params)
      : name_(name),
        params_(params),
        truth_(owner, name + "/truth", qos::state, "True pose and speed of " + name + "."),
        contact_(owner, name + "/contact", qos::event, "Every touch of " + name + "."),
        clearance_(owner, name + "/clearance", qos::state.optional(),
                   "Distance of the hull of " + name + " to the world."),
        status_(owner, name + "/goal_status", qos::latched.optional(), "What " + name + " makes of its goal."),
        goal_(owner, name + "/goal", qos::latched, "Where " + name + " is to go.") {}

  /// `memory`: of the score before the component was started again; nullptr if there is none.
  void start(Time now, const MissionMemory* memory) {
    if (memory)
      score_.emplace(params_, *memory);
    else
      score_.emplace(params_, now);
    publish_goal(now);
  }

  void look(Time now) {
    const std::size_t goal = score_->figures().goal;
    for (const auto& contact : contact_.take()) score_->contact(contact->count);
    for (const auto& clearance : clearance_.take()) score_->clearance(static_cast<double>(clearance->range));
    for (const auto& truth : truth_.take())
      score_->truth(now, geometry::pose_of(truth->pose.pose), geometry::twist_of(truth->twist.twist));
    if (const auto* status = status_.latest();
        status && status->state == kervan_msgs::msg::GoalState::GOAL_FAILED && status->goal_id == goal_id_) {
      score_->give_up(now);
      why_ = status->reason;
    }
    score_->tick(now);
    if (score_->figures().goal != goal) publish_goal(now);
  }

  const MissionScore& score() const { return *score_; }
  /// "1 of 2, (16.00, 7.80)"
  std::string goal_text() const {
    return std::to_string(score_->figures().goal + 1) + " of " + std::to_string(params_.goals.size()) + ", (" +
           decimal(score_->goal().x(), 2) + ", " + decimal(score_->goal().y(), 2) + ")";
  }
  bool reached() const { return score_->figures().outcome == observe::MissionOutcome::reached; }
  bool gave_up() const { return score_->figures().outcome == observe::MissionOutcome::given_up; }
  const std::string& why() const { return why_; }  ///< it gave up
  bool touched() const { return score_->figures().outcome == observe::MissionOutcome::touched; }
  const std::string& name() const { return name_; }
  std::string missing() const { return truth_.missing(); }

  kervan_msgs::msg::RobotResult result() const {
    const MissionFigures& figures = score_->figures();
    kervan_msgs::msg::RobotResult result;
    result.robot = name_;
    result.reached = reached();
    result.error_m = figures.error;
    result.time_s = figures.time;
    result.path_m = figures.path;
    result.contacts = figures.contacts;
    result.min_clearance_m = figures.min_clearance.value_or(std::numeric_limits<double>::quiet_NaN());
    return result;
  }

 private:
  void publish_goal(Time now) {
    geometry_msgs::msg::PoseStamped goal;
    geometry::set_header(goal.header, now, "map");
    goal.pose = geometry::to_message(geometry::Pose2{score_->goal().x(), score_->goal().y(), 0.0});
    goal_id_ = geometry::goal_id_of(goal.header.stamp);
    goal_.publish(goal);
  }

  std::string name_;
  MissionParams params_;
  Input<nav_msgs::msg::Odometry> truth_;
  Input<kervan_msgs::msg::Contact> contact_;
  Input<sensor_msgs::msg::Range> clearance_;
  Input<kervan_msgs::msg::GoalStatus> status_;
  Output<geometry_msgs::msg::PoseStamped> goal_;
  std::string goal_id_;
  std::string why_;
  std::optional<MissionScore> score_;
};

/// Sends robots to their goals and judges them on the simulator's truth (mission_score.hpp). Ends the run when all have
/// arrived, one has given up or the time is up; a run that is ended from outside before that is `aborted`.
class MissionComponent final : public Component {
  const MissionComponentParams& params_ = parameters<MissionComponentParams>();
  std::deque<Contender> robots_ = contenders();
  Output<kervan_msgs::msg::MissionResult> result_{this, "result", qos::latched, "How the mission ended."};
  Timer tick_{this, params_.period, &MissionComponent::on_tick};
  bool judged_ = false;
  bool told_ = false;  ///< that nothing can be remembered
  Time activated_{};
  Time saved_{};

  std::deque<Contender> contenders() {
    if (params_.goals.empty() && !describing())
      throw ParameterError("goals", "no robot has a goal; write e.g. {r1: {at: [[1 m, 2 m]]}}");
    std::deque<Contender> robots;
    for (const auto& [name, goals] : params_.goals) {
      if (goals.at.empty())
        throw ParameterError("goals." + name + ".at", "there is no goal in it; write e.g. [[1 m, 2 m]]");
      MissionParams mission = params_.mission;
      mission.goals = goals.at;
      robots.emplace_back(this, name, mission);
    }
    return robots;
  }

  void on_activate(Time now) override {
    activated_ = saved_ = now;
    const MissionMemories memories = remembered();
    for (auto& robot : robots_) {
      const auto memory = memories.find(robot.name());
      robot.start(now, memory == memories.end() ? nullptr : &memory->second);
      log().info("{} is sent {} goal {}", robot.name(), memory == memories.end() ? "to" : "on to", robot.goal_text());
    }
    remember();
  }

  fs::path memory_file() const { return run_folder() / "mission.state"; }

  /// What this component knew before it was started again in the same run.
  MissionMemories remembered() const {
    if (run_folder().empty()) return {};
    std::ifstream file(memory_file());
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    return memories_of(text).value_or(MissionMemories());
  }

  /// A process may be killed at any time: the file is replaced as a whole.
  void remember() {
    if (run_folder().empty()) return;
    MissionMemories memories;
    for (const auto& robot : robots_) memories[robot.name()] = robot.score().memory();
    const fs::path fresh = run_folder() / "mission.state.new";
    std::error_code error;
    std::ofstream file(fresh);
    file << to_text(memories);
    file.close();
    if (file) fs::rename(fresh, memory_file(), error);
    if ((!file || error) && !std::exchange(told_, true))
      log().warn("{} cannot be written: started again, the mission would begin anew", memory_file().string());
  }

  /// Takes what is new of a robot and says in the log what came of its goal.
  void look(Contender& robot, Time now) {
    const std::string goal = robot.goal_text();
    const bool over = robot.score().ended();
    robot.look(now);
    const MissionFigures& figures = robot.score().figures();
    const std::string sent = robot.goal_text();
    if (sent != goal) {
      remember();
      log().info("{} has reached goal {} and is sent to goal {}", robot.name(), goal, sent);
    }
    if (over || !robot.score().ended()) return;
    log().info("{} {} goal {}: error {} m after {} s", robot.name(), robot.reached() ? "has reached" : "did not reach",
               goal, decimal(figures.error, 3), decimal(figures.time, 2));
  }

  void on_tick(Time now) {
    if (judged_) return;
    bool ended = true, reached = true, over = false;
    std::string missing;
    for (auto& robot : robots_) {
      look(robot, now);
      ended = ended && robot.score().ended();
      reached = reached && robot.reached();
      over = over || robot.gave_up() || robot.touched();
      if (missing.empty()) missing = robot.missing();
    }
    if (missing.empty())
      report_active();
    else if (now - activated_ >= params_.period)  // At the first tick nobody can have published yet.
      report_degraded(missing);
    if (!ended && !over) {
      if (now - saved_ < 1s) return;
      saved_ = now;
      return remember();
    }
    publish_result(now, reached ? MissionOutcome::MISSION_SUCCESS : MissionOutcome::MISSION_FAILED, reason());
    finish(reached ? "every robot has reached its goal" : reason());
  }

  void on_deactivate(Time now) override {
    if (!judged_) publish_result(now, MissionOutcome::MISSION_ABORTED, "the run was ended before the mission was over");
  }

  void on_shutdown(Time) override {
    std::error_code ignored;
    if (!run_folder().empty()) fs::remove(memory_file(), ignored);
  }

  /// Who touched something, if that is the end; who gave up and why; if nobody did, who did not arrive and how far away
  /// it was; empty if all did.
  std::string reason() const {
    for (const auto& robot : robots_)
      if (robot.touched()) return robot.name() + " has touched something";
    std::string text;
    for (const auto& robot : robots_)
      if (robot.gave_up()) text += (text.empty() ? "" : "; ") + robot.name() + " has given up: " + robot.why();
    if (!text.empty()) return text;
    for (const auto& robot : robots_) {
      if (robot.reached()) continue;
      text += text.empty() ? "the time is up: " : ", ";
      text += robot.name() + " is " + decimal(robot.score().figures().error, 2) + " m from its goal";
    }
    return text;
  }

  void publish_result(Time now, MissionOutcome outcome, const std::string& why) {
    judged_ = true;
    kervan_msgs::msg::MissionResult result;
    geometry::set_header(result.header, now, "map");
    result.result = outcome;
    result.reason = why;
    for (const auto& robot : robots_) result.robots.push_back(robot.result());
    result_.publish(result);
  }
};

}  // namespace
}  // namespace kervan::observe

KERVAN_COMPONENT(kervan::observe::MissionComponent, "observe/mission",
                 "Sends robots to their goals, judges them on the truth, and ends the run.")
