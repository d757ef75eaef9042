/// A process that this one started: in a process group of its own, and gone when this one is.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kervan::supervisor {

class ChildProcess {
 public:
  /// Starts `program` with these arguments and "--control-fd N", N being the end of a pipe for it to write to. Its
  /// standard input is empty, its standard output goes to our standard error. It runs in the network namespace that
  /// the descriptor `network` stands for, in ours if that is -1. To be called from the main thread: the kernel kills
  /// the child when the thread that made it ends. Throws std::system_error.
  ChildProcess(const std::filesystem::path& program, std::vector<std::string> arguments, int network = -1);
  /// The same without a control pipe, for a program that knows of none: what it prints goes to the file `output`, which
  /// is made anew.
  ChildProcess(const std::filesystem::path& program, std::vector<std::string> arguments,
               const std::filesystem::path& output);
  /// Kills it if it still runs, and waits for its end.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  int ended_descriptor() const { return pidfd_; }      ///< readable once it has ended
  int control_descriptor() const { return control_; }  ///< -1 without a control pipe

  void signal(int number) const;

  /// The status as of waitpid(), once it has ended.
  std::optional<int> reap();
  /// True once after it was stopped by a signal (SIGSTOP): it lives, and does nothing any more.
  bool take_stopped() const;

 private:
  /// `control` and `output` are the child's ends, or -1; this closes them.
  void start(const std::filesystem::path& program, std::vector<std::string> arguments, int control, int output,
             int network);

  pid_t pid_ = -1;
  int pidfd_ = -1;
  int control_ = -1;
  bool reaped_ = false;
};

/// "exit 1", "SIGKILL"
std::string exit_text(int status);

}  // namespace kervan::supervisor
