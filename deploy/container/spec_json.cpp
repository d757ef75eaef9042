#include "deploy/container/spec_json.hpp"

#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

#include "deploy/container/json_reader.hpp"

namespace kervan::container {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;
using namespace runtime;

// The functions that write take a structure apart by structured bindings: a member that somebody adds to it and not to
// this file is a compiler's error.

/// An object with this key alone is a number that JSON cannot hold. A parameter's own keys get one '$' more.
constexpr const char* kNumberKey = "$number";

ordered_json value_json(const Value& value) {
  using Variant = std::variant<std::monostate, bool, std::int64_t, double, std::string, ValueList, ValueMap>;
  return std::visit(
      [](const auto& held) -> ordered_json {
        using Held = std::decay_t<decltype(held)>;
        if constexpr (std::is_same_v<Held, std::monostate>) {
          return nullptr;
        } else if constexpr (std::is_same_v<Held, double>) {
          if (std::isfinite(held)) return held;
          return {{kNumberKey, std::isnan(held) ? "nan" : held > 0 ? "inf" : "-inf"}};
        } else if constexpr (std::is_same_v<Held, ValueList>) {
          ordered_json list = ordered_json::array();
          for (const Value& item : held) list.push_back(value_json(item));
          return list;
        } else if constexpr (std::is_same_v<Held, ValueMap>) {
          ordered_json map = ordered_json::object();
          for (const auto& [key, item] : held) map[(key.starts_with('$') ? "$" : "") + key] = value_json(item);
          return map;
        } else {
          return held;
        }
      },
      static_cast<const Variant&>(value));
}

Value value_of(const JsonReader& reader) {
  const json& raw = reader.raw();
  if (raw.is_null()) return {};
  if (raw.is_boolean()) return raw.get<bool>();
  if (raw.is_number_integer()) return reader.integer<std::int64_t>();
  if (raw.is_number()) return raw.get<double>();
  if (raw.is_string()) return raw.get<std::string>();
  if (raw.is_array()) {
    ValueList list;
    reader.each([&](const JsonReader& item) { list.push_back(value_of(item)); });
    return list;
  }
  if (reader.has(kNumberKey)) {
    const std::string number = reader.at(kNumberKey).text();
    if (number == "nan") return std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    if (number == "inf") return infinity;
    if (number == "-inf") return -infinity;
    reader.at(kNumberKey).fail("must be nan, inf or -inf");
  }
  ValueMap map;
  for (const auto& item : raw.items())
    map[item.key().starts_with('$') ? item.key().substr(1) : item.key()] = value_of(reader.at(item.key().c_str()));
  return map;
}

std::string_view to_text(PortDirection direction) { return direction == PortDirection::input ? "input" : "output"; }
std::string_view to_text(ClockMode mode) {
  return mode == ClockMode::wall ? "wall" : mode == ClockMode::sim ? "sim" : "lockstep";
}

std::string_view to_text(dds::DomainConfig::Multicast multicast) {
  using Multicast = dds::DomainConfig::Multicast;
  return multicast == Multicast::yes ? "yes" : multicast == Multicast::no ? "no" : "discovery_only";
}

/// The enumerator that to_text() calls by this name.
template <class Enum>
Enum choice(const JsonReader& reader, std::initializer_list<Enum> all) {
  const std::string text = reader.text();
  std::string allowed;
  for (const Enum value : all) {
    if (to_text(value) == text) return value;
    allowed += (allowed.empty() ? "" : ", ") + std::string(to_text(value));
  }
  reader.fail("'" + text + "' is not one of " + allowed);
}

ordered_json profile_json(const QosProfile& profile) {
  const auto& [name, reliability, durability, depth, limit, deadline, lifespan, liveliness, lease, ownership, partition,
               network, trace] = profile;
  return {{"name", name},
          {"reliability", kervan::to_text(reliability)},
          {"durability", kervan::to_text(durability)},
          {"depth", depth},
          {"limit", limit},
          {"deadline_ns", deadline.count()},
          {"lifespan_ns", lifespan.count()},
          {"liveliness", kervan::to_text(liveliness)},
          {"lease_ns", lease.count()},
          {"ownership", kervan::to_text(ownership)},
          {"partition", partition},
          {"network", kervan::to_text(network)},
          {"trace", trace}};
}

QosProfile profile_of(const JsonReader& reader) {
  reader.only_keys({"name", "reliability", "durability", "depth", "limit", "deadline_ns", "lifespan_ns", "liveliness",
                    "lease_ns", "ownership", "partition", "network", "trace"});
  QosProfile profile;
  profile.name = reader.at("name").text();
  profile.reliability = choice(reader.at("reliability"), {Reliability::best_effort, Reliability::reliable});
  profile.durability = choice(reader.at("durability"), {Durability::volatile_, Durability::transient_local});
  profile.depth = reader.at("depth").integer<int>();
  profile.limit = reader.at("limit").integer<int>();
  profile.deadline = Duration(reader.at("deadline_ns").integer<std::int64_t>());
  profile.lifespan = Duration(reader.at("lifespan_ns").integer<std::int64_t>());
  profile.liveliness = choice(reader.at("liveliness"), {Liveliness::automatic, Liveliness::manual});
  profile.lease = Duration(reader.at("lease_ns").integer<std::int64_t>());
  profile.ownership = choice(reader.at("ownership"), {Ownership::shared, Ownership::exclusive});
  reader.at("partition").each([&](const JsonReader& name) { profile.partition.push_back(name.text()); });
  profile.network = choice(reader.at("network"), {Network::sync, Network::async});
  profile.trace = reader.at("trace").boolean();
  return profile;
}

ordered_json port_json(const PortBinding& binding) {
  const auto& [port, topic, profile, direction, type, layout_hash, optional, strength] = binding;
  return {{"port", port},
          {"topic", topic},
          {"direction", to_text(direction)},
          {"type", type},
          {"layout_hash", hash_text(layout_hash)},
          {"optional", optional},
          {"strength", strength ? ordered_json(*strength) : nullptr},
          {"profile", profile_json(profile)}};
}

PortBinding port_of(const JsonReader& reader) {
  reader.only_keys({"port", "topic", "direction", "type", "layout_hash", "optional", "strength", "profile"});
  PortBinding binding;
  binding.port = reader.at("port").text();
  binding.topic = reader.at("topic").text();
  binding.direction = choice(reader.at("direction"), {PortDirection::input, PortDirection::output});
  binding.type = reader.at("type").text();
  binding.layout_hash = reader.at("layout_hash").hash();
  binding.optional = reader.at("optional").boolean();
  if (const JsonReader strength = reader.at("strength"); !strength.raw().is_null())
    binding.strength = strength.integer<int>();
  binding.profile = profile_of(reader.at("profile"));
  return binding;
}

ordered_json component_json(const ComponentSpec& component) {
  const auto& [name, type, container, parameters, ports, log_level] = component;
  ordered_json object = {{"name", name},
                         {"type", type},
                         {"container", container},
                         {"log_level", log_level},
                         {"parameters", value_json(parameters)},
                         {"ports", ordered_json::array()}};
  for (const PortBinding& port : ports) object["ports"].push_back(port_json(port));
  return object;
}

ComponentSpec component_of(const JsonReader& reader) {
  reader.only_keys({"name", "type", "container", "log_level", "parameters", "ports"});
  ComponentSpec component;
  component.name = reader.at("name").text();
  component.type = reader.at("type").text();
  component.container = reader.at("container").text();
  component.log_level = reader.at("log_level").text();
  Value parameters = value_of(reader.at("parameters"));
  if (!std::holds_alternative<ValueMap>(parameters)) reader.at("parameters").fail("must be an object");
  component.parameters = std::get<ValueMap>(std::move(parameters));
  reader.at("ports").each([&](const JsonReader& port) { component.ports.push_back(port_of(port)); });
  return component;
}

ordered_json domain_json(const dds::DomainConfig& domain) {
  const auto& [id, network, interface, address, tag, peers, multicast, processes, external_id, linger, user_data] =
      domain;
  return {{"id", id},
          {"network", network},
          {"interface", interface},
          {"address", address},
          {"tag", tag},
          {"peers", peers},
          {"multicast", to_text(multicast)},
          {"processes", processes},
          {"external_id", external_id ? ordered_json(*external_id) : nullptr},
          {"linger_ns", linger.count()},
          {"user_data", user_data}};
}

dds::DomainConfig domain_of(const JsonReader& reader) {
  reader.only_keys({"id", "network", "interface", "address", "tag", "peers", "multicast", "processes", "external_id",
                    "linger_ns", "user_data"});
  dds::DomainConfig domain;
  domain.id = reader.at("id").integer<std::uint32_t>();
  domain.network = reader.at("network").boolean();
  domain.interface = reader.at("interface").text();
  domain.address = reader.at("address").text();
  domain.tag = reader.at("tag").text();
  reader.at("peers").each([&](const JsonReader& peer) { domain.peers.push_back(peer.text()); });
  using Multicast = dds::DomainConfig::Multicast;
  domain.multicast = choice(reader.at("multicast"), {Multicast::yes, Multicast::discovery_only, Multicast::no});
  domain.processes = reader.at("processes").integer<int>();
  if (const JsonReader external = reader.at("external_id"); !external.raw().is_null())
    domain.external_id = external.integer<std::uint32_t>();
  domain.linger = Duration(reader.at("linger_ns").integer<std::int64_t>());
  domain.user_data = reader.at("user_data").text();
  return domain;
}

std::string read_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw ConfigError({file.string(), 0, 0}, "cannot be read");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace

std::string to_json(const ContainerSpec& spec) {
  const auto& [name, members, clock, pace, threads, domain, components, loaded, absent, inactive, run_folder,
               log_to_console, publish_log] = spec;
  ordered_json object = {{"name", name},
                         {"members", members},
                         {"clock", to_text(clock)},
                         {"pace", pace},
                         {"threads", threads},
                         {"domain", domain_json(domain)},
                         {"run_folder", run_folder.string()},
                         {"log_to_console", log_to_console},
                         {"publish_log", publish_log},
                         {"components", ordered_json::array()},
                         {"loaded", ordered_json::array()},
                         {"absent", absent},
                         {"inactive", inactive}};
  for (const ComponentSpec& component : components) object["components"].push_back(component_json(component));
  for (const ComponentSpec& component : loaded) object["loaded"].push_back(component_json(component));
  try {
    return object.dump(1) + "\n";
  } catch (const json::type_error&) {
    throw std::runtime_error("a text of the container " + name + " is no UTF-8");
  }
}

ContainerSpec spec_from_json(const std::string& text, const std::string& shown_as) {
  const json object = parse_json(text, shown_as);
  const JsonReader reader(object, shown_as);
  reader.only_keys({"name", "members", "clock", "pace", "threads", "domain", "run_folder", "log_to_console",
                    "publish_log", "components", "loaded", "absent", "inactive"});
  ContainerSpec spec;
  spec.name = reader.at("name").text();
  reader.at("members").each([&](const JsonReader& member) { spec.members.push_back(member.text()); });
  spec.clock = choice(reader.at("clock"), {ClockMode::wall, ClockMode::sim, ClockMode::lockstep});
  spec.pace = reader.at("pace").number();
  spec.threads = reader.at("threads").integer<unsigned>();
  spec.domain = domain_of(reader.at("domain"));
  spec.run_folder = reader.at("run_folder").text();
  spec.log_to_console = reader.at("log_to_console").boolean();
  spec.publish_log = reader.at("publish_log").boolean();
  reader.at("components").each([&](const JsonReader& one) { spec.components.push_back(component_of(one)); });
  reader.at("loaded").each([&](const JsonReader& one) { spec.loaded.push_back(component_of(one)); });
  reader.at("absent").each([&](const JsonReader& one) { spec.absent.push_back(one.text()); });
  reader.at("inactive").each([&](const JsonReader& one) { spec.inactive.push_back(one.text()); });
  return spec;
}

void write_spec(const ContainerSpec& spec, const std::filesystem::path& file) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << to_json(spec);
  if (!stream.flush()) throw ConfigError({file.string(), 0, 0}, "cannot be written");
}

ContainerSpec read_spec(const std::filesystem::path& file) { return spec_from_json(read_file(file), file.string()); }

}  // namespace kervan::container
