// Writes down what the drive was told and what it did, on the simulator's own time.
#include <spdlog/spdlog.h>

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <memory>

#include "framework/kervan.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;

/// drive.csv in the run's folder: what, nanoseconds, metres per second. "raw" is what the controller wants, "command"
/// what the drive is told, "speed" how fast the robot is. And a line on the console every second while it drives.
class DriveRecorder final : public Component {
  Input<geometry_msgs::msg::TwistStamped> raw_{this, "raw", qos::command, &DriveRecorder::on_raw, "Wanted."};
  Input<geometry_msgs::msg::TwistStamped> command_{this, "command", qos::command, &DriveRecorder::on_command, "Told."};
  Input<nav_msgs::msg::Odometry> truth_{this, "truth", qos::state, &DriveRecorder::on_truth, "Done."};
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_{nullptr, &std::fclose};
  Time told_{};

  void on_activate(Time) override { file_.reset(std::fopen((run_folder() / "drive.csv").c_str(), "w")); }
  void write(const char* what, Time now, double speed) {
    if (file_) std::fprintf(file_.get(), "%s,%" PRId64 ",%.9f\n", what, now.time_since_epoch().count(), speed);
  }
  void on_raw(const geometry_msgs::msg::TwistStamped& wanted, Time now) { write("raw", now, wanted.twist.linear.x); }
  void on_command(const geometry_msgs::msg::TwistStamped& told, Time now) {
    write("command", now, told.twist.linear.x);
  }
  void on_truth(const nav_msgs::msg::Odometry& truth, Time now) {
    const double speed = truth.twist.twist.linear.x;
    write("speed", now, speed);
    if (speed < 0.2 || now - told_ < 1s) return;
    told_ = now;
    log().warn("driving");
  }
  void on_shutdown(Time) override { file_.reset(); }
};

}  // namespace
}  // namespace kervan::test

KERVAN_COMPONENT(kervan::test::DriveRecorder, "test/drive_recorder", "Writes down what a drive is told and does.")
