/// The two errors of configuration. Both are caught once, in main, and end the program with exit code 2.
#pragma once

#include <stdexcept>
#include <string>

namespace kervan {

/// A place in a file a person wrote; line and column count from 1, 0 means unknown.
struct Location {
  std::string file;
  int line = 0;
  int column = 0;
};

/// `file:line:column`, leaving out what is unknown.
std::string to_text(const Location& location);

/// Something a person wrote cannot be used. what() is one line: `file:line:column: what is wrong and what is allowed`.
class ConfigError : public std::runtime_error {
 public:
  ConfigError(Location location, const std::string& message);

  const Location& location() const { return location_; }
  const std::string& message() const { return message_; }  ///< without the location

 private:
  Location location_;
  std::string message_;
};

/// A component refuses a parameter's value. It knows the parameter (`edges[3]`) but not the file; the composition that
/// gave the value turns it into a ConfigError at the place where the value was written.
class ParameterError : public std::runtime_error {
 public:
  ParameterError(std::string parameter, const std::string& message);

  const std::string& parameter() const { return parameter_; }
  const std::string& message() const { return message_; }

 private:
  std::string parameter_;
  std::string message_;
};

}  // namespace kervan
