#include "deploy/composition/load.hpp"

#include <algorithm>
#include <cctype>
#include <set>

#include "deploy/composition/arguments.hpp"
#include "deploy/composition/expand.hpp"
#include "deploy/composition/hosts.hpp"
#include "deploy/composition/placement.hpp"
#include "deploy/composition/qos_rules.hpp"
#include "deploy/composition/settings.hpp"

namespace kervan::composition {
namespace {

using config::Node;
namespace fs = std::filesystem;

Clock read_clock(const Node& node) {
  node.only_keys({"mode", "step", "pace"});
  Clock clock;
  const std::string mode = node.required("mode").as_choice({"wall", "sim", "lockstep"});
  clock.location = node.required("mode").location;
  clock.mode = mode == "wall" ? ClockMode::wall : mode == "sim" ? ClockMode::sim : ClockMode::lockstep;
  if (const Node* step = node.optional("step")) {
    if (clock.mode == ClockMode::wall) step->fail_at_key("'step' has no meaning under clock wall");
    clock.step = step->as_duration();
    clock.step_location = step->location;
    if (*clock.step <= Duration::zero()) step->fail(step->shown() + " is out of range; allowed: more than 0 s");
  }
  if (clock.mode == ClockMode::lockstep) clock.pace = 0.0;
  if (const Node* pace = node.optional("pace")) {
    if (clock.mode != ClockMode::sim) pace->fail_at_key("'pace' has a meaning under clock sim only");
    const std::string text = pace->as_text();
    if (text == "real-time")
      clock.pace = 1.0;
    else if (text == "max")
      clock.pace = 0.0;
    else if (text.ends_with('x')) {
      clock.pace = config::scalar(text.substr(0, text.size() - 1), "pace", to_text(pace->location)).as_number();
      if (clock.pace <= 0.0) pace->fail(pace->shown() + " is out of range; allowed: more than 0x");
    } else {
      pace->fail(pace->shown() + " is not a pace; write real-time, max or a factor such as 4x");
    }
  }
  return clock;
}

ComponentEntry mission_component(const Node& mission, const std::string& log_level) {
  mission.map();
  ComponentEntry entry;
  entry.name = "mission";
  entry.type = config::scalar("observe/mission", "mission", mission.location.file);
  entry.type.location = entry.type.key_location = mission.key_location;
  entry.params = mission;
  entry.remap.kind = entry.strength.kind = config::Kind::map;
  entry.log_level = log_level;
  entry.location = mission.key_location;
  return entry;
}

std::vector<TopicEntry> read_topics(const Node& node) {
  std::vector<TopicEntry> topics;
  for (const Node& topic : node.map()) {
    if (!topic.name.starts_with('/'))
      topic.fail_at_key("'" + topic.name + "' is not a topic; topics are written in full here, from the leading /");
    check_topic_settings(topic);
    topics.push_back({topic.name, topic});
  }
  return topics;
}

/// The name is part of the name of every run's folder.
bool is_composition_name(const std::string& name) {
  const auto is_plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  return !name.empty() && name.size() <= 64 && is_plain(name[0]) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return is_plain(c) || c == '_' || c == '-' || c == '.'; });
}

void check_version(const Node& root) {
  const Node& version = root.required("kervan");
  if (version.as_integer() != 1)
    version.fail("version " + version.text + " of the format is not known; this program reads 1");
}

Composition load_node(const Node& root, const std::string& shown_as, const fs::path& folder,
                      const LoadOptions& options) {
  if (!root.is_map()) root.fail("a composition is a map that begins with 'kervan: 1'");
  check_version(root);
  root.only_keys({"kervan", "name", "help", "args", "clock", "domain", "links", "log", "qos", "topics", "templates",
                  "components", "containers", "mission"});
  Composition composition;
  composition.file = shown_as;
  composition.folder = folder;
  if (const Node* args = root.optional("args")) composition.arguments = declare_arguments(*args);
  give_values(composition.arguments, options.values, "the composition '" + root.required("name").as_text() + "'");
  give_from_command_line(composition.arguments, options.arguments);

  const auto filled = [&](const char* key) -> std::optional<Node> {
    const Node* node = root.optional(key);
    return node ? std::optional(substitute(*node, composition.arguments)) : std::nullopt;
  };
  const Node& name = root.required("name");
  composition.name = name.as_text();
  if (!is_composition_name(composition.name))
    name.fail(name.shown() +
              " is not a name for a composition; it also names the folder of a run, so use at most 64 letters, digits, "
              "_, - and ., beginning with a letter or digit");
  if (const auto help = filled("help")) composition.help = help->as_text();
  if (const auto clock = filled("clock")) composition.clock = read_clock(*clock);
  if (const auto domain = filled("domain")) composition.domain = read_domain(*domain);
  const auto links = filled("links");
  composition.links = links ? read_links(*links, host_names(composition.domain)) : default_links();
  const auto log = filled("log");
  const std::string log_level = log ? log_level_of(*log) : "info";
  if (const auto qos = filled("qos"))
    for (const Node& profile : qos->map()) composition.profiles.push_back({profile.name, profile});
  Profiles check_profiles(composition.profiles);
  if (const auto topics = filled("topics")) composition.topics = read_topics(*topics);

  const Node& components = root.required("components");
  if (components.map().empty()) components.fail("there must be at least one component");
  composition.components = expand_components(components, root.optional("templates"), composition.arguments, log_level);
  const auto mission = filled("mission");
  if (mission) {
    if (const ComponentEntry* same = composition.component("mission"))
      mission->fail_at_key("'mission' is a component already (" + to_text(same->location) + "); keep one of the two");
    composition.components.push_back(mission_component(*mission, log_level));
  }
  apply_settings(composition, options.settings);
  const auto containers = filled("containers");
  composition.containers =
      place_components(composition, containers ? &*containers : nullptr, mission ? "mission" : "", options.place);
  if (options.emulate_hosts) emulate_hosts(composition);
  choose_host(composition, options.host);
  return composition;
}

}  // namespace

std::string_view to_text(ClockMode mode) {
  switch (mode) {
    case ClockMode::wall: return "wall";
    case ClockMode::sim: return "sim";
    case ClockMode::lockstep: return "lockstep";
  }
  return "";
}

const ComponentEntry* Composition::component(std::string_view full_name) const {
  for (const ComponentEntry& entry : components)
    if (entry.name == full_name) return &entry;
  return nullptr;
}

Composition load(const fs::path& file, const LoadOptions& options) {
  const std::string shown = shown_path(file);
  return load_node(config::load(file.string(), shown), shown, fs::absolute(file).parent_path(), options);
}

Composition load_text(const std::string& text, const std::string& shown_as, const fs::path& folder,
                      const LoadOptions& options) {
  return load_node(config::parse(text, shown_as), shown_as, folder, options);
}

fs::path find_composition(const std::string& name_or_file, const std::vector<fs::path>& folders,
                          const std::string& what) {
  if (name_or_file.ends_with(".yaml") || name_or_file.ends_with(".yml") ||
      name_or_file.find('/') != std::string::npos) {
    if (fs::is_directory(name_or_file))
      throw ConfigError({name_or_file, 0, 0}, "this is a folder; name a file, or a shipped " + what);
    if (!fs::is_regular_file(name_or_file)) throw ConfigError({name_or_file, 0, 0}, "there is no such file");
    return name_or_file;
  }
  std::set<std::string> known;
  for (const fs::path& folder : folders) {
    const fs::path file = folder / (name_or_file + ".yaml");
    if (fs::is_regular_file(file)) return file;
    if (!fs::is_directory(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".yaml") known.insert(entry.path().stem().string());
  }
  const std::vector<std::string> names(known.begin(), known.end());
  const std::string beside = name_or_file + ".yaml";
  throw ConfigError(
      {}, "there is no " + what + " '" + name_or_file + "'" +
              (!name_or_file.empty() && fs::is_regular_file(beside) ? "; a file is named with its ending: " + beside
                                                                    : config::hint(name_or_file, names, "there are")));
}

std::string shown_path(const fs::path& path) {
  std::error_code error;
  const fs::path relative = fs::proximate(path, error);
  if (error || relative.empty() || *relative.begin() == "..") return path.lexically_normal().string();
  return relative.string();
}

}  // namespace kervan::composition
