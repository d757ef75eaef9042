/// Frees a robot whose wheels are stalled.
#pragma once

#include <cstddef>
#include <optional>

#include "components/behavior/situation.hpp"

namespace kervan::behavior {

/// The defaults are those of ArActionStallRecover: 225 mm, 50 cycles of 100 ms, 150 mm/s, 45 degrees.
struct StallRecoverParams {
  double obstacle_distance = 0.225;  ///< m, a reading; nearer than that it does not drive on in the second half
  Duration move_time = std::chrono::seconds(5);     ///< of one attempt
  double speed = 0.15;                              ///< m/s
  double turn = geometry::radians(45.0);            ///< rad, of one attempt
  Duration again_within = std::chrono::seconds(5);  ///< a stall so soon after an attempt is answered by the next one
};

/// ArActionStallRecover of ARIA (reedhedges/AriaCoda b0d02e05): back | turn, forward | turn, back, forward, turn left,
/// turn right, back | left, back | right, forward | left, forward | right, one after the other as long as stalls follow
/// each other, from the beginning after a pause. "Turn" is away from the wheel that is stalled; with both, away from
/// the side whose sonars (-120..-60 and 60..120 degrees) have the nearer echo. In the second half of an attempt it does
/// not drive on towards an obstacle.
class StallRecover {
 public:
  using Params = StallRecoverParams;
  explicit StallRecover(const Params& params) : params_(params) {}
  void set_params(const Params& params) { params_ = params; }

  Wish step(const Situation& situation);

  std::size_t attempt() const { return attempt_; }  ///< the place in the sequence, from 0

 private:
  void begin(const Situation& situation);

  Params params_;
  std::size_t attempt_ = 0;
  bool moving_ = false;
  bool turned_enough_ = false;
  double side_ = 1.0;  // to turn to: 1 left, -1 right
  Time began_{};
  std::optional<Time> ended_;
  TurnedAngle turned_;
};

}  // namespace kervan::behavior
