#include "tests/conformance/wire/peer.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <thread>

namespace kervan::test {

namespace {

void check(int error, const char* what) {
  if (error != 0) throw std::system_error(error, std::generic_category(), what);
}

}  // namespace

Peer::Peer(std::vector<std::string> arguments) {
  int in[2];
  int out[2];
  if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0) check(errno, "pipe2");
  to_ = in[1];
  from_ = out[0];
  fcntl(from_, F_SETFL, O_NONBLOCK);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  arguments.insert(arguments.begin(), "peer");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const int error = posix_spawn(&pid_, "/proc/self/exe", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(in[0]);
  close(out[1]);
  check(error, "posix_spawn");
}

Peer::~Peer() {
  close_stdin();
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  close(from_);
}

void Peer::close_stdin() {
  if (to_ >= 0) close(to_);
  to_ = -1;
}

void Peer::tell(const std::string& line) {
  const std::string text = line + "\n";
  if (write(to_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) check(errno, "write");
}

const std::vector<std::string>& Peer::lines() {
  char buffer[4096];
  for (ssize_t size; (size = read(from_, buffer, sizeof buffer)) > 0;)
    unfinished_.append(buffer, static_cast<std::size_t>(size));
  for (std::size_t end; (end = unfinished_.find('\n')) != std::string::npos; unfinished_.erase(0, end + 1))
    lines_.push_back(unfinished_.substr(0, end));
  return lines_;
}

bool Peer::has_said(const std::string& line) {
  const auto& said = lines();
  return std::find(said.begin(), said.end(), line) != said.end();
}

std::size_t Peer::lines_that_begin_with(const std::string& beginning) {
  const auto& said = lines();
  return static_cast<std::size_t>(
      std::count_if(said.begin(), said.end(), [&](const std::string& line) { return line.starts_with(beginning); }));
}

void Peer::signal(int number) { kill(pid_, number); }

int Peer::end() {
  close_stdin();
  int status = 0;
  const bool ended = eventually([&] {
    lines();  // a full pipe would hold it up
    return waitpid(pid_, &status, WNOHANG) == pid_;
  });
  if (!ended) return -1;
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace kervan::test
