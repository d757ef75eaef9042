#include <spdlog/spdlog.h>

#include <cmath>

#include "components/mapping/map_ports.hpp"
#include "components/mapping/posed_readings.hpp"
#include "components/mapping/sonar_mapper.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace kervan::mapping {
namespace {

using namespace std::chrono_literals;
using kervan_msgs::msg::SonarArray;

struct SonarComponentParams {
  SonarMapperParams mapper;
  double memory = 128.0;
  geometry::Pose2 start;
  std::string frame = "map";
  Duration max_age = 500ms;
  Duration period = 500ms;

  template <class Visitor>
  void describe(Visitor& v) {
    v(mapper.update, "update",
      {.choices = {"bayes", "dempster_shafer", "himm"}, .help = "Rule by which readings become a map."});
    v(mapper.resolution, "resolution", {.unit = "m", .min = 0.01, .max = 1.0, .help = "Side of a cell."});
    v(mapper.model.max_range, "max_range",
      {.unit = "m",
       .min = 0.1,
       .max = farthest_cone,
       .help = "Range of the model; a reading from here on is no echo."});
    v(mapper.model.half_aperture, "half_aperture",
      {.unit = "rad", .min = 0.01, .max = 1.5, .help = "Of the cones, from the axis to the edge."});
    v(mapper.model.tolerance, "tolerance",
      {.unit = "m", .min = 0.001, .max = 1.0, .help = "Half the width of the arc that an echo may come from."});
    v(mapper.model.max_occupied, "max_occupied",
      {.min = 0.0, .max = 1.0, .help = "Of the model: a reading makes no place surer to be occupied."});
    v(mapper.model.regions, "regions",
      {.choices = {"reading", "fixed"},
       .help = "Where an echo may come from: round the reading, or 0.35 .. 0.50 m as in wall following."});
    v(mapper.model.literal, "literal", {.help = "Weak evidence speaks for the opposite, as the formula has it."});
    v(mapper.model.record_above, "record_above",
      {.min = 0.0, .max = 1.0, .help = "Echoes count only where one makes P(occupied) more than this; 0: everywhere."});
    v(mapper.no_echo_limit, "no_echo_limit",
      {.unit = "m", .min = 0.0, .max = farthest_cone, .help = "How far a sonar that hears no echo clears its cone."});
    v(memory, "memory", {.unit = "", .min = 0.1, .max = 16384.0, .help = "That the map may take, in MiB."});
    v(start, "start", {.min = -1e6, .max = 1e6, .help = "Pose of the odometry's frame in the map."});
    v(frame, "frame", {.help = "Name of the map's frame."});
    v(max_age, "max_age", {.min = 0.001, .max = 60.0, .help = "Older readings are left out."});
    v(period, "period", {.min = 0.01, .max = 60.0, .help = "Time between two looks at what has changed."});
  }

  SonarMapperParams of_mapper() const {
    SonarMapperParams params = mapper;
    params.most_bytes = static_cast<std::size_t>(memory * 1024.0 * 1024.0);
    return params;
  }
};

/// Puts the readings of a ring of sonars into a map (sonar_mapper.hpp), from where the odometry says that they were
/// taken.
class SonarComponent final : public Component {
  const SonarComponentParams& params_ = parameters<SonarComponentParams>();
  SonarMapper mapper_{params_.of_mapper()};
  PosedReadings<Sample<SonarArray>> readings_{params_.max_age};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor, &SonarComponent::on_odom, "Pose of base_link."};
  Input<SonarArray> sonar_{this, "sonar", qos::sensor, &SonarComponent::on_sonar, "What the sonars measure."};
  MapPorts ports_{this};
  Timer tick_{this, params_.period, &SonarComponent::on_tick};
  Time activated_{};
  std::size_t ring_ = 0;  ///< sonars of the first array
  std::uint64_t added_ = 0, refused_ranges_ = 0, refused_arrays_ = 0, refused_memory_ = 0;
  std::uint64_t dropped_ = 0;  ///< up to the last tick
  std::string trouble_;        ///< since the last tick

  void on_activate(Time now) override {
    activated_ = now;
    ports_.begin(now);
  }

  void on_odom(const nav_msgs::msg::Odometry& odom, Time now) {
    readings_.pose(geometry::time_of(odom.header.stamp), params_.start * geometry::pose_of(odom.pose.pose));
    place(now);
  }

  void on_sonar(const Sample<SonarArray>& sonar, Time now) {
    if (sonar.disposed()) return;
    if (const std::string why = misfit(*sonar); !why.empty()) {
      ++refused_arrays_;
      trouble_ = "sonar: " + why;
      return;
    }
    readings_.reading(geometry::time_of(sonar->header.stamp), now, sonar);
    place(now);
  }

  /// Why an array is not that of the robot this map is made with; empty if it is.
  std::string misfit(const SonarArray& array) {
    constexpr double farthest = 10.0;  // m from base_link
    if (!(std::abs(static_cast<double>(array.field_of_view) - 2.0 * params_.mapper.model.half_aperture) < 0.01))
      return "its cones do not open as wide as twice half_aperture";
    if (!(array.min_range >= 0.0f && array.max_range > array.min_range)) return "its ranges are none";
    for (const auto& reading : array.readings)
      if (!(std::abs(reading.x) <= farthest && std::abs(reading.y) <= farthest && std::isfinite(reading.yaw)))
        return "a sonar of it is not on the robot";
    if (ring_ == 0) ring_ = array.readings.size();
    return array.readings.size() == ring_ ? "" : "it has not as many sonars as before";
  }

  void place(Time now) {
    readings_.release(now, [this](const geometry::Pose2& pose, const Sample<SonarArray>& array, Time) {
      const SonarLimits limits{static_cast<double>(array->min_range), static_cast<double>(array->max_range)};
      for (const auto& reading : array->readings) {
        const geometry::Pose2 transducer{static_cast<double>(reading.x), static_cast<double>(reading.y),
                                         static_cast<double>(reading.yaw)};
        count(mapper_.add(pose * transducer, static_cast<double>(reading.range), limits));
      }
    });
  }

  void count(ReadingResult result) {
    switch (result) {
      case ReadingResult::echo:
      case ReadingResult::no_echo: ++added_; return;
      case ReadingResult::not_fired: return;
      case ReadingResult::refused_range:
        ++refused_ranges_;
        trouble_ = "sonar: ranges that are no distance are left out";
        return;
      case ReadingResult::refused_place:
        ++refused_ranges_;
        trouble_ = "odom: the robot is too far away from the map's origin";
        return;
      case ReadingResult::refused_memory:
        ++refused_memory_;
        trouble_ = "the map may not grow any more, memory is used up: readings beyond it are left out";
        return;
    }
  }

  void on_tick(Time now) {
    const auto dropped = readings_.late() + readings_.unplaced() + readings_.bad_poses();
    if (dropped != dropped_ && trouble_.empty()) trouble_ = "sonar: readings without a pose of their time are left out";
    dropped_ = dropped;
    place(now);
    ports_.publish(mapper_, now, params_.frame);
    if (!trouble_.empty())
      report_degraded(trouble_);
    else if (const std::string missing = !odom_.missing().empty() ? odom_.missing() : sonar_.missing(); missing.empty())
      report_active();
    else if (now - activated_ >= params_.period)  // At the first tick nobody can have published yet.
      report_degraded(missing);
    trouble_.clear();
  }

  void on_deactivate(Time now) override { ports_.publish(mapper_, now, params_.frame); }

  void on_shutdown(Time) override {
    log().info("{} readings in the map of {} x {} cells, {} tiles published", added_, mapper_.box().columns,
               mapper_.box().rows, ports_.published());
    if (refused_ranges_ + refused_arrays_ + refused_memory_ + dropped_ > 0)
      log().warn("left out: {} ranges, {} arrays, {} readings for want of memory, {} late or without a pose",
                 refused_ranges_, refused_arrays_, refused_memory_, dropped_);
  }
};

}  // namespace
}  // namespace kervan::mapping

KERVAN_COMPONENT(kervan::mapping::SonarComponent, "mapping/sonar", "Makes a map out of what sonars measure.")
