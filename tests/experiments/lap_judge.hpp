/// Judges by the true poses how well a robot has followed the walls of a world.
#pragma once

#include <optional>
#include <vector>

#include "components/behavior/senses.hpp"
#include "sim/world.hpp"

namespace kervan::test {

/// In the band means: the middle of the line between the two transducers that look to the wall is 350 to 450 mm from
/// the nearest wall. A straight is where the foot on that wall is at least 1.5 m from the end the robot comes from and
/// 1.0 m from the end it goes to.
class LapJudge {
 public:
  /// `middle`: a point that a lap goes round.
  LapJudge(const sim::World& world, const geometry::Vector2& middle, behavior::Side side);

  void add(double time, const geometry::Pose2& robot);

  double laps() const;  ///< rounds about the middle, of either sense
  /// s until it was in the band of a straight for the first time; nothing if it never was.
  std::optional<double> found() const { return found_; }
  /// Of the samples on straights since then, the share in the band; 0 without samples.
  double in_band() const { return on_straight_ == 0 ? 0.0 : static_cast<double>(inside_) / on_straight_; }
  int samples() const { return on_straight_; }

 private:
  std::vector<sim::Segment> walls_;
  geometry::Vector2 middle_;
  geometry::Vector2 ears_;
  std::optional<double> last_angle_;
  double angle_ = 0.0;
  std::optional<double> found_;
  int on_straight_ = 0;
  int inside_ = 0;
};

}  // namespace kervan::test
