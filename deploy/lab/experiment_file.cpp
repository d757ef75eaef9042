#include "deploy/lab/experiment_file.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <set>

#include "deploy/composition/load.hpp"

namespace kervan::lab {
namespace {

using config::Node;
namespace fs = std::filesystem;

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& one : all) names.push_back(one.name);
  return names;
}

/// A name of the experiment's: it becomes a column of a table and part of a file's name.
void require_name(const Node& node, const std::string& name, const char* what) {
  const bool good = !name.empty() && name.size() <= 64 && std::isalnum(static_cast<unsigned char>(name[0])) != 0 &&
                    std::ranges::all_of(name, [](char c) {
                      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
                    });
  if (!good)
    throw ConfigError(&node.name == &name ? node.key_location : node.location,
                      "'" + name + "' is not a name for " + what +
                          "; use at most 64 letters, digits, _, - and ., beginning with a letter or digit");
}

Duration positive_duration(const Node& node) {
  const Duration duration = node.as_duration();
  if (duration <= Duration::zero()) node.fail(node.shown() + " is out of range; allowed: more than 0 s");
  return duration;
}

Settings read_settings(const Node& node) {
  Settings settings;
  for (const Node& setting : node.map()) settings.push_back(setting);
  return settings;
}

/// `1..20`; nothing if the text is no range.
std::optional<std::pair<std::int64_t, std::int64_t>> range_of(const std::string& text) {
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos) return std::nullopt;
  std::int64_t first = 0, last = 0;
  const char* const begin = text.data();
  const char* const end = begin + text.size();
  const auto a = std::from_chars(begin, begin + dots, first);
  const auto b = std::from_chars(begin + dots + 2, end, last);
  if (a.ec != std::errc() || a.ptr != begin + dots || b.ec != std::errc() || b.ptr != end) return std::nullopt;
  return std::pair(first, last);
}

/// The factor's name is the key of each of its values.
Level level_of(Node value, const Factor& factor) {
  value.name = factor.name;
  value.key_location = factor.location;
  std::string label = flow_text(value);
  return {std::move(label), {std::move(value)}};
}

void read_range(const Node& node, Factor& factor) {
  const auto range = node.is_scalar() && !node.quoted ? range_of(node.text) : std::nullopt;
  if (!range)
    node.fail("expected a list of values, a range such as 1..20, or a map of named levels, found " + node.shown());
  const auto [first, last] = *range;
  if (first > last) node.fail("the range " + node.text + " is empty");
  if (static_cast<std::uint64_t>(last) - static_cast<std::uint64_t>(first) >= most_runs)
    node.fail("the range " + node.text + " is too long; allowed: at most " + std::to_string(most_runs) + " values");
  for (std::int64_t value = first; value <= last; ++value) {
    Node item = node;
    item.text = std::to_string(value);
    factor.levels.push_back(level_of(std::move(item), factor));
  }
}

Factor read_factor(const Node& node) {
  Factor factor{node.name, {}, node.key_location};
  if (node.is_list())
    for (const Node& item : node.children) factor.levels.push_back(level_of(item, factor));
  else if (node.is_map())
    for (const Node& level : node.children) factor.levels.push_back({level.name, read_settings(level)});
  else
    read_range(node, factor);
  if (factor.levels.empty()) node.fail("there must be at least one value");
  std::set<std::string> labels;
  for (const Level& level : factor.levels)
    if (!labels.insert(level.label).second)
      node.fail("the value " + level.label + " is there twice; keep one of the two");
  return factor;
}

/// A parameter or argument that two factors give would depend on their order.
void check_settings_differ(const std::vector<Factor>& factors) {
  std::map<std::string, std::string> given;  // by which factor
  for (const Factor& factor : factors) {
    std::set<std::string> own;
    for (const Level& level : factor.levels)
      for (const Node& setting : level.settings) {
        own.insert(setting.name);
        const auto other = given.find(setting.name);
        if (other != given.end())
          setting.fail_at_key("'" + setting.name + "' is given by the factor '" + other->second + "' already");
      }
    for (const std::string& name : own) given[name] = factor.name;
  }
}

void check_count(const Node& matrix, const std::vector<Factor>& factors) {
  std::size_t count = 1;
  for (const Factor& factor : factors) {
    count *= factor.levels.size();
    if (count > most_runs)
      matrix.fail_at_key("the matrix makes too many runs; allowed: at most " + std::to_string(most_runs));
  }
}

Response read_response(const Node& node) {
  require_name(node, node.name, "a response");
  Response response;
  response.name = node.name;
  if (node.is_scalar()) {
    response.figure = node.as_text();
    response.location = node.location;
    return response;
  }
  node.only_keys({"figure", "unit", "is", "optional"});
  const Node& figure = node.required("figure");
  response.figure = figure.as_text();
  response.location = figure.location;
  if (const Node* unit = node.optional("unit")) response.unit = unit->as_text();
  if (const Node* is = node.optional("is")) {
    response.is = is->as_text();
    if (!response.unit.empty()) node.required("unit").fail_at_key("what is either so or not has no unit");
  }
  if (const Node* optional = node.optional("optional")) response.optional = optional->as_bool();
  return response;
}

/// Names out of `known`; `what` they are in messages.
std::vector<std::string> read_names(const Node& node, const std::vector<std::string>& known, const char* what) {
  std::vector<std::string> names;
  for (const Node& item : node.list()) {
    const std::string name = item.as_text();
    if (std::ranges::find(known, name) == known.end())
      item.fail("there is no " + std::string(what) + " '" + name + "'" + config::hint(name, known, "there are"));
    if (std::ranges::find(names, name) != names.end()) item.fail("'" + name + "' is there twice; keep one of the two");
    names.push_back(name);
  }
  return names;
}

std::string read_name(const Node& node, const std::vector<std::string>& known, const char* what) {
  const std::string name = node.as_text();
  if (std::ranges::find(known, name) == known.end())
    node.fail("there is no " + std::string(what) + " '" + name + "'" + config::hint(name, known, "there are"));
  return name;
}

Table read_table(const Node* node, const Experiment& experiment) {
  Table table;
  const std::vector<std::string> factors = names_of(experiment.factors);
  table.responses = names_of(experiment.responses);
  if (node == nullptr) {
    std::ranges::copy_if(factors, std::back_inserter(table.rows), [](const auto& name) { return name != "seed"; });
    return table;
  }
  node->only_keys({"rows", "columns", "responses"});
  table.rows = read_names(node->required("rows"), factors, "factor");
  if (const Node* columns = node->optional("columns")) {
    table.columns = read_names(*columns, factors, "factor");
    for (const Node& column : columns->children)
      if (std::ranges::find(table.rows, column.text) != table.rows.end())
        column.fail("'" + column.text + "' makes the rows already");
  }
  if (const Node* responses = node->optional("responses"))
    table.responses = read_names(*responses, table.responses, "response");
  return table;
}

Comparison read_comparison(const Node& node, const Experiment& experiment) {
  node.only_keys({"factor", "to", "responses"});
  Comparison comparison;
  comparison.factor = read_name(node.required("factor"), names_of(experiment.factors), "factor");
  std::vector<std::string> labels;
  for (const Level& level : experiment.factor(comparison.factor).levels) labels.push_back(level.label);
  const Node& to = node.required("to");
  comparison.to = flow_text(to);
  if (std::ranges::find(labels, comparison.to) == labels.end())
    to.fail("'" + comparison.factor + "' has no value " + comparison.to +
            config::hint(comparison.to, labels, "it has"));
  if (labels.size() < 2) node.required("factor").fail("'" + comparison.factor + "' has one value only");
  comparison.responses = names_of(experiment.responses);
  if (const Node* responses = node.optional("responses"))
    comparison.responses = read_names(*responses, comparison.responses, "response");
  return comparison;
}

Overlay read_overlay(const Node& node, const Experiment& experiment) {
  node.only_keys({"by", "colour"});
  Overlay overlay;
  overlay.location = node.key_location;
  const std::vector<std::string> factors = names_of(experiment.factors);
  overlay.by = read_names(node.required("by"), factors, "factor");
  if (const Node* colour = node.optional("colour")) {
    overlay.colour = read_name(*colour, factors, "factor");
    if (std::ranges::find(overlay.by, overlay.colour) != overlay.by.end())
      colour->fail("'" + overlay.colour + "' is one of 'by', so each picture would have one colour");
  }
  return overlay;
}

Experiment read(const Node& root, const std::string& shown_as, const fs::path& folder) {
  if (!root.is_map()) root.fail("a sweep is a map that begins with 'kervan_sweep: 1'");
  const Node& version = root.required("kervan_sweep");
  if (version.as_integer() != 1)
    version.fail("version " + version.text + " of the format is not known; this program reads 1");
  root.only_keys({"kervan_sweep", "name", "help", "composition", "for", "wall_limit", "set", "matrix", "responses",
                  "table", "compare", "overlay"});
  Experiment experiment;
  experiment.file = shown_as;
  experiment.folder = folder;
  experiment.name = root.required("name").as_text();
  require_name(root.required("name"), experiment.name, "a sweep");
  if (const Node* help = root.optional("help")) experiment.help = help->as_text();
  experiment.composition = root.required("composition");
  experiment.composition.as_text();
  if (const Node* run_for = root.optional("for")) experiment.run_for = positive_duration(*run_for);
  if (const Node* limit = root.optional("wall_limit"))
    experiment.wall_limit = std::chrono::duration<double>(seconds(positive_duration(*limit)));
  if (const Node* set = root.optional("set")) experiment.settings = read_settings(*set);
  const Node& matrix = root.required("matrix");
  for (const Node& factor : matrix.map()) experiment.factors.push_back(read_factor(factor));
  if (experiment.factors.empty()) matrix.fail("there must be at least one factor");
  check_settings_differ(experiment.factors);
  check_count(matrix, experiment.factors);
  const Node& responses = root.required("responses");
  for (const Node& response : responses.map()) experiment.responses.push_back(read_response(response));
  if (experiment.responses.empty()) responses.fail("there must be at least one response");
  experiment.table = read_table(root.optional("table"), experiment);
  if (const Node* compare = root.optional("compare")) experiment.comparison = read_comparison(*compare, experiment);
  if (const Node* overlay = root.optional("overlay")) experiment.overlay = read_overlay(*overlay, experiment);
  return experiment;
}

bool needs_quotes(const Node& scalar) {
  return scalar.quoted || scalar.text.empty() || scalar.text.find_first_of(",[]{}#\"'\\:\n") != std::string::npos;
}

std::string quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (c == '\n')
      quoted += "\\n";
    else
      quoted += c;
  }
  return quoted + '"';
}

std::string nested_text(const Node& value) {
  if (value.is_scalar()) return needs_quotes(value) ? quoted(value.text) : value.text;
  std::string text;
  for (const Node& child : value.children)
    text += (text.empty() ? "" : ", ") + (value.is_map() ? child.name + ": " : "") + nested_text(child);
  return value.is_map() ? "{" + text + "}" : "[" + text + "]";
}

}  // namespace

std::string flow_text(const Node& value) { return value.is_scalar() ? value.text : nested_text(value); }

Experiment load_experiment(const fs::path& file) {
  const std::string shown = composition::shown_path(file);
  return read(config::load(file.string(), shown), shown, fs::absolute(file).parent_path());
}

Experiment parse_experiment(const std::string& text, const std::string& shown_as, const fs::path& folder) {
  return read(config::parse(text, shown_as), shown_as, folder);
}

}  // namespace kervan::lab
