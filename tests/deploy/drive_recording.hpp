/// What test/drive_recorder wrote down, and whether a robot that nobody commanded any more braked.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace kervan::test {

/// The component of the laboratory that writes drive.csv.
inline constexpr const char* kDriveRecorder =
    "recorder: {type: test/drive_recorder, remap: {raw: r1/guard/cmd_vel_raw, command: r1/guard/cmd_vel, "
    "truth: world/r1/truth}}";

/// A speed in m/s, and when it was wanted, told or driven; s of the simulator.
struct SpeedAt {
  double time, value;
};

struct DriveRecording {
  std::vector<SpeedAt> raw;      ///< what the controller wanted
  std::vector<SpeedAt> command;  ///< what the drive was told
  std::vector<SpeedAt> speed;    ///< what it did, every step
};

/// Reads drive.csv.
DriveRecording read_drive(const std::string& csv);

/// What was wanted, told and done from one time to another, in the order of time, for whoever reads a failure.
std::string excerpt(const DriveRecording& recording, double from, double to);

constexpr double kFullBraking = 0.6;  ///< m/s2, of robots/p3dx.yaml
constexpr double kLongest = 0.250;    ///< s, from the last fresh command to the beginning of full braking
constexpr double kPeriod = 0.050;     ///< s, of the drive guard

/// A time of more than kLongest without a command.
struct Silence {
  double last, next;  ///< s, when the commands before and after it came
  /// Seconds from `last` until full braking began. Infinite if it did not before `next`, nothing if the robot stood
  /// anyway.
  std::optional<double> braking;
  double lost = 0.0;  ///< s, in which it did not go on after that, before the robot stood or `next` came
};

/// All of them that ended.
std::vector<Silence> silences(const std::vector<SpeedAt>& commands, const std::vector<SpeedAt>& speed);

/// The longest time without a command that touches [from, to].
double longest_pause(const std::vector<SpeedAt>& commands, double from, double to);

}  // namespace kervan::test
