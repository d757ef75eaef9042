#include <spdlog/spdlog.h>

#include <deque>
#include <stdexcept>

#include "components/grid/messages.hpp"
#include "components/observe/map_quality.hpp"
#include "components/observe/outline.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "kervan_msgs/msg/MapTile.hpp"
#include "kervan_msgs/msg/Outline.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace kervan::observe {
namespace {

using namespace std::chrono_literals;

constexpr Duration patience = 5s;

struct MapQualityParams {
  std::vector<std::string> robots;
  double resolution = 0.05;

  template <class Visitor>
  void describe(Visitor& v) {
    v(robots, "robots", {.help = "Robots whose way shows what of the world can be reached.", .required = true});
    v(resolution, "resolution", {.unit = "m", .min = 0.01, .max = 1.0, .help = "Side of a cell, that of the map."});
  }
};

ValueMap figures_of(const MapQuality& quality) {
  return {{"judged_cells", static_cast<std::int64_t>(quality.judged)},
          {"accuracy", quality.accuracy},
          {"near_accuracy", quality.near_accuracy},
          {"false_occupied", quality.false_occupied},
          {"false_free", quality.false_free},
          {"coverage", quality.coverage},
          {"entropy_bits", quality.entropy_bits},
          {"wall_error_m", quality.wall_error_m},
          {"worst_wall_error_m", quality.worst_wall_error_m}};
}

/// Compares a map with the true world when the run ends (map_quality.hpp), for the run's summary.
class MapQualityComponent final : public Component {
  const MapQualityParams& params_ = parameters<MapQualityParams>();
  std::deque<Input<nav_msgs::msg::Odometry>> truths_ = truths();
  Input<kervan_msgs::msg::Outline> world_{this, "world", qos::latched, "True shape of the world."};
  Input<kervan_msgs::msg::MapTile> tiles_{this, "tiles", qos::latched, &MapQualityComponent::on_tile,
                                          "The map to be judged."};
  Timer tick_{this, 500ms, &MapQualityComponent::on_tick};
  grid::Occupancy map_{params_.resolution, -1, std::size_t{1} << 30};
  std::vector<geometry::Vector2> seeds_;
  std::uint64_t refused_ = 0;
  Time activated_{};

  std::deque<Input<nav_msgs::msg::Odometry>> truths() {
    std::deque<Input<nav_msgs::msg::Odometry>> truths;
    for (const std::string& robot : params_.robots)
      truths.emplace_back(this, robot + "/truth", qos::state, "True pose of " + robot + ".");
    return truths;
  }

  void on_activate(Time now) override { activated_ = now; }

  void on_tile(const kervan_msgs::msg::MapTile& message, Time) {
    const grid::TileView tile = grid::view_of(message);
    if (fault_of(tile, params_.resolution) != grid::TileFault::none || put(tile, map_) == grid::Growth::refused)
      ++refused_;
  }

  void on_tick(Time now) {
    for (const auto& truth : truths_)
      if (const auto* pose = truth.latest(); pose && seeds_.size() < 10'000)
        seeds_.push_back(geometry::position_of(pose->pose.pose));
    if (refused_ > 0) return report_degraded("tiles: those with cells or sizes of another kind are left out");
    std::string missing = world_.missing();
    for (const auto& truth : truths_)
      if (missing.empty()) missing = truth.missing();
    if (missing.empty()) missing = tiles_.missing();
    if (missing.empty())
      report_active();
    else if (now - activated_ >= patience)  // A map takes its time until there is something to publish.
      report_degraded(missing);
  }

  void on_shutdown(Time) override {
    if (refused_ > 0) log().warn("left out {} tiles that do not fit", refused_);
    const auto* world = world_.latest();
    if (!world || seeds_.empty()) {
      log().error("the map cannot be judged: {}", world ? "nobody said where a robot was" : world_.missing());
      return;
    }
    try {
      write_figures(figures_of(judge(map_, MapTruth(drawn_world(*world), seeds_, params_.resolution))));
    } catch (const std::invalid_argument& error) {
      log().error("the map cannot be judged: {}", error.what());
    }
  }
};

}  // namespace
}  // namespace kervan::observe

KERVAN_COMPONENT(kervan::observe::MapQualityComponent, "observe/map_quality",
                 "Compares a map with the true world when the run ends.")
