#include <fstream>

#include "framework/kervan.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"

namespace kervan::scenario {
namespace {

struct CommandRecorderParams {
  std::string file;

  template <class Visitor>
  void describe(Visitor& v) {
    v(file, "file",
      {.help = "Gets a line 'speed turning-rate' for every command; may be a named pipe.", .required = true});
  }
};

/// Writes down what the drive is told, as a drive would hear it, so that a test can see the last word of a run.
class CommandRecorder final : public Component {
  const CommandRecorderParams& params_ = parameters<CommandRecorderParams>();
  Input<geometry_msgs::msg::TwistStamped> command_{this, "command", qos::command, &CommandRecorder::on_command,
                                                   "Speed for the drive."};
  std::ofstream file_;

  void on_activate(Time) override { file_.open(params_.file); }
  void on_command(const geometry_msgs::msg::TwistStamped& command, Time) {
    file_ << command.twist.linear.x << ' ' << command.twist.angular.z << std::endl;
  }
};

}  // namespace
}  // namespace kervan::scenario

KERVAN_COMPONENT(kervan::scenario::CommandRecorder, "scenario/command_recorder", "Writes down what the drive is told.")
