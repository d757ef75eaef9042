/// A process of the test's own: this very program, started with other arguments. It talks by lines on its stdout and
/// ends when its stdin is closed; whatever happens, it does not outlive the test.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "tests/program/eventually.hpp"

namespace kervan::test {

class Peer {
 public:
  /// Throws std::system_error when no process can be made.
  explicit Peer(std::vector<std::string> arguments);
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  ~Peer();

  pid_t pid() const { return pid_; }

  /// Gives it a line on its stdin.
  void tell(const std::string& line);
  /// The lines it has said so far.
  const std::vector<std::string>& lines();
  bool has_said(const std::string& line);
  std::size_t lines_that_begin_with(const std::string& beginning);

  void signal(int number);
  /// Asks it to end and waits for that; its exit code, 128 + the signal that ended it, or -1 if it does not end.
  int end();

 private:
  void close_stdin();

  pid_t pid_ = -1;
  int to_ = -1;
  int from_ = -1;
  std::string unfinished_;
  std::vector<std::string> lines_;
};

}  // namespace kervan::test
