#include "framework/dds/domain.hpp"

#include <dds/dds.h>

#include "framework/component/error.hpp"
#include "framework/dds/sample_block.hpp"

namespace kervan::dds {

namespace {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      default: result += c;
    }
  return result;
}

/// What Cyclone has logged so far, in one line: its return codes alone do not say why a domain cannot be made.
std::string reasons(Reports& reports) {
  std::string text;
  for (const LogLine& line : reports.take_lines()) text += (text.empty() ? "" : "; ") + line.text;
  return text.empty() ? "Cyclone DDS gave no reason" : text;
}

void require_in(const char* what, std::int64_t value, std::int64_t least, std::int64_t most) {
  if (value < least || value > most)
    throw ConfigError({}, "domain." + std::string(what) + ": " + std::to_string(value) +
                              " is out of range; allowed: " + std::to_string(least) + " .. " + std::to_string(most));
}

/// What Cyclone would take for something else, or say in a way that nobody can read.
void require_usable(const DomainConfig& config) {
  // Above, there are no UDP ports any more.
  if (config.external_id)
    require_in("external_id", *config.external_id, 0, 232);
  else
    require_in("id", config.id, 0, 232);
  require_in("processes", config.processes, 1, 120);
  if (config.linger < Duration::zero()) throw ConfigError({}, "domain.linger: must not be negative");
  if (config.interface.empty() && config.address.empty())
    throw ConfigError({}, "domain: needs the name of a network interface or its address");
  for (const std::string& peer : config.peers)
    if (peer.empty()) throw ConfigError({}, "domain.peers: an address is empty");
}

}  // namespace

std::string cyclone_configuration(const DomainConfig& config) {
  std::string xml = "<General>";
  if (!config.network) return xml + "<Transport>none</Transport></General>";
  require_usable(config);
  // The loopback interface carries multicast but does not say so, and takes the largest datagrams in one piece, which
  // saves a fifth of the time a large message takes. Index and lease: Cyclone's defaults let only nine processes share
  // an interface without multicast, and take ten seconds to notice that a peer died.
  using Multicast = DomainConfig::Multicast;
  const bool loopback = config.interface == "lo";
  xml += "<Interfaces><NetworkInterface ";
  xml += config.interface.empty() ? "address=\"" + escaped(config.address) : "name=\"" + escaped(config.interface);
  xml += std::string("\"") + (loopback && config.multicast != Multicast::no ? " multicast=\"true\"" : "") +
         "/></Interfaces>";
  if (config.multicast != Multicast::yes)
    xml +=
        std::string("<AllowMulticast>") + (config.multicast == Multicast::no ? "false" : "spdp") + "</AllowMulticast>";
  xml += std::string(loopback ? "<MaxMessageSize>65000B</MaxMessageSize>" : "") + "</General><Discovery>";
  if (config.external_id) xml += "<ExternalDomainId>" + std::to_string(*config.external_id) + "</ExternalDomainId>";
  if (!config.tag.empty()) xml += "<Tag>" + escaped(config.tag) + "</Tag>";
  xml += "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>" + std::to_string(config.processes - 1) +
         "</MaxAutoParticipantIndex><LeaseDuration>2s</LeaseDuration>";
  if (!config.peers.empty()) {
    xml += "<Peers>";
    for (const std::string& peer : config.peers) xml += "<Peer address=\"" + escaped(peer) + "\"/>";
    xml += "</Peers>";
  }
  // A reader takes nothing of a reliable writer before it has asked what there is. By default it asks 10 ms after the
  // match, and asks again for what it missed after 100 ms: an eternity for the first samples of a run.
  const auto linger = std::chrono::ceil<std::chrono::milliseconds>(config.linger).count();
  return xml + "</Discovery><Internal><PreEmptiveAckDelay>0s</PreEmptiveAckDelay><NackDelay>10ms</NackDelay>" +
         "<WriterLingerDuration>" + std::to_string(linger) + "ms</WriterLingerDuration></Internal>";
}

Domain::Domain(const DomainConfig& config, const std::atomic<Time::rep>* time)
    : log_(config.id, reports_), time_(time) {
  const auto fail = [&](const char* what, int code) {
    if (domain_ > 0) dds_delete(domain_);
    throw DdsError(std::string("cannot ") + what + " (domain " + std::to_string(config.id) +
                   (!config.network            ? ", no network"
                    : config.interface.empty() ? ", address " + config.address
                                               : ", interface " + config.interface) +
                   "): " + dds_strretcode(-code) + "; " + reasons(reports_));
  };
  domain_ = dds_create_domain(config.id, cyclone_configuration(config).c_str());
  if (domain_ < 0) fail("create the DDS domain", domain_);
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_userdata(qos, config.user_data.data(), config.user_data.size());
  participant_ = dds_create_participant(config.id, qos, nullptr);
  dds_delete_qos(qos);
  if (participant_ < 0) fail("create the DDS participant", participant_);
  reports_.print_unheard();
}

Domain::~Domain() { dds_delete(domain_); }

Domain::Topic Domain::topic(const std::string& name, const TypeSupport& type) {
  const std::lock_guard lock(mutex_);
  const TypeSupport*& known = types_.try_emplace(type.name, &type).first->second;
  if (known->layout_hash != type.layout_hash)
    throw DdsError(std::string("two modules of this container were built with different layouts of ") + type.name +
                   "; rebuild them against the same IDL package");
  if (const auto found = topics_.find(name); found != topics_.end()) {
    if (found->second.type != known)
      throw DdsError("topic " + name + " carries " + found->second.type->name + ", not " + type.name);
    return found->second.topic;
  }

  SampleType* sample_type = make_sample_type(*known, reports_);
  sample_type->time = time_;
  ddsi_sertype* registered = sample_type;
  const std::string wire_name = "rt" + name;
  const dds_entity_t entity =
      dds_create_topic_sertype(participant_, wire_name.c_str(), &registered, nullptr, nullptr, nullptr);
  if (entity < 0) {
    ddsi_sertype_unref(sample_type);
    throw DdsError("cannot create topic " + name + ": " + dds_strretcode(-entity));
  }
  // Cyclone gives back the type registered first when an equal one is there already.
  const Topic topic{entity, static_cast<const SampleType*>(registered)};
  topics_.emplace(name, Known{topic, known});
  return topic;
}

}  // namespace kervan::dds
