#include "tests/deploy/supervised.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace kervan::test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kPatience = 60s;

std::string own_tag() {
  static std::atomic<int> count = 0;
  return "test-" + std::to_string(::getpid()) + "-" + std::to_string(count++) + "-" +
         std::to_string(Clock::now().time_since_epoch().count());
}

}  // namespace

Supervised::Supervised(const std::string& composition, const std::string& clock, const std::string& arguments,
                       const std::string& hosts) {
  std::ofstream(folder_.path() / "c.yaml") << "kervan: 1\nname: c\nclock: {mode: " << clock
                                           << "}\ndomain: {id: 91, tag: " << own_tag() << ", hosts: " << hosts << "}\n"
                                           << composition;
  const fs::path errors = folder_.path() / "errors";
  if (::mkfifo(errors.c_str(), 0600) != 0) throw std::runtime_error("cannot make a pipe");
  errors_ = ::open(errors.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  process_ = std::make_unique<Process>(
      Command{"/bin/sh",
              {"-c", "exec " KERVAN_PROGRAM " run c.yaml --json " + arguments + " 2>errors"},
              {{"KERVAN_COMPONENT_PATH", TEST_COMPONENTS}, {"KERVAN_SHARE", KERVAN_SHARE_FOLDER}}},
      folder_.path());
}

Supervised::~Supervised() {
  process_.reset();
  ::close(errors_);
}

bool Supervised::read_more(int timeout_ms) {
  pollfd readable{errors_, POLLIN, 0};
  if (::poll(&readable, 1, timeout_ms) != 1) return true;
  std::array<char, 4096> buffer{};
  const auto size = ::read(errors_, buffer.data(), buffer.size());
  if (size > 0) said_.append(buffer.data(), static_cast<std::size_t>(size));
  return size > 0 || (size < 0 && errno == EAGAIN);
}

std::string Supervised::wait_for(const std::string& text) {
  const auto end = Clock::now() + kPatience;
  for (;;) {
    const auto at = said_.find(text, seen_);
    const auto line_end = at == std::string::npos ? at : said_.find('\n', at);
    if (line_end != std::string::npos) {
      seen_ = line_end;
      const auto begin = said_.rfind('\n', at) + 1;
      return said_.substr(begin, line_end - begin);
    }
    if (Clock::now() >= end || !read_more(1000))
      throw std::runtime_error("'" + text + "' did not come; this was said:\n" + said_);
  }
}

std::map<std::string, pid_t> Supervised::containers() const {
  std::map<std::string, pid_t> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string pid = entry.path().filename();
    if (pid.find_first_not_of("0123456789") != std::string::npos) continue;
    std::string line = text_of(entry.path() / "cmdline");  // the arguments, each ended by a zero
    if (line.find(folder_.path().string()) == std::string::npos || !line.starts_with('/')) continue;
    std::vector<std::string> arguments;
    for (std::size_t begin = 0; begin < line.size();) {
      const auto end = line.find('\0', begin);
      arguments.push_back(line.substr(begin, end - begin));
      begin = end + 1;
    }
    if (arguments.size() > 2 && arguments[0].ends_with("/kervan-container")) found[arguments[2]] = std::stoi(pid);
  }
  return found;
}

pid_t Supervised::container(const std::string& name) const {
  const auto all = containers();
  const auto found = all.find(name);
  if (found == all.end()) throw std::runtime_error("there is no process of the container " + name);
  return found->second;
}

void Supervised::signal(int number) { process_->signal(number); }

void Supervised::wait_until_nobody_lives(std::chrono::seconds patience) {
  const auto end = Clock::now() + patience;
  while (read_more(1000))
    if (Clock::now() >= end) throw std::runtime_error("somebody still lives; this was said:\n" + said_);
}

Result Supervised::wait(std::chrono::seconds patience) {
  wait_until_nobody_lives(patience);
  result_ = process_->wait();
  result_.err = said_;
  return result_;
}

nlohmann::json Supervised::row(const std::string& name) const {
  const nlohmann::json rows = summary()["containers"];
  for (const auto& row : rows)
    if (row["name"] == name) return row;
  throw std::runtime_error("there is no row of " + name + " in " + result_.out);
}

std::string Supervised::file(const std::string& name) const {
  for (const auto& entry : fs::directory_iterator(folder_.path() / "runs")) return text_of(entry.path() / name);
  return {};
}

std::string split_over(const std::string& name, const std::vector<std::pair<std::string, std::string>>& containers,
                       const std::vector<std::string>& more) {
  const std::string whole = text_of(fs::path(KERVAN_SOURCES) / "deploy/compositions" / (name + ".yaml"));
  // Everything but the head, which Supervised writes, with the arguments as they are.
  const auto arguments = whole.find("\nargs:"), clock = whole.find("\nclock:"), after = whole.find('\n', clock + 1),
             mission = std::min(whole.find("\nmission:"), whole.size() - 1);
  std::string text = whole.substr(arguments + 1, clock - arguments) + whole.substr(after + 1, mission - after);
  for (const std::string& component : more) text += "  " + component + "\n";
  text += whole.substr(mission + 1) + "containers:\n";
  for (const auto& [container, components] : containers)
    text += "  " + container + ": {components: " + components + "}\n";
  return text;
}

std::string lab_over(const std::vector<std::pair<std::string, std::string>>& containers,
                     const std::vector<std::string>& more) {
  return split_over("lab", containers, more);
}

int number_from(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::atoi(text) : otherwise;
}

}  // namespace kervan::test
