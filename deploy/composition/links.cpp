#include "deploy/composition/links.hpp"

#include <algorithm>
#include <cmath>

#include "deploy/composition/expand.hpp"
#include "framework/component/qos.hpp"
#include "framework/config/values.hpp"

namespace kervan::composition {
namespace {

using config::Node;
using namespace std::chrono_literals;

std::string figure(double value, const char* unit) { return to_text(Value(value)) + " " + unit; }

Duration time_of(const Node& span, const std::string& text) {
  Node time = span;
  time.text = text;
  const Duration value = time.as_duration();
  if (value < Duration::zero()) span.fail(span.shown() + " begins before the run");
  return value;
}

/// `10s..15s`
Outage read_outage(const Node& node) {
  const std::string text = node.as_text();
  const auto dots = text.find("..");
  if (dots == std::string::npos) node.fail(node.shown() + " is not a span of time; write e.g. 10s..15s");
  const Outage outage{time_of(node, text.substr(0, dots)), time_of(node, text.substr(dots + 2))};
  if (outage.until <= outage.from) node.fail(node.shown() + " ends before it has begun");
  return outage;
}

std::vector<std::string> names_of_settings() {
  std::vector<std::string> names;
  for (const ParameterInfo& info : schema_of<LinkSettings>()) names.push_back(info.name);
  names.push_back("down");
  return names;
}

const LinkSettings& find_profile(const Node& name, const std::vector<LinkProfile>& profiles) {
  std::vector<std::string> known;
  for (const LinkProfile& profile : profiles) {
    if (profile.name == name.as_text()) return profile.settings;
    known.push_back(profile.name);
  }
  name.fail("there is no profile '" + name.text + "'" + config::hint(name.text, known, "there are"));
}

/// The shipped ones, then those of `profiles:`, each of which may extend one before it.
std::vector<LinkProfile> read_profiles(const Node* node) {
  std::vector<LinkProfile> profiles = shipped_link_profiles();
  if (node == nullptr) return profiles;
  for (const Node& given : node->map()) {
    require_name(given, "profile");
    for (const LinkProfile& other : profiles)
      if (other.name == given.name)
        given.fail_at_key("'" + given.name + "' is a profile that ships with the program; choose another name");
    const Node* base = given.optional("extends");
    profiles.push_back(
        {given.name, read_link_settings(given, base ? find_profile(*base, profiles) : LinkSettings{}, {"extends"})});
  }
  return profiles;
}

std::string read_host(const Node& node, const std::vector<std::string>& hosts) {
  const std::string name = node.as_text();
  if (std::ranges::find(hosts, name) == hosts.end())
    node.fail("there is no host '" + name + "'" + config::hint(name, hosts, "under domain.hosts"));
  return name;
}

/// The directions that one entry of `pairs:` is about.
std::vector<std::pair<std::string, std::string>> read_ends(const Node& node, const std::vector<std::string>& hosts) {
  const Node* between = node.optional("between");
  const Node *from = node.optional("from"), *to = node.optional("to");
  if ((between != nullptr) == (from != nullptr || to != nullptr))
    node.fail("write between: [a, b] for both directions of a link, or from: a, to: b for one of them");
  const Node& first = between ? between->list_of(2, "[a, b]")[0] : node.required("from");
  const Node& second = between ? between->list_of(2, "[a, b]")[1] : node.required("to");
  const std::string a = read_host(first, hosts), b = read_host(second, hosts);
  if (a == b) second.fail("a link joins two hosts, and '" + a + "' is both of them");
  if (between) return {{a, b}, {b, a}};
  return {{a, b}};
}

}  // namespace

std::optional<std::pair<std::string, std::string>> contradiction(const LinkSettings& settings) {
  if (settings.jitter > settings.delay)
    return {{"jitter", duration_text(settings.jitter) + " is more than the delay of " + duration_text(settings.delay)}};
  // The share of time in bursts is what two probabilities of at most 1 can make of it.
  const double most = settings.loss_in_burst * settings.burst_length / (settings.burst_length + 1.0);
  if (settings.burst_loss > most)
    return {{"burst_loss", figure(settings.burst_loss, "%") + " cannot be lost in bursts of " +
                               to_text(Value(settings.burst_length)) + " packets; allowed: at most " +
                               figure(std::floor(most * 10.0) / 10.0, "%") + ", or longer bursts"}};
  if (settings.reorder > 0.0 && settings.delay == Duration::zero())
    return {{"reorder", "there is no delay that a packet could skip"}};
  if (settings.reorder > 0.0 && settings.keep_order)
    return {{"reorder", "packets cannot overtake each other where keep_order is true"}};
  return std::nullopt;
}

const std::vector<LinkProfile>& shipped_link_profiles() {
  static const std::vector<LinkProfile> profiles = [] {
    LinkSettings ethernet;
    ethernet.delay = 200us;
    ethernet.rate = 100e6;
    ethernet.queue = 256e3;
    LinkSettings wifi;
    wifi.loss = 0.5;
    wifi.burst_loss = 0.5;
    wifi.burst_length = 4.0;
    wifi.delay = 4ms;
    wifi.jitter = 3ms;
    wifi.keep_order = true;
    wifi.rate = 20e6;
    wifi.queue = 128e3;
    LinkSettings lossy;
    lossy.loss = 10.0;
    lossy.burst_loss = 10.0;
    lossy.delay = 50ms;
    lossy.jitter = 20ms;
    lossy.rate = 2e6;
    lossy.duplicate = 0.5;
    lossy.corrupt = 0.1;
    return std::vector<LinkProfile>{{"ethernet", ethernet}, {"wifi", wifi}, {"lossy", lossy}};
  }();
  return profiles;
}

const LinkSettings& link_profile(const Node& name) { return find_profile(name, shipped_link_profiles()); }

LinkSettings read_link_settings(const Node& node, LinkSettings base, const std::vector<std::string>& others) {
  std::vector<std::string> keys = others;
  for (const std::string& name : names_of_settings()) keys.push_back(name);
  node.only_keys(keys);
  Node plain = node;
  std::erase_if(plain.children, [&](const Node& child) {
    return child.name == "down" || std::ranges::find(others, child.name) != others.end();
  });
  set_parameters(base, config::to_values(plain, schema_of<LinkSettings>(), "a link"));
  if (const Node* down = node.optional("down")) {
    base.down.clear();
    for (const Node& span : down->list()) base.down.push_back(read_outage(span));
  }
  if (const auto wrong = contradiction(base)) {
    const Node* culprit = node.optional(wrong->first);
    if (culprit != nullptr) culprit->fail(wrong->second);
    node.fail(wrong->first + ": " + wrong->second);
  }
  return base;
}

const LinkSettings& Links::between(const std::string& from, const std::string& to) const {
  for (const Link& link : links)
    if (link.from == from && link.to == to) return link.settings;
  return others;
}

Links default_links() { return {1, shipped_link_profiles().front().settings, {}}; }

Links read_links(const Node& node, const std::vector<std::string>& hosts) {
  node.only_keys({"seed", "profile", "profiles", "pairs"});
  if (hosts.size() < 2) node.fail_at_key("there are no two hosts to join; name them under domain.hosts");
  Links links = default_links();
  if (const Node* seed = node.optional("seed")) {
    const std::int64_t value = seed->as_integer();
    if (value < 0) seed->fail(seed->shown() + " is out of range; allowed: at least 0");
    links.seed = static_cast<std::uint64_t>(value);
  }
  const std::vector<LinkProfile> profiles = read_profiles(node.optional("profiles"));
  if (const Node* profile = node.optional("profile")) links.others = find_profile(*profile, profiles);
  const Node* pairs = node.optional("pairs");
  if (pairs == nullptr) return links;
  for (const Node& pair : pairs->list()) {
    const auto ends = read_ends(pair, hosts);
    const Node* profile = pair.optional("profile");
    const LinkSettings settings = read_link_settings(pair, profile ? find_profile(*profile, profiles) : links.others,
                                                     {"between", "from", "to", "profile"});
    for (const auto& [from, to] : ends) {
      for (const Link& other : links.links)
        if (other.from == from && other.to == to)
          pair.fail("the link from '" + from + "' to '" + to + "' was described before (" + to_text(other.location) +
                    ")");
      links.links.push_back({from, to, settings, pair.location});
    }
  }
  return links;
}

}  // namespace kervan::composition
