#include "deploy/lab/link/netem.hpp"

#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

extern char** environ;

namespace kervan::link {
namespace {

using Words = std::vector<std::string>;

std::string decimal(double value, const char* unit) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.6g%s", value, unit);
  return text.data();
}
std::string percent(double value) { return decimal(value, "%"); }
std::string time(Duration value) { return decimal(static_cast<double>(value.count()) / 1e3, "us"); }

std::string joined(const Words& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + word;
  return line;
}

/// Calls a program of iproute2 in a namespace and returns what it prints. Throws std::runtime_error with that, unless
/// it succeeds.
std::string call(const NetworkNamespace& space, Words command) {
  const std::string shown = joined(command);
  command[0] = "/usr/sbin/" + command[0];
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), 0) != 0) throw std::runtime_error("no pipe");
  Descriptor out(pipe[0]), in(pipe[1]);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, in.number(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, in.number(), STDERR_FILENO);
  ::posix_spawn_file_actions_addclose(&actions, out.number());
  std::vector<char*> pointers;
  for (std::string& word : command) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  pid_t pid = -1;
  int error = 0;
  space.inside([&] { error = ::posix_spawn(&pid, pointers[0], &actions, nullptr, pointers.data(), environ); });
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error(command[0] + " cannot be started; is iproute2 installed?");
  in.close();
  std::string text;
  std::array<char, 4096> part{};
  for (ssize_t size = 0; (size = ::read(out.number(), part.data(), part.size())) > 0;)
    text.append(part.data(), static_cast<std::size_t>(size));
  int status = 0;
  ::waitpid(pid, &status, 0);
  if (status == 0) return text;
  std::ranges::replace(text, '\n', ' ');
  throw std::runtime_error(shown + ": " + text);
}

void set_up(const NetemEnd& end) {
  const std::string& name = end.interface.name;
  const auto prefix = std::to_string(end.interface.prefix);
  call(*end.space, {"ip", "addr", "add", end.interface.address + "/" + prefix, "dev", name});
  call(*end.space, {"ip", "link", "set", "dev", name, "up"});
  Words netem = {"tc", "qdisc", "add", "dev", name, "root", "netem"};
  for (std::string& word : netem_arguments(end.to_the_other)) netem.push_back(std::move(word));
  try {
    call(*end.space, netem);
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).find("qdisc kind is unknown") == std::string::npos) throw;
    throw std::runtime_error(
        "this kernel has no netem (CONFIG_NET_SCH_NETEM); without --netem Kervan emulates the link");
  }
}

}  // namespace

Words netem_arguments(const composition::LinkSettings& settings) {
  if (!settings.down.empty()) throw ConfigError({}, "netem knows no schedule; leave --down out, or --netem");
  if (settings.keep_order && settings.jitter > Duration::zero())
    throw ConfigError({}, "netem lets packets with jitter overtake each other; leave --keep-order out, or --netem");
  Words words;
  const auto add = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
  // What is on its way counts, too; without a rate there is no queue to speak of.
  double limit = 100000;
  if (settings.rate > 0.0)
    limit = std::ceil((settings.queue + seconds(settings.delay + settings.jitter) * settings.rate / 8.0) / 1514.0);
  add({"limit", std::to_string(static_cast<long long>(std::max(1.0, limit)))});
  if (settings.delay > Duration::zero()) add({"delay", time(settings.delay)});
  if (settings.jitter > Duration::zero()) add({time(settings.jitter)});
  if (settings.burst_loss > 0.0) {
    const double share = settings.burst_loss / settings.loss_in_burst, end = 1.0 / settings.burst_length;
    const double passes = (1.0 - settings.loss / 100.0) * (1.0 - settings.loss_in_burst / 100.0);
    add({"loss", "gemodel", percent(100.0 * end * share / (1.0 - share)), percent(100.0 * end),
         percent(100.0 * (1.0 - passes)), percent(settings.loss)});
  } else if (settings.loss > 0.0) {
    add({"loss", "random", percent(settings.loss)});
  }
  if (settings.corrupt > 0.0) add({"corrupt", percent(settings.corrupt)});
  if (settings.duplicate > 0.0) add({"duplicate", percent(settings.duplicate)});
  if (settings.reorder > 0.0) add({"reorder", percent(settings.reorder)});
  if (settings.rate > 0.0) add({"rate", std::to_string(static_cast<long long>(settings.rate)) + "bit"});
  return words;
}

LinkCounters netem_counters(const std::string& text) {
  const auto queues = nlohmann::json::parse(text, nullptr, false);
  if (queues.is_array())
    for (const auto& queue : queues) {
      if (queue.value("kind", "") != "netem") continue;
      LinkCounters counters;
      counters.delivered = queue.value("packets", std::uint64_t{0});
      counters.delivered_bytes = counters.bytes = queue.value("bytes", std::uint64_t{0});
      counters.lost = queue.value("drops", std::uint64_t{0});
      counters.packets = counters.delivered + counters.lost;
      return counters;
    }
  throw std::runtime_error("tc says nothing of netem: " + text);
}

NetemLink::NetemLink(NetemEnd a, NetemEnd b) : a_(std::move(a)), b_(std::move(b)) {
  const std::string there = "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(b_.space->descriptor());
  call(*a_.space,
       {"ip", "link", "add", a_.interface.name, "type", "veth", "peer", "name", b_.interface.name, "netns", there});
  try {
    set_up(a_);
    set_up(b_);
  } catch (...) {
    call(*a_.space, {"ip", "link", "del", "dev", a_.interface.name});
    throw;
  }
}

NetemLink::~NetemLink() {
  try {
    call(*a_.space, {"ip", "link", "del", "dev", a_.interface.name});
  } catch (const std::runtime_error&) {
    // Its namespace is gone, and the cable with it.
  }
}

std::vector<LinkCounters> NetemLink::counters() const {
  std::vector<LinkCounters> counters;
  for (const NetemEnd* end : {&a_, &b_})
    counters.push_back(
        netem_counters(call(*end->space, {"tc", "-s", "-j", "qdisc", "show", "dev", end->interface.name})));
  return counters;
}

}  // namespace kervan::link
