/// Makes of what the sensors say what the behaviours are told.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "components/behavior/felt_obstacles.hpp"
#include "components/behavior/situation.hpp"

namespace kervan::behavior {

/// On which side of the robot the wall is.
enum class Side { right, left };

/// The defaults are a Pioneer P3-DX. Points are in base_link, m.
struct SensesParams {
  Side side = Side::right;
  Duration remember = std::chrono::seconds(15);      ///< a contact
  Duration oldest = std::chrono::milliseconds(500);  ///< a transducer that has not fired for so long hears nothing
  double nose = 0.211;        ///< m before base_link: where an obstacle is that stalls a wheel in driving forward
  double tail = 0.300;        ///< m behind it, in reversing
  double half_width = 0.110;  ///< m to the left or right of the middle, by the wheel that is stalled
};

/// Keeps the last word of each sensor. What cannot be is left out and counted.
class Senses {
 public:
  explicit Senses(const SensesParams& params) : params_(params), felt_(params.remember) {}

  /// A round of the sonars. A range beyond `max_range` is no echo; NaN says that the transducer did not fire in this
  /// round, and its last reading stays until it is too old; a negative one is no reading and refused. Returns one
  /// sentence if the ring does not fit; then the last good round stays.
  std::string hear(std::span<const SonarReading> readings, double max_range, Time now);

  /// Where the robot is by its odometry. False, refused, if that is not finite.
  bool move(const geometry::Pose2& pose, const geometry::Twist2& speed);

  /// The places of the bumper segments that are pressed. Those that are not finite are refused.
  void press(std::span<const geometry::Vector2> pressed, Time now);
  void stall(const Stall& stall, Time now);

  /// Whether sonars and odometry have said something usable.
  bool complete() const { return heard_ && moved_; }

  /// For a wall on the right, mirrored if it is on the left. Needs complete().
  Situation at(Time now);

  /// The wish of a behaviour that was given at(), as the robot is to do it.
  Wish unmirrored(const Wish& wish) const { return params_.side == Side::left ? mirrored(wish) : wish; }

  bool absurd() const { return absurd_; }  ///< the last round had negative ranges
  std::uint64_t refused() const { return refused_; }

 private:
  SensesParams params_;
  FeltObstacles felt_;
  Situation last_;
  std::array<Time, ring_size> fired_{};
  double direction_ = 1.0;  // the robot last drove to: 1 forward, -1 backward
  bool heard_ = false;
  bool absurd_ = false;
  bool moved_ = false;
  std::uint64_t refused_ = 0;
};

}  // namespace kervan::behavior
