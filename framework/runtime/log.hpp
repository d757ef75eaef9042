/// Where components log: the run's folder and /rosout (as rcl_interfaces/msg/Log) get every line of the component's
/// level and above, the console only warnings and above. Lines carry the composition's time, so that the log of a
/// lockstep run can be compared with another's.
#pragma once

#include <spdlog/common.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "framework/component/time.hpp"

namespace spdlog {
class logger;
}

namespace kervan::dds {
class Domain;
}

namespace kervan::runtime {

/// The time that lines logged in this thread carry, while it exists.
class LogTime {
 public:
  explicit LogTime(Time now);
  ~LogTime();
  LogTime(const LogTime&) = delete;
  LogTime& operator=(const LogTime&) = delete;

 private:
  Time outer_;
};

class LogSinks {
 public:
  /// `file` empty: none; else lines are added at its end. `rosout` nullptr: nothing is published.
  LogSinks(bool console, const std::filesystem::path& file, dds::Domain* rosout);
  ~LogSinks();

  /// `level` is one of spdlog's names.
  std::shared_ptr<spdlog::logger> make(const std::string& name, const std::string& level) const;

 private:
  std::vector<spdlog::sink_ptr> sinks_;
};

}  // namespace kervan::runtime
