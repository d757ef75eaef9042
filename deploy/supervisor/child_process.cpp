#include "deploy/supervisor/child_process.hpp"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

#include "deploy/container/control_channel.hpp"

namespace kervan::supervisor {
namespace {

constexpr int kControlDescriptor = 3;  ///< in the child

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

/// What runs in the child before it becomes the program: nothing that allocates or locks.
[[noreturn]] void become(const char* program, char* const* arguments, int control, int output, int network,
                         pid_t parent) {
  ::setpgid(0, 0);
  // Asked for after the fork, so it holds for this process; and if the parent died in between, nobody will tell.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  if (network >= 0 && ::setns(network, CLONE_NEWNET) != 0) ::_exit(127);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGCHLD}) ::signal(number, SIG_DFL);
  const int nothing = ::open("/dev/null", O_RDONLY);
  ::dup2(nothing, STDIN_FILENO);
  if (nothing > STDERR_FILENO) ::close(nothing);
  if (output >= 0) ::dup2(output, STDERR_FILENO);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  if (control == kControlDescriptor)
    ::fcntl(control, F_SETFD, 0);
  else if (control >= 0)
    ::dup2(control, kControlDescriptor);
  ::execv(program, arguments);
  ::_exit(127);
}

}  // namespace

ChildProcess::ChildProcess(const std::filesystem::path& program, std::vector<std::string> arguments, int network) {
  arguments.insert(arguments.end(), {"--control-fd", std::to_string(kControlDescriptor)});
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC | O_NONBLOCK) != 0) fail("cannot make a pipe");
  control_ = pipe[0];
  start(program, std::move(arguments), pipe[1], -1, network);
}

ChildProcess::ChildProcess(const std::filesystem::path& program, std::vector<std::string> arguments,
                           const std::filesystem::path& output) {
  const int file = ::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail(("cannot write " + output.string()).c_str());
  start(program, std::move(arguments), -1, file, -1);
}

void ChildProcess::start(const std::filesystem::path& program, std::vector<std::string> arguments, int control,
                         int output, int network) {
  arguments.insert(arguments.begin(), program.string());
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ == 0) become(arguments.front().c_str(), pointers.data(), control, output, network, parent);
  const int error = errno;
  if (control >= 0) ::close(control);
  if (output >= 0) ::close(output);
  if (pid_ < 0) {
    if (control_ >= 0) ::close(control_);
    errno = error;
    fail("cannot start a process");
  }
  ::setpgid(pid_, pid_);  // both sides ask for it: whoever comes first
  pidfd_ = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));
  if (pidfd_ < 0) {
    const int no_descriptor = errno;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    if (control_ >= 0) ::close(control_);
    errno = no_descriptor;
    fail("cannot watch a process");
  }
  ::fcntl(pidfd_, F_SETFD, FD_CLOEXEC);
}

ChildProcess::~ChildProcess() {
  if (!reaped_) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  ::close(pidfd_);
  if (control_ >= 0) ::close(control_);
}

void ChildProcess::signal(int number) const {
  if (!reaped_) ::kill(pid_, number);
}

std::optional<int> ChildProcess::reap() {
  int status = 0;
  if (reaped_ || ::waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
  reaped_ = true;
  return status;
}

bool ChildProcess::take_stopped() const {
  siginfo_t info{};
  return !reaped_ && ::waitid(P_PID, static_cast<id_t>(pid_), &info, WSTOPPED | WNOHANG) == 0 && info.si_pid == pid_;
}

std::string exit_text(int status) {
  return WIFSIGNALED(status) ? container::signal_name(WTERMSIG(status)) : "exit " + std::to_string(WEXITSTATUS(status));
}

}  // namespace kervan::supervisor
