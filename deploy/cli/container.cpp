// kervan container: looks at the containers of a run that is under way, and changes what they host.
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "deploy/cli/print_json.hpp"
#include "deploy/cli/table.hpp"
#include "deploy/cli/verbs.hpp"
#include "deploy/container/service_client.hpp"
#include "deploy/container/spec_json.hpp"
#include "framework/config/node.hpp"

namespace kervan::cli {
namespace {

namespace fs = std::filesystem;
using kervan_msgs::msg::ComponentState;
using kervan_msgs::msg::ContainerReply;
using kervan_msgs::msg::ContainerRequest;
using kervan_msgs::msg::ContainerVerb;
using kervan_msgs::msg::NamedText;
using nlohmann::ordered_json;

/// Where the containers are, and which there should be.
struct Whereabouts {
  dds::DomainConfig domain;
  std::vector<std::string> containers;  ///< empty: not known
  std::string run;                      ///< its folder; empty: only a domain was named
};

/// The specifications that a run's supervisor wrote for its containers.
std::vector<fs::path> specifications_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename();
    if (name.starts_with("container-") && name.ends_with(".json")) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

/// The newest run that has containers and is not over: a run that is over has a summary.
fs::path newest_run(const std::string& runs) {
  fs::path newest;
  fs::file_time_type newest_time{};
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(runs, none)) {
    const auto specifications = specifications_in(entry.path());
    if (specifications.empty() || fs::exists(entry.path() / "summary.json")) continue;
    const auto time = fs::last_write_time(specifications.front(), none);
    if (!newest.empty() && time <= newest_time) continue;
    newest = entry.path();
    newest_time = time;
  }
  if (newest.empty())
    throw ConfigError({}, "no run with a container to ask is under way in " + runs +
                              "; name one with --run FOLDER, or a domain with --domain ID (a lockstep run in one "
                              "container has no network and cannot be asked)");
  return newest;
}

Whereabouts whereabouts(const ContainerAsk& ask) {
  Whereabouts found;
  if (!ask.domain.empty()) {
    const config::Node node = config::scalar(ask.domain, "", "--domain " + ask.domain);
    const std::int64_t id = node.as_integer();
    if (id < 0 || id > 232) node.fail(node.shown() + " is out of range; allowed: 0 .. 232");
    found.domain = {.id = static_cast<std::uint32_t>(id), .interface = ask.interface, .tag = ask.tag};
    return found;
  }
  const fs::path folder = ask.run.empty() ? newest_run(ask.runs_folder) : fs::path(ask.run);
  const auto specifications = specifications_in(folder);
  if (specifications.empty())
    throw ConfigError({"--run " + ask.run, 0, 0},
                      "there is no specification of a container in it; name the folder of a run, such as runs/lab-…");
  const runtime::ContainerSpec spec = container::read_spec(specifications.front());
  found.domain = spec.domain;
  found.containers = spec.members;
  if (found.containers.empty()) found.containers.push_back(spec.name);
  found.run = folder.string();
  return found;
}

std::vector<NamedText> named_texts(const std::vector<std::string>& given, const char* what, const char* example) {
  std::vector<NamedText> texts;
  for (const std::string& one : given) {
    const std::size_t equals = one.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw ConfigError({}, "'" + one + "' is no " + what + "; write e.g. " + example);
    texts.push_back({.name = one.substr(0, equals), .text = one.substr(equals + 1)});
  }
  return texts;
}

ContainerRequest request_of(const ContainerAsk& ask) {
  static const std::map<std::string, ContainerVerb> verbs = {
      {"state", ContainerVerb::CONTAINER_STATE},       {"load", ContainerVerb::CONTAINER_LOAD},
      {"unload", ContainerVerb::CONTAINER_UNLOAD},     {"activate", ContainerVerb::CONTAINER_ACTIVATE},
      {"set", ContainerVerb::CONTAINER_SET},           {"deactivate", ContainerVerb::CONTAINER_DEACTIVATE},
      {"snapshot", ContainerVerb::CONTAINER_SNAPSHOT}, {"call", ContainerVerb::CONTAINER_CALL},
  };
  ContainerRequest request;
  request.verb = verbs.at(ask.verb);
  request.component = ask.component;
  request.type = ask.type;
  request.request = ask.request;
  request.log_level = ask.log_level;
  request.parameters = ask.verb == "call" ? named_texts(ask.parameters, "value of an argument", "robot=r1")
                                          : named_texts(ask.parameters, "value of a parameter", "speed=\"0.4 m/s\"");
  request.ports = named_texts(ask.ports, "topic of a port", "odom=/r1/odom");
  return request;
}

const char* to_text(ComponentState state) {
  switch (state) {
    case ComponentState::COMPONENT_CONFIGURED: return "configured";
    case ComponentState::COMPONENT_ACTIVE: return "active";
    case ComponentState::COMPONENT_DEGRADED: return "degraded";
    case ComponentState::COMPONENT_FAILED: return "failed";
    case ComponentState::COMPONENT_STOPPED: return "stopped";
  }
  return "";
}

void print_components(const ContainerReply& reply) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& component : reply.components)
    rows.push_back(
        {component.name, component.type, to_text(component.state),
         component.reason +
             (component.loaded ? (component.reason.empty() ? "" : "; ") + std::string("loaded on request") : "")});
  print_table(std::cout, rows);
}

/// As `params:` of a composition would hold them.
void print_parameters(const ContainerReply& reply) {
  std::string component;
  for (const auto& parameter : reply.parameters) {
    if (parameter.component != component) std::cout << parameter.component << ":\n";
    component = parameter.component;
    std::cout << "  " << parameter.name << ": " << parameter.value
              << (parameter.live ? (parameter.given ? "  # live" : "  # live, default")
                                 : (parameter.given ? "" : "  # default"))
              << '\n';
  }
}

ordered_json to_json(const ContainerReply& reply) {
  ordered_json object = {{"result", reply.accepted ? "accepted" : "refused"},
                         {"container", reply.container},
                         {"reason", reply.reason},
                         {"components", ordered_json::array()},
                         {"parameters", ordered_json::array()}};
  for (const auto& component : reply.components)
    object["components"].push_back({{"name", component.name},
                                    {"type", component.type},
                                    {"state", to_text(component.state)},
                                    {"reason", component.reason},
                                    {"loaded", component.loaded}});
  for (const auto& parameter : reply.parameters)
    object["parameters"].push_back({{"component", parameter.component},
                                    {"name", parameter.name},
                                    {"value", parameter.value},
                                    {"live", parameter.live},
                                    {"given", parameter.given}});
  return object;
}

Duration timeout_of(const ContainerAsk& ask) {
  const Duration timeout = config::scalar(ask.timeout, "", "--timeout " + ask.timeout).as_duration();
  if (timeout <= Duration::zero())
    throw ConfigError({"--timeout " + ask.timeout, 0, 0}, "the time must be longer than 0 s");
  return timeout;
}

int print_answer(const ContainerAsk& ask, const ContainerReply& reply) {
  if (ask.json) {
    print_json(to_json(reply));
    return reply.accepted ? exit_good : exit_found;
  }
  if (!reply.accepted) {
    std::cerr << "refused by container '" << reply.container << "': " << reply.reason << '\n';
    return exit_found;
  }
  if (!reply.reason.empty()) std::cout << reply.reason << '\n';
  if (!reply.parameters.empty())
    print_parameters(reply);
  else
    print_components(reply);
  return exit_good;
}

int list(const ContainerAsk& ask, const Whereabouts& where, dds::Domain& domain, Duration timeout) {
  const std::vector<std::string> names =
      where.containers.empty() ? container::containers_heard(domain, timeout) : where.containers;
  std::vector<std::vector<std::string>> rows = {{"container", "components", ""}};
  ordered_json object = {{"run", where.run}, {"containers", ordered_json::array()}};
  for (const std::string& name : names) {
    container::ServiceClient client(domain, name);
    ContainerRequest request;
    request.verb = ContainerVerb::CONTAINER_STATE;
    const auto reply = client.ask(request, timeout);
    if (reply)
      object["containers"].push_back(to_json(*reply));
    else
      object["containers"].push_back({{"result", "no answer"}, {"container", name}});
    rows.push_back({name, reply ? std::to_string(reply->components.size()) : "", reply ? "" : "does not answer"});
  }
  if (ask.json)
    print_json(object);
  else
    print_table(std::cout, rows);
  return names.empty() ? exit_found : exit_good;
}

}  // namespace

int container(const ContainerAsk& ask) {
  const Duration timeout = timeout_of(ask);
  const Whereabouts where = whereabouts(ask);
  if (ask.verb != "list" && !where.containers.empty() &&
      std::ranges::find(where.containers, ask.container) == where.containers.end())
    throw ConfigError({}, "there is no container '" + ask.container + "' in " + where.run +
                              config::hint(ask.container, where.containers, "there are"));
  const ContainerRequest request = ask.verb == "list" ? ContainerRequest{} : request_of(ask);
  dds::Domain domain(where.domain);
  if (ask.verb == "list") return list(ask, where, domain, timeout);
  container::ServiceClient client(domain, ask.container);
  if (const auto reply = client.ask(request, timeout)) return print_answer(ask, *reply);
  const auto there =
      where.containers.empty() ? container::containers_heard(domain, std::chrono::seconds(1)) : where.containers;
  const std::string reason = "container '" + ask.container + "' did not answer within " + ask.timeout +
                             "; there are: " + config::joined(there);
  std::cerr << reason << '\n';
  if (ask.json) print_json({{"result", "no answer"}, {"container", ask.container}, {"reason", reason}});
  return exit_found;
}

}  // namespace kervan::cli
