#include "tests/deploy/drive_recording.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <map>
#include <sstream>

#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

constexpr double kStanding = 0.05;  ///< m/s

Silence judged(const std::vector<SpeedAt>& speed, double last, double next) {
  const auto at = [&](double time) {
    return std::lower_bound(speed.begin(), speed.end(), time, [](const SpeedAt& s, double t) { return s.time < t; });
  };
  const auto latest = at(last + kLongest), end = at(next);
  if (latest == speed.end() || std::abs(latest->value) < kStanding) return {last, next, std::nullopt};
  auto begin = end;
  double pause = 0.0, lost = 0.0;
  for (auto one = at(last); one != end && one + 1 != speed.end() && one->value != 0.0; ++one) {
    const double fall = std::abs(one->value) - std::abs((one + 1)->value), dt = (one + 1)->time - one->time;
    const bool full = fall >= 0.95 * kFullBraking * dt;
    if (full && begin == end) begin = one, lost = 0.0;
    pause = full ? 0.0 : pause + dt;
    if (!full) lost += dt;
    // It had only slowed down, to a lower speed that was wanted.
    if (pause > kPeriod && (one + 1)->time < last + kLongest) begin = end;
  }
  if (begin == end) return {last, next, std::numeric_limits<double>::infinity()};
  return {last, next, begin->time - last, lost};
}

}  // namespace

DriveRecording read_drive(const std::string& csv) {
  DriveRecording recording;
  for (const std::string& line : lines_of(csv)) {
    std::istringstream fields(line);
    std::string what, time, value;
    std::getline(fields, what, ',');
    std::getline(fields, time, ',');
    std::getline(fields, value, ',');
    auto& samples = what == "raw" ? recording.raw : what == "command" ? recording.command : recording.speed;
    samples.push_back({std::stod(time) * 1e-9, std::stod(value)});
  }
  return recording;
}

std::string excerpt(const DriveRecording& recording, double from, double to) {
  std::multimap<double, std::string> lines;
  const auto add = [&](const char* what, const std::vector<SpeedAt>& samples) {
    for (const SpeedAt& sample : samples) {
      if (sample.time < from || sample.time > to) continue;
      std::ostringstream line;
      line << std::fixed << std::setprecision(3) << sample.time << " s " << what << ' ' << sample.value << " m/s\n";
      lines.emplace(sample.time, line.str());
    }
  };
  add("wanted", recording.raw);
  add("told", recording.command);
  add("done", recording.speed);
  std::string text;
  for (const auto& [time, line] : lines) text += line;
  return text;
}

std::vector<Silence> silences(const std::vector<SpeedAt>& commands, const std::vector<SpeedAt>& speed) {
  std::vector<Silence> found;
  for (std::size_t i = 0; i + 1 < commands.size(); ++i) {
    const double last = commands[i].time, next = commands[i + 1].time;
    if (next - last > kLongest + 1e-6) found.push_back(judged(speed, last, next));
  }
  return found;
}

double longest_pause(const std::vector<SpeedAt>& commands, double from, double to) {
  double longest = 0.0;
  for (std::size_t i = 0; i + 1 < commands.size(); ++i)
    if (commands[i + 1].time >= from && commands[i].time <= to)
      longest = std::max(longest, commands[i + 1].time - commands[i].time);
  return longest;
}

}  // namespace kervan::test
