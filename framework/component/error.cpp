#include "framework/component/error.hpp"

#include <utility>

namespace kervan {
namespace {

/// A value from a file may hold line breaks; an error is one line all the same.
std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return text;
}

std::string prefixed(const std::string& prefix, const std::string& message) {
  return one_line(prefix.empty() ? message : prefix + ": " + message);
}

}  // namespace

std::string to_text(const Location& location) {
  std::string text = location.file;
  if (location.line > 0) {
    text += ":" + std::to_string(location.line);
    if (location.column > 0) text += ":" + std::to_string(location.column);
  }
  return text;
}

ConfigError::ConfigError(Location location, const std::string& message)
    : std::runtime_error(prefixed(to_text(location), message)), location_(std::move(location)), message_(one_line(message)) {}

ParameterError::ParameterError(std::string parameter, const std::string& message)
    : std::runtime_error(prefixed(parameter, message)), parameter_(std::move(parameter)), message_(one_line(message)) {}

}  // namespace kervan
