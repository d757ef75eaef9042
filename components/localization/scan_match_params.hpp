/// The parameters of localization/scan_match.
#pragma once

#include <cstddef>
#include <string>

#include "components/localization/laser_localizer.hpp"
#include "components/localization/sonar_localizer.hpp"
#include "framework/component/parameters.hpp"

namespace kervan::localization {

enum class MatchSensor { laser, sonar };

struct ScanMatchParams {
  MatchSensor sensor = MatchSensor::laser;
  MapLocalizerParams localizer;
  geometry::Pose2 mount;
  double max_range = 30.0;
  double sonar_range = 5.0;
  double half_aperture = geometry::radians(15.0);
  double memory = 128.0;
  std::string frame = "map";
  bool odom_to_base = false;
  Duration max_age = std::chrono::milliseconds(500);
  Duration period = std::chrono::milliseconds(500);

  template <class Visitor>
  void describe(Visitor& v) {
    v(sensor, "sensor", {.choices = {"laser", "sonar"}, .help = "Whose readings are compared with the map."});
    v(localizer.start, "start", {.min = -1e6, .max = 1e6, .help = "Pose of the odometry's frame in the map."});
    v(frame, "frame", {.help = "Name of the map's frame."});
    v(odom_to_base, "odom_to_base", {.help = "Says on /tf where base_link is in odom, too; false if the drive does."});
    v(mount, "mount", {.min = -10.0, .max = 10.0, .help = "Pose of the laser in base_link; sonars bring their own."});
    v(max_range, "max_range",
      {.unit = "m", .min = 0.1, .max = farthest, .help = "Beams that end farther away are not compared."});
    v(sonar_range, "sonar_range",
      {.unit = "m", .min = 0.1, .max = farthest, .help = "Echoes of sonars from farther away are not compared."});
    v(half_aperture, "half_aperture",
      {.unit = "rad", .min = 0.01, .max = 1.5, .help = "Of the sonars' cones, from the axis to the edge."});
    v(localizer.matcher.resolution, "resolution",
      {.unit = "m", .min = 0.02, .max = 0.5, .help = "Side of a cell of the map."});
    v(localizer.matcher.sigma, "sigma",
      {.unit = "m",
       .min = 0.02,
       .max = 0.3,
       .help = "How far from its place in the map an echo may be; of a Gaussian."});
    v(localizer.matcher.least_score, "least_score",
      {.min = 0.0, .max = 1.0, .help = "Echoes whose mean likelihood is less do not fit the map."});
    v(localizer.matcher.rival, "rival",
      {.min = 0.0, .max = 1.0, .help = "Another place, as good as this share of the best, makes a match ambiguous."});
    v(localizer.odometry.distance_error, "distance_error",
      {.min = 0.0, .max = 0.5, .help = "Standard deviation of the wheels' error per metre, constant for a run."});
    v(localizer.odometry.turn_error, "turn_error",
      {.min = 0.0, .max = 0.5, .help = "Standard deviation of the wheels' error per radian, constant for a run."});
    v(localizer.odometry.slip, "slip",
      {.min = 0.0, .max = 0.5, .help = "Standard deviation of the random error in m, and in rad, of the first metre."});
    v(localizer.widest.distance, "search",
      {.unit = "m", .min = 0.15, .max = 3.0, .help = "Farthest from the expected place that a match is looked for."});
    v(localizer.widest.turn, "search_turn", {.unit = "rad", .min = 0.05, .max = 1.5, .help = "The same for the turn."});
    v(memory, "memory", {.unit = "", .min = 0.1, .max = 16384.0, .help = "That the map may take, in MiB."});
    v(max_age, "max_age", {.min = 0.001, .max = 60.0, .help = "Older readings are left out."});
    v(period, "period", {.min = 0.01, .max = 60.0, .help = "Time between two looks at how it goes."});
  }

  LaserLocalizerParams of_laser() const {
    LaserLocalizerParams params;
    params.localizer = localizer;
    params.max_range = max_range;
    params.most_bytes = bytes();
    params.mount = mount;
    return params;
  }

  SonarLocalizerParams of_sonar() const {
    SonarLocalizerParams params;
    const CorrelativeMatcherParams of_sonars = params.localizer.matcher;
    params.localizer = localizer;
    params.localizer.matcher.least_used = of_sonars.least_used;
    params.localizer.matcher.alike = of_sonars.alike;
    params.triangulation.half_aperture = half_aperture;
    params.triangulation.max_range = sonar_range;
    params.most_bytes = bytes();
    return params;
  }

 private:
  static constexpr double farthest = 30.0;  // m

  std::size_t bytes() const { return static_cast<std::size_t>(memory * 1024.0 * 1024.0); }
};

}  // namespace kervan::localization
