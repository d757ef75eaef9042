// Writes down what the drive was told and what it did, on the simulator's own time.
#include <spdlog/spdlog.h>

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "framework/kervan.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;

/// As fast as a robot must be told to drive, and drive, to count as driving; m/s.
constexpr double kDriving = 0.3;
/// The commands that it drives on come at least every 100 ms.
constexpr auto kFlowing = 120ms;

/// drive.csv in the run's folder: what, nanoseconds, metres per second. "raw" is what the controller wants, "command"
/// what the drive is told, "speed" how fast the robot is. And a line on the console with the time, twice a second while
/// the robot drives and commands flow.
class DriveRecorder final : public Component {
  Input<geometry_msgs::msg::TwistStamped> raw_{this, "raw", qos::command, &DriveRecorder::on_raw, "Wanted."};
  Input<geometry_msgs::msg::TwistStamped> command_{this, "command", qos::command, &DriveRecorder::on_command, "Told."};
  Input<nav_msgs::msg::Odometry> truth_{this, "truth", qos::state, &DriveRecorder::on_truth, "Done."};
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_{nullptr, &std::fclose};
  std::optional<Time> wanted_, told_;  // the last times at which that was to drive
  Time said_{};

  void on_activate(Time) override { file_.reset(std::fopen((run_folder() / "drive.csv").c_str(), "w")); }
  void write(const char* what, Time now, double speed) {
    if (file_) std::fprintf(file_.get(), "%s,%" PRId64 ",%.9f\n", what, now.time_since_epoch().count(), speed);
  }
  void on_raw(const geometry_msgs::msg::TwistStamped& wanted, Time now) {
    write("raw", now, wanted.twist.linear.x);
    wanted_ = wanted.twist.linear.x >= kDriving ? std::optional(now) : std::nullopt;
  }
  void on_command(const geometry_msgs::msg::TwistStamped& told, Time now) {
    write("command", now, told.twist.linear.x);
    told_ = told.twist.linear.x >= kDriving ? std::optional(now) : std::nullopt;
  }
  void on_truth(const nav_msgs::msg::Odometry& truth, Time now) {
    const double speed = truth.twist.twist.linear.x;
    write("speed", now, speed);
    const bool flowing = wanted_ && now - *wanted_ <= kFlowing && told_ && now - *told_ <= kFlowing;
    if (speed < kDriving || !flowing || now - said_ < 500ms) return;
    said_ = now;
    log().warn("driving at {}", now.time_since_epoch().count());
  }
  void on_shutdown(Time) override { file_.reset(); }
};

}  // namespace
}  // namespace kervan::test

KERVAN_COMPONENT(kervan::test::DriveRecorder, "test/drive_recorder", "Writes down what a drive is told and does.")
