// Writes down what behaviours want and who of them drives, on the simulator's own time.
#include <spdlog/spdlog.h>

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "framework/kervan.hpp"
#include "kervan_msgs/msg/ArbitrationState.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;

/// As fast as a robot must drive or turn to be in somebody's charge; m/s, rad/s.
constexpr double kDriving = 0.18, kTurning = 0.3;

/// arbitration.csv in the run's folder: what, nanoseconds, whose. "wants" is an active request, "drives" the arbiter's
/// word. And a line on the console with the behaviour and the time, twice a second while it moves the robot.
class ArbitrationRecorder final : public Component {
  Input<kervan_msgs::msg::MotionRequest> requests_{this, "requests", qos::command, &ArbitrationRecorder::on_request,
                                                   "What each behaviour wants."};
  Input<kervan_msgs::msg::ArbitrationState> arbitration_{this, "arbitration", qos::event,
                                                         &ArbitrationRecorder::on_arbitration, "Who drives."};
  Input<nav_msgs::msg::Odometry> truth_{this, "truth", qos::state, "How fast the robot is."};
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_{nullptr, &std::fclose};
  std::string driving_;
  Time since_{}, said_{};

  void on_activate(Time) override { file_.reset(std::fopen((run_folder() / "arbitration.csv").c_str(), "w")); }
  void write(const char* what, Time now, const std::string& behaviour) {
    if (file_)
      std::fprintf(file_.get(), "%s,%" PRId64 ",%s\n", what, now.time_since_epoch().count(), behaviour.c_str());
  }
  void on_request(const Sample<kervan_msgs::msg::MotionRequest>& request, Time now) {
    if (!request.disposed() && request->active) write("wants", now, request->behaviour);
  }
  void on_arbitration(const kervan_msgs::msg::ArbitrationState& state, Time now) {
    write("drives", now, state.behaviour);
    if (state.behaviour != driving_) since_ = now;
    driving_ = state.behaviour;
    const auto* truth = truth_.latest();
    if (driving_.empty() || !truth || now - since_ < 300ms || now - said_ < 500ms) return;
    const auto& speed = truth->twist.twist;
    if (speed.linear.x < kDriving && std::abs(speed.angular.z) < kTurning) return;
    said_ = now;
    log().warn("{} drives at {}", driving_, now.time_since_epoch().count());
  }
  void on_shutdown(Time) override { file_.reset(); }
};

}  // namespace
}  // namespace kervan::test

KERVAN_COMPONENT(kervan::test::ArbitrationRecorder, "test/arbitration_recorder",
                 "Writes down what behaviours want and who of them drives.")
