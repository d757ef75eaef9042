#include "tests/network/host.hpp"

#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace kervan::test {

Host::Host() {
  std::array<int, 2> pipe{};
  if (::pipe(pipe.data()) != 0) throw NoHosts(std::string("no pipe: ") + std::strerror(errno));
  holder_ = ::fork();
  if (holder_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int error = ::unshare(CLONE_NEWNET) == 0 ? 0 : errno;
    if (::write(pipe[1], &error, sizeof error) != sizeof error || error != 0) ::_exit(1);
    for (;;) ::pause();
  }
  ::close(pipe[1]);
  int error = EIO;
  const bool said = holder_ > 0 && ::read(pipe[0], &error, sizeof error) == sizeof error;
  ::close(pipe[0]);
  if (said && error == 0) {
    ip("link set lo up");
    return;
  }
  if (holder_ > 0) ::waitpid(holder_, nullptr, 0);
  throw NoHosts(std::string("no network namespace can be made: ") + std::strerror(error));
}

Host::~Host() {
  ::kill(holder_, SIGKILL);
  ::waitpid(holder_, nullptr, 0);
}

Command Host::command(const Command& command) const {
  Command there{"/usr/bin/nsenter", {"--net=" + network(), "--", command.program}};
  there.arguments.insert(there.arguments.end(), command.arguments.begin(), command.arguments.end());
  there.environment = command.environment;
  return there;
}

void Host::ip(const std::string& arguments) const {
  const Folder folder;
  const Result result =
      run(command({"/bin/sh", {"-c", "PATH=$PATH:/usr/sbin:/sbin exec ip " + arguments}}), folder.path());
  if (result.code != 0) throw NoHosts("ip " + arguments + ": " + result.err);
}

void Host::connect(Host& other, const std::string& name, const std::string& address, const std::string& address_there) {
  ip("link add " + name + " type veth peer name " + name + " netns " + std::to_string(other.holder_));
  for (const auto& [host, own] : {std::pair<Host*, std::string>(this, address), {&other, address_there}}) {
    host->ip("link set dev " + name + " multicast off");
    host->ip("addr add " + own + "/24 dev " + name);
    host->ip("link set dev " + name + " up");
  }
}

}  // namespace kervan::test
