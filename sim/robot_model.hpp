/// What a kind of robot is: body, limits and where its sensors sit. Data; robots/*.yaml gives it with its sources.
/// SI units and radians, in the robot's frame base_link: the point between the driven wheels, x forward, y left. The
/// body of a synchro drive does not turn with base_link; its sensors are given as they sit at the start of a run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/outline.hpp"

namespace kervan::sim {

/// How the wheels move the body.
enum class DriveType {
  differential,  ///< left and right wheels that turn the body when they roll differently
  synchro        ///< wheels that are driven and steered together: base_link looks where they go, the body never turns
};

/// Limits of a drive. All positive.
struct DriveLimits {
  double speed = 0.0;                 ///< m/s, forward and backward
  double turn_rate = 0.0;             ///< rad/s, to either side
  double acceleration = 0.0;          ///< m/s2, away from standstill
  double deceleration = 0.0;          ///< m/s2, towards standstill
  double angular_acceleration = 0.0;  ///< rad/s2, away from and towards standstill
};

/// A set of equal sonars.
struct SonarRing {
  double min_range = 0.0;      ///< m; nearer echoes are reported at this distance
  double max_range = 0.0;      ///< m; farther ones are not heard
  double field_of_view = 0.0;  ///< rad, the whole cone
  std::vector<Pose2> poses;    ///< of the transducers, looking along their x axis, in the order of their numbers
  /// Which transducers form an array: those of one array fire one after the other, in this order, the arrays side by
  /// side. Each transducer is in one array; without any array all are in one, in the order of their numbers.
  std::vector<std::vector<std::uint16_t>> arrays = {};
};

/// A planar laser range finder. Its beams are spread evenly over the field of view: the first and the last stand at its
/// edges, and beam i is the next one to the left of beam i - 1.
struct LaserMount {
  Pose2 pose;                  ///< of the device, which looks along its x axis
  int beams = 0;               ///< at least 2
  double field_of_view = 0.0;  ///< rad, between the first and the last beam; less than a full turn
  double min_range = 0.0;      ///< m; nearer echoes are not measured
  double max_range = 0.0;      ///< m; farther ones neither
};

/// rad between neighbouring beams.
inline double beam_spacing(const LaserMount& laser) { return laser.field_of_view / (laser.beams - 1); }

/// The bumpers that can be fitted to a robot, in straight segments of equal length. Each is given by its middle, with
/// the x axis outwards, across the segment. The front segments come before the rear ones in every list of segments.
struct BumperMount {
  double length = 0.0;  ///< m, of each segment
  std::vector<Pose2> front = {};
  std::vector<Pose2> rear = {};
};

enum class BumperSet { none, front, rear, both };

/// How far a robot's dead reckoning is from perfect. All may be 0.
struct OdometryErrors {
  double drift = 0.0;       ///< bound of one scale error per metre and one per radian, drawn once a run; in [0, 1)
  double wheel = 0.0;       ///< bound of the scale error of each wheel, drawn once a run; in [0, 1)
  double slip = 0.0;        ///< m; standard deviation of what slipping does to a wheel's travel within its first metre
  double resolution = 0.0;  ///< m of a wheel's travel for one tick of its encoder; 0: as fine as numbers are
};

struct RobotModel {
  std::string name;
  Outline outline;  ///< of the body with the bumpers that are fitted
  DriveLimits drive;
  DriveType drive_type = DriveType::differential;
  double track = 0.0;  ///< m between left and right wheels, as the robot's own odometry has it; 0 for a synchro drive
  SonarRing sonars = {};
  std::optional<LaserMount> laser = std::nullopt;
  BumperMount bumpers = {};
  BumperSet fitted = BumperSet::none;  ///< which of the bumpers the robot wears; with_bumpers() changes it
  OdometryErrors odometry = {};        ///< typical of this kind of robot
};

/// The segments that the robot wears.
std::vector<Pose2> fitted_bumpers(const RobotModel& model);

/// The model, which wears none yet, with a set of its bumpers: the outline becomes the convex hull of body and bumpers.
/// Throws std::invalid_argument if the model has no such bumpers.
RobotModel with_bumpers(RobotModel model, BumperSet fitted);

/// How deep the middle or the ends of a segment lie within the hull of the body and all bumpers, m. Segments on the
/// outside have 0; one that lies deeper can feel nothing.
double depth_of_bumper(const RobotModel& model, const Pose2& segment);

/// Throws std::invalid_argument with one sentence that says which value cannot be.
void require_valid(const RobotModel& model);

}  // namespace kervan::sim
