/// Shows how far a sweep has come: a bar on a terminal, a line every few seconds elsewhere.
#pragma once

#include <chrono>
#include <string>

#include "deploy/lab/runner.hpp"

namespace kervan::cli {

class SweepProgress {
 public:
  explicit SweepProgress(bool terminal) : terminal_(terminal), last_(Clock::now()) {}
  ~SweepProgress();
  SweepProgress(const SweepProgress&) = delete;
  SweepProgress& operator=(const SweepProgress&) = delete;

  void show(const lab::RunnerProgress& progress);

  /// A line that stays.
  void say(const std::string& text);

 private:
  using Clock = std::chrono::steady_clock;

  bool terminal_;
  bool shown_ = false;
  Clock::time_point last_;
};

/// "12 of 60 runs, 1 failed, 1:20 left"; what is not known or nothing is left out.
std::string progress_text(const lab::RunnerProgress& progress);

}  // namespace kervan::cli
