// kervan check: everything about a composition that can be known without running it.
#include <iostream>
#include <nlohmann/json.hpp>

#include "deploy/cli/catalogue.hpp"
#include "deploy/cli/prepare.hpp"
#include "deploy/cli/print_json.hpp"
#include "deploy/cli/table.hpp"
#include "deploy/cli/verbs.hpp"

namespace kervan::cli {
namespace {

using composition::Finding;
using composition::PortReference;
using composition::ResolvedComposition;
using composition::ResolvedTopic;
using composition::Severity;
using nlohmann::ordered_json;

std::size_t count(const ResolvedComposition& composition, Severity severity) {
  return static_cast<std::size_t>(std::count_if(composition.findings.begin(), composition.findings.end(),
                                                [&](const Finding& finding) { return finding.severity == severity; }));
}

/// A topic that nobody writes or reads has a line in the matrix, but no pair.
std::size_t pairs(const ResolvedComposition& composition) {
  return static_cast<std::size_t>(std::ranges::count_if(
      composition.pairs, [](const auto& pair) { return !pair.writer.empty() && !pair.reader.empty(); }));
}

std::string counted(std::size_t number, const std::string& noun) {
  return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
}

std::vector<std::string> names(const ResolvedComposition& composition, const std::vector<PortReference>& ports) {
  std::vector<std::string> names;
  for (const PortReference port : ports) names.push_back(composition.port_name(port));
  return names;
}

ordered_json qos_json(const ResolvedTopic& topic) {
  ordered_json values = ordered_json::object();
  for (const auto& value : topic.qos.values) values[value.name] = {{"value", value.value}, {"from", value.origin}};
  return values;
}

ordered_json topic_json(const ResolvedComposition& composition, const ResolvedTopic& topic) {
  return {{"topic", topic.name},
          {"type", topic.type},
          {"profile", topic.qos.profile.name},
          {"qos", qos_json(topic)},
          {"writers", names(composition, topic.writers)},
          {"readers", names(composition, topic.readers)}};
}

ordered_json report(const ResolvedComposition& composition) {
  ordered_json object;
  object["result"] = !composition.usable() ? "errors" : composition.findings.empty() ? "good" : "warnings";
  object["composition"] = composition.source.name;
  object["file"] = composition.source.file;
  for (const char* list : {"arguments", "containers", "components", "topics", "pairs", "findings"})
    object[list] = ordered_json::array();
  for (const auto& argument : composition.source.arguments)
    object["arguments"].push_back({{"name", argument.info.name},
                                   {"kind", to_text(argument.info.kind)},
                                   {"value", argument.value->shown()},
                                   {"help", argument.info.help}});
  for (const auto& container : composition.source.containers)
    object["containers"].push_back(
        {{"name", container.name},
         {"host", container.host.empty() ? ordered_json(nullptr) : ordered_json(container.host)},
         {"components", container.components}});
  for (const auto& component : composition.components)
    object["components"].push_back(
        {{"name", component.name}, {"type", component.manifest.type}, {"container", component.container}});
  for (const auto& [name, topic] : composition.topics) object["topics"].push_back(topic_json(composition, topic));
  const auto port = [](const std::string& name) { return name.empty() ? ordered_json(nullptr) : ordered_json(name); };
  for (const auto& pair : composition.pairs)
    object["pairs"].push_back({{"topic", pair.topic},
                               {"type", pair.type},
                               {"writer", port(pair.writer)},
                               {"reader", port(pair.reader)},
                               {"profile", pair.profile},
                               {"verdict", pair.verdict}});
  for (const auto& finding : composition.findings)
    object["findings"].push_back({{"severity", finding.severity == Severity::error ? "error" : "warning"},
                                  {"file", finding.location.file},
                                  {"line", finding.location.line},
                                  {"column", finding.location.column},
                                  {"message", finding.message}});
  return object;
}

const ResolvedTopic& find_topic(const ResolvedComposition& composition, const std::string& name) {
  const auto found = composition.topics.find(name);
  if (found != composition.topics.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [topic, info] : composition.topics) known.push_back(topic);
  throw ConfigError({"--explain " + name, 0, 0},
                    composition.source.name + " has no such topic" + config::hint(name, known, "it has"));
}

void print_topic(const ResolvedComposition& composition, const ResolvedTopic& topic) {
  std::cout << topic.name << "  " << topic.type << '\n';
  print_table(std::cout,
              {{"written by", config::joined(names(composition, topic.writers))},
               {"read by", config::joined(names(composition, topic.readers))},
               {"profile", topic.qos.profile.name}},
              "  ");
  std::vector<std::vector<std::string>> rows;
  for (const auto& value : topic.qos.values) rows.push_back({value.name, value.value, value.origin});
  print_table(std::cout, rows, "    ");
}

void print_arguments(const ResolvedComposition& composition) {
  if (composition.source.arguments.empty()) return;
  std::vector<std::vector<std::string>> rows;
  for (const auto& argument : composition.source.arguments)
    rows.push_back(
        {"--arg " + argument.info.name + "=" + (argument.value->is_list() ? "[...]" : argument.value->shown()),
         argument.info.help});
  print_table(std::cout, rows);
  std::cout << '\n';
}

void print_placement(const ResolvedComposition& composition) {
  if (composition.source.containers.size() < 2) return;
  std::vector<std::vector<std::string>> rows = {{"container", "host", "components"}};
  for (const auto& container : composition.source.containers)
    rows.push_back(
        {container.name, container.host.empty() ? "-" : container.host, config::joined(container.components)});
  print_table(std::cout, rows);
  std::cout << '\n';
}

void print_matrix(const ResolvedComposition& composition) {
  if (composition.pairs.empty()) return;
  std::vector<std::vector<std::string>> rows = {{"topic", "type", "writer", "reader", "profile", "verdict"}};
  const auto port = [](const std::string& name) { return name.empty() ? std::string("-") : name; };
  for (const auto& pair : composition.pairs)
    rows.push_back({pair.topic, pair.type, port(pair.writer), port(pair.reader), pair.profile, pair.verdict});
  print_table(std::cout, rows);
}

}  // namespace

int check(const CheckRequest& request) {
  ComponentRegistry registry(component_folders());
  const ResolvedComposition composition = prepare(request, registry);
  const ResolvedTopic* topic = request.explain.empty() ? nullptr : &find_topic(composition, request.explain);
  print_findings(composition);
  if (request.json) {
    print_json(topic ? topic_json(composition, *topic) : report(composition));
  } else if (topic) {
    print_topic(composition, *topic);
  } else {
    print_arguments(composition);
    print_placement(composition);
    print_matrix(composition);
    std::cout << composition.source.name << ": " << counted(composition.components.size(), "component") << ", "
              << counted(composition.topics.size(), "topic") << ", " << counted(pairs(composition), "pair") << ", "
              << counted(count(composition, Severity::error), "error") << ", "
              << counted(count(composition, Severity::warning), "warning") << '\n';
  }
  if (!composition.usable()) return exit_unusable;
  return composition.findings.empty() ? exit_good : exit_found;
}

}  // namespace kervan::cli
