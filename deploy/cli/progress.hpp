/// Shows how far a run has come: a bar on a terminal, a line every few seconds elsewhere.
#pragma once

#include <chrono>
#include <string>

#include "framework/component/time.hpp"

namespace kervan::cli {

class Progress {
 public:
  /// `expected` is the longest the run can take on its own clock, `forever` if nobody knows.
  Progress(Duration expected, bool terminal);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(Duration simulated);

  /// A line that stays.
  void say(const std::string& text);
  /// On a terminal a line that the next call replaces; elsewhere one that is not repeated.
  void say_for_now(const std::string& text);

  /// The run is over: on a terminal the bar stays as it was at the end, with the speed of the whole run.
  void finish(Duration simulated, double wall_s);

 private:
  std::string line(Duration simulated, double wall) const;

  Duration expected_;
  bool terminal_;
  bool shown_ = false;
  std::string said_;  ///< for now
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_;
};

/// "34.2 s of 90.0 s, 117x"; the parts that are not known are left out.
std::string progress_text(Duration simulated, Duration expected, double wall_s);

}  // namespace kervan::cli
