/// The score of a run in a world of BARN, or in one like them.
///
/// D. Perille, A. Truong, X. Xiao, P. Stone, "Benchmarking Metric Ground Navigation", SSRR 2020,
/// doi:10.1109/SSRR50563.2020.9292572; the protocol is that of the BARN challenge (Daffan/the-barn-challenge).
#pragma once

#include <optional>
#include <string_view>

#include "framework/geometry/pose2.hpp"

namespace kervan::observe {

struct BarnScoreParams {
  geometry::Vector2 goal = geometry::Vector2::Zero();  ///< m, map
  double reference = 0.0;                              ///< m, length of the world's reference path
  double reference_speed = 2.0;  ///< m/s; the optimal time OT is that of the reference path at this speed
  double begun_after = 0.1;      ///< m from the start, where the clock starts
  double within = 1.0;           ///< m from the goal, where a run has succeeded
  double limit = 100.0;          ///< s on the clock, after which it has failed
};

enum class BarnOutcome { running, success, collision, timeout };

/// One word.
std::string_view to_text(BarnOutcome outcome);

/// Times must not go back.
class BarnScore {
 public:
  explicit BarnScore(const BarnScoreParams& params) : params_(params) {}

  /// Where the robot is at `now`, s on any clock, in the frame of the goal. A robot that never begins fails as late
  /// after the first call as one that never ends after its beginning.
  void truth(double now, const geometry::Vector2& position);

  /// The robot has touched something.
  void contact();

  BarnOutcome outcome() const { return outcome_; }
  double time() const { return time_; }      ///< AT: s since the beginning, until the end
  double length() const { return length_; }  ///< m driven

  /// success * OT / clip(AT, 2 OT, 8 OT): 0.5 at best.
  double metric() const;

 private:
  BarnScoreParams params_;
  BarnOutcome outcome_ = BarnOutcome::running;
  std::optional<geometry::Vector2> start_, last_;
  std::optional<double> first_, begun_;
  double time_ = 0.0;
  double length_ = 0.0;
};

}  // namespace kervan::observe
