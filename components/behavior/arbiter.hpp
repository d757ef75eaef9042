/// Decides which of several behaviours drives.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::behavior {

/// What one behaviour wants, as it last said.
struct Request {
  std::string behaviour;
  int priority = 0;
  int hold = 0;         ///< added to the priority while it drives: who wants to take over has to be above that
  bool active = false;  ///< false: it is alive and wants nothing
  Duration valid_for{0};
  geometry::Twist2 twist;
  std::string why;
};

/// Who drives, and who would like to.
struct Decision {
  std::string behaviour;  ///< empty: nobody, and `twist` is zero
  int priority = 0;
  geometry::Twist2 twist;
  std::string why;
  std::vector<std::string> waiting;  ///< active ones that lost, highest priority first
  std::vector<std::string> expired;  ///< forgotten since the last decision, in order of their names
};

/// Fixed priorities, as in the subsumption architecture (R. A. Brooks, A robust layered control system for a mobile
/// robot, IEEE J. Robotics and Automation 2(1), 1986), with a hysteresis that a behaviour may ask for. Equal
/// priorities: the one that drives, else the one whose name sorts first.
class Arbiter {
 public:
  /// `period`: time between two decisions. A request that would turn too old before the next one is forgotten now, so
  /// that nobody drives on a request for longer than it is valid.
  explicit Arbiter(Duration period) : period_(period) {}

  /// Takes a request that was received at `received`. One that is not finite, has no name or is valid for no time at
  /// all is refused (false) and counted; what the behaviour had asked for before runs on until it is too old.
  bool take(Time received, const Request& request);

  /// The behaviour has ended in good order.
  void withdraw(const std::string& behaviour);

  Decision decide(Time now);

  std::uint64_t refused() const { return refused_; }

 private:
  struct Held {
    Request request;
    Time until;
  };

  Duration period_;
  std::map<std::string, Held> requests_;
  std::string driving_;
  std::uint64_t refused_ = 0;
};

}  // namespace kervan::behavior
