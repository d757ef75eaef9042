/// What a container's process tells its supervisor: one JSON object a line, over a pipe that it inherited. The other
/// way there are signals only.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "deploy/container/report.hpp"

namespace kervan::container {

/// How far a container has come. The names of the values are those on the pipe.
enum class Phase {
  starting,     ///< the process runs
  constructed,  ///< all components and endpoints are there; it waits for its peers
  matched,      ///< every peer it needs has been found
  active,       ///< the components run
};
std::string_view to_text(Phase phase);

struct Progress {
  double simulated_s = 0.0;  ///< as in EndReport
  Counters counters;
};

/// A signal that ends the process, caught on its way.
struct Crash {
  int signal = 0;
  std::string address;    ///< hexadecimal, of the access or the instruction that failed; empty if there is none
  std::string component;  ///< empty: in no component's code
  std::string handler;    ///< "a timer", "its constructor", the name of a port
  std::int64_t time_ns = 0;
};

/// The container could not be made, or its run broke off.
struct Failure {
  std::string message;
  bool configuration = false;  ///< another try would fail in the same way
};

using Message = std::variant<Phase, Progress, Crash, Failure, EndReport>;

/// Without the line's end.
std::string to_line(const Message& message);

/// Throws ConfigError for anything that to_line() does not write.
Message parse_line(const std::string& line);

/// "SIGSEGV"; "signal 99" for one without a name.
std::string signal_name(int signal);

/// "crashed: SIGSEGV at address 0x0 in r1/control (in a timer)"
std::string to_text(const Crash& crash);

/// The container's end. A pipe that is full loses progress, never anything else; one that nobody reads ends nothing.
class ControlChannel {
 public:
  /// `descriptor` is the pipe, -1 if nobody listens.
  explicit ControlChannel(int descriptor);
  ControlChannel(const ControlChannel&) = delete;
  ControlChannel& operator=(const ControlChannel&) = delete;

  void send(const Message& message);
  int descriptor() const { return descriptor_; }

 private:
  std::mutex mutex_;
  int descriptor_;
};

/// The supervisor's end: cuts what comes into lines.
class ControlReader {
 public:
  /// Everything that can be read now from a non-blocking descriptor. `open` becomes false at the end of the stream.
  std::vector<std::string> read_lines(int descriptor, bool& open);

 private:
  std::string rest_;
};

}  // namespace kervan::container
