#include <spdlog/spdlog.h>

#include <cmath>

#include "components/mapping/map_maker.hpp"
#include "components/mapping/sonar_mapper.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"

namespace kervan::mapping {
namespace {

using kervan_msgs::msg::SonarArray;

struct SonarComponentParams {
  SonarMapperParams mapper;
  MapMakerParams map;

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
    map.describe(v);
  }

  SonarMapperParams of_mapper() const {
    SonarMapperParams params = mapper;
    params.most_bytes = map.most_bytes();
    return params;
  }
};

/// Puts the readings of a ring of sonars into a map (sonar_mapper.hpp), from where the odometry says that they were
/// taken.
class SonarComponent final : public MapMaker<SonarComponentParams, SonarMapper, SonarArray> {
 public:
  SonarComponent() : MapMaker("sonar", "readings", "What the sonars measure.") {}

 private:
  std::size_t ring_ = 0;  ///< sonars of the first array
  std::uint64_t added_ = 0, refused_ranges_ = 0, refused_memory_ = 0;

  std::string misfit(const SonarArray& array) override {
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

  void insert(const geometry::Pose2& pose, const SonarArray& array) override {
    const SonarLimits limits{static_cast<double>(array.min_range), static_cast<double>(array.max_range)};
    for (const auto& reading : array.readings) {
      const geometry::Pose2 transducer{static_cast<double>(reading.x), static_cast<double>(reading.y),
                                       static_cast<double>(reading.yaw)};
      count(mapper_.add(pose * transducer, static_cast<double>(reading.range), limits));
    }
  }

  void count(ReadingResult result) {
    switch (result) {
      case ReadingResult::echo:
      case ReadingResult::no_echo: ++added_; return;
      case ReadingResult::not_fired: return;
      case ReadingResult::refused_range:
        ++refused_ranges_;
        return complain("sonar: ranges that are no distance are left out");
      case ReadingResult::refused_place:
        ++refused_ranges_;
        return complain("odom: the robot is too far away from the map's origin");
      case ReadingResult::refused_memory:
        ++refused_memory_;
        return complain("the map may not grow any more, memory is used up: readings beyond it are left out");
    }
  }

  void on_shutdown(Time) override {
    log().info("{} readings in the map of {} x {} cells, {} tiles published", added_, mapper_.box().columns,
               mapper_.box().rows, ports_.published());
    if (refused_ranges_ + misfits() + refused_memory_ + dropped() > 0)
      log().warn("left out: {} ranges, {} arrays, {} readings for want of memory, {} late or without a pose",
                 refused_ranges_, misfits(), refused_memory_, dropped());
  }
};

}  // namespace
}  // namespace kervan::mapping

KERVAN_COMPONENT(kervan::mapping::SonarComponent, "mapping/sonar", "Makes a map out of what sonars measure.")
