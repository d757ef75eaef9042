/// What components that make a map out of a sensor's readings have in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "components/mapping/map_ports.hpp"
#include "components/mapping/posed_readings.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace kervan::mapping {

struct MapMakerParams {
  double memory = 128.0;  ///< MiB
  geometry::Pose2 start;
  std::string frame = "map";
  Duration max_age = std::chrono::milliseconds(500);
  Duration period = std::chrono::milliseconds(500);

  template <class Visitor>
  void describe(Visitor& v) {
    v(memory, "memory", {.unit = "", .min = 0.1, .max = 16384.0, .help = "That the map may take, in MiB."});
    v(start, "start", {.min = -1e6, .max = 1e6, .help = "Pose of the odometry's frame in the map."});
    v(frame, "frame", {.help = "Name of the map's frame."});
    v(max_age, "max_age", {.min = 0.001, .max = 60.0, .help = "Older readings are left out."});
    v(period, "period", {.min = 0.01, .max = 60.0, .help = "Time between two looks at what has changed."});
  }

  std::size_t most_bytes() const { return static_cast<std::size_t>(memory * 1024.0 * 1024.0); }
};

/// Puts each Message into a map, from where the odometry says that it was taken, and gives the map away. Params have
/// the member `map`, MapMakerParams, and of_mapper(), of which a Mapper is made. Degraded, with the reason, after a
/// period in which something was left out or an input is missing.
template <class Params, class Mapper, class Message>
class MapMaker : public Component {
 protected:
  /// The sensor's port, and what one of its messages is called in reports: "scans".
  MapMaker(const std::string& port, std::string plural, const char* help)
      : plural_(std::move(plural)), input_(this, port, qos::sensor, &MapMaker::on_reading, help) {}

  /// Why a message is not one of this robot's sensor; empty if it is.
  virtual std::string misfit(const Message&) { return {}; }
  /// Puts a message into the map, with base_link at `pose` in it.
  virtual void insert(const geometry::Pose2& pose, const Message& message) = 0;

  /// Something was left out: reported at the end of the period.
  void complain(std::string why) { trouble_ = std::move(why); }

  std::uint64_t misfits() const { return misfits_; }
  /// Messages late or without a pose of their time, and poses that are none.
  std::uint64_t dropped() const { return readings_.late() + readings_.unplaced() + readings_.bad_poses(); }

  const Params& params_ = parameters<Params>();
  Mapper mapper_{params_.of_mapper()};

 private:
  PosedReadings<Sample<Message>> readings_{params_.map.max_age};
  std::string plural_;
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor, &MapMaker::on_odom, "Pose of base_link."};
  Input<Message> input_;

 protected:
  MapPorts ports_{this};

 private:
  Timer tick_{this, params_.map.period, &MapMaker::on_tick};
  Time activated_{};
  std::uint64_t misfits_ = 0;
  std::uint64_t dropped_ = 0;  ///< up to the last tick
  std::string trouble_;        ///< since the last tick

  void on_activate(Time now) override {
    activated_ = now;
    ports_.begin(now);
  }

  void on_odom(const nav_msgs::msg::Odometry& odom, Time now) {
    readings_.pose(geometry::time_of(odom.header.stamp), params_.map.start * geometry::pose_of(odom.pose.pose));
    place(now);
  }

  void on_reading(const Sample<Message>& message, Time now) {
    if (message.disposed()) return;
    if (const std::string why = misfit(*message); !why.empty()) {
      ++misfits_;
      return complain(input_.name() + ": " + why);
    }
    readings_.reading(geometry::time_of(message->header.stamp), now, message);
    place(now);
  }

  void place(Time now) {
    readings_.release(
        now, [this](const geometry::Pose2& pose, const Sample<Message>& message, Time) { insert(pose, *message); });
  }

  void on_tick(Time now) {
    place(now);
    if (dropped() != dropped_ && trouble_.empty())
      complain(input_.name() + ": " + plural_ + " without a pose of their time are left out");
    dropped_ = dropped();
    ports_.publish(mapper_, now, params_.map.frame);
    if (!trouble_.empty())
      report_degraded(trouble_);
    else if (const std::string missing = !odom_.missing().empty() ? odom_.missing() : input_.missing(); missing.empty())
      report_active();
    else if (now - activated_ >= params_.map.period)  // At the first tick nobody can have published yet.
      report_degraded(missing);
    trouble_.clear();
  }

  void on_deactivate(Time now) override { ports_.publish(mapper_, now, params_.map.frame); }
};

}  // namespace kervan::mapping
