#include "tests/program/program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace kervan::test {
namespace fs = std::filesystem;
namespace {

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::vector<std::string> environment_of(const Command& command) {
  std::vector<std::string> all;
  for (char** variable = environ; *variable != nullptr; ++variable)
    if (!std::string(*variable).starts_with("KERVAN_")) all.emplace_back(*variable);
  for (const auto& [name, value] : command.environment) all.push_back(name + "=" + value);
  return all;
}

void redirect(int descriptor, const fs::path& file) {
  const int opened = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(opened, descriptor);
  ::close(opened);
}

}  // namespace

Folder::Folder() {
  std::string name = (fs::temp_directory_path() / "kervan_test_XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::vector<std::string> Folder::everything_in_it() const {
  std::vector<std::string> paths;
  for (const auto& entry : fs::recursive_directory_iterator(path_))
    paths.push_back(fs::relative(entry.path(), path_).string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

Process::Process(const Command& command, const fs::path& working_folder) {
  std::vector<std::string> arguments = command.arguments, environment = environment_of(command);
  arguments.insert(arguments.begin(), command.program);
  const std::vector<char*> argv = pointers(arguments), envp = pointers(environment);
  pid_ = ::fork();
  if (pid_ < 0) throw std::runtime_error("cannot fork");
  if (pid_ > 0) return;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  redirect(STDOUT_FILENO, output_.path() / "out");
  redirect(STDERR_FILENO, output_.path() / "err");
  if (::chdir(working_folder.c_str()) == 0) ::execve(argv[0], argv.data(), envp.data());
  ::_exit(127);
}

Process::~Process() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

void Process::signal(int number) { ::kill(pid_, number); }

Result Process::wait(std::chrono::seconds longest) {
  const int descriptor = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));
  pollfd ended{descriptor, POLLIN, 0};
  const int ready = ::poll(&ended, 1, static_cast<int>(std::chrono::milliseconds(longest).count()));
  ::close(descriptor);
  if (ready != 1) ::kill(pid_, SIGKILL);
  int status = 0;
  ::waitpid(pid_, &status, 0);
  pid_ = -1;
  return {ready == 1 && WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(output_.path() / "out"),
          text_of(output_.path() / "err")};
}

Result run(const Command& command, const fs::path& working_folder) { return Process(command, working_folder).wait(); }

Result run_line(const std::string& program, const std::string& arguments, const fs::path& working_folder) {
  return run({"/bin/sh", {"-c", "exec '" + program + "' " + arguments}}, working_folder);
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace kervan::test
