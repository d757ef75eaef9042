/// Where in their cones the echoes of a moving ring of sonars came from.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "components/mapping/sonar_mapper.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::localization {

/// One transducer's word.
struct SonarEcho {
  geometry::Pose2 transducer;  ///< in base_link, x along the axis of its cone
  double range = 0.0;          ///< m; NaN: it did not fire
};

struct SonarTriangulationParams {
  double half_aperture = geometry::radians(15.0);  ///< rad, of the cones
  double max_range = 5.0;                          ///< m; echoes from farther away are left out
  double stretch = 0.4;                            ///< m, how far a transducer moves while it hears one thing
  std::size_t least_readings = 6;                  ///< of it
  double range_error = 0.01;                       ///< standard deviation of a reading, as a share of it
  double depth_error = 0.005;                      ///< m, how far from what answered a point may be expected to lie
};

/// A place that answered, and where the transducer was that heard it, seen from base_link.
struct SonarPoint {
  geometry::Vector2 transducer;
  geometry::Vector2 point;
};

/// An echo came from anywhere on the arc of its cone. Several of one transducer, heard from different places, came from
/// what all their arcs touch (Leonard and Durrant-Whyte 1992, "Directed Sonar Sensing for Mobile Robot Navigation";
/// triangulation: Wijk and Christensen 2000, doi:10.1109/70.897785): how the distance changes along the transducer's
/// way says in which direction that lies. It has to be within all of the cones, which by itself says much when the
/// robot turns on the spot. Nothing is said of echoes whose direction stays uncertain.
class SonarTriangulation {
 public:
  explicit SonarTriangulation(const SonarTriangulationParams& params) : params_(params) {}

  /// A round made at `odom`, always of as many sonars: where its echoes came from, those of which it is known. NaN is a
  /// sonar that did not fire; every other value that is no echo within the limits ends what its sonar was hearing.
  std::span<const SonarPoint> round(const geometry::Pose2& odom, std::span<const SonarEcho> echoes,
                                    const mapping::SonarLimits& limits);

 private:
  struct Reading {
    geometry::Pose2 transducer;  // in odom
    double range;
  };
  using Track = std::deque<Reading>;  // of one transducer, of what may be one thing

  bool continues(const Track& track, const Reading& reading) const;
  void shorten(Track& track) const;
  std::optional<double> direction(const Track& track) const;

  SonarTriangulationParams params_;
  std::vector<Track> tracks_;
  std::vector<SonarPoint> points_;
};

}  // namespace kervan::localization
