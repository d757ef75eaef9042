#include "framework/dds/discovery.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>

#include "framework/dds/endpoint_qos.hpp"

namespace kervan::dds {

namespace {

Guid to_guid(const dds_guid_t& guid) {
  Guid value;
  std::copy(std::begin(guid.v), std::end(guid.v), value.begin());
  return value;
}

std::string user_data_of(const dds_qos_t* qos) {
  void* data = nullptr;
  std::size_t size = 0;
  std::string text;
  if (qos && dds_qget_userdata(qos, &data, &size) && data) text.assign(static_cast<const char*>(data), size);
  dds_free(data);
  return text;
}

std::string property_of(const dds_qos_t* qos, const char* name) {
  char* value = nullptr;
  std::string text;
  if (qos && dds_qget_prop(qos, name, &value) && value) text = value;
  dds_free(value);
  return text;
}

/// The value of "<key>=…;" in `text`.
std::optional<std::string_view> field(std::string_view text, std::string_view key) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(';', at), text.size());
    const std::string_view entry = text.substr(at, end - at);
    if (entry.size() > key.size() && entry.starts_with(key) && entry[key.size()] == '=')
      return entry.substr(key.size() + 1);
    at = end + 1;
  }
  return std::nullopt;
}

DiscoveredParticipant to_participant(const dds_qos_t* qos) {
  DiscoveredParticipant participant;
  participant.process = property_of(qos, "__ProcessName");
  participant.host = property_of(qos, "__Hostname");
  participant.pid = std::strtol(property_of(qos, "__Pid").c_str(), nullptr, 10);
  participant.identity = parse_participant(user_data_of(qos));
  return participant;
}

/// Calls `use(sample, info)` for everything that can be taken.
template <class Sample, class Use>
void take_all(dds_entity_t reader, Use use) {
  constexpr int kAtOnce = 16;
  for (;;) {
    void* samples[kAtOnce] = {};
    dds_sample_info_t infos[kAtOnce];
    const dds_return_t count = dds_take(reader, samples, infos, kAtOnce, kAtOnce);
    if (count <= 0) return;
    for (int i = 0; i < count; ++i) use(*static_cast<const Sample*>(samples[i]), infos[i]);
    dds_return_loan(reader, samples, count);
  }
}

}  // namespace

std::string to_user_data(const ParticipantIdentity& identity) {
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(identity.composition));
  return "enclave=/;kc=" + identity.container + ";kh=" + hash + ";";
}

std::optional<ParticipantIdentity> parse_participant(std::string_view user_data) {
  const auto container = field(user_data, "kc");
  const auto hash = field(user_data, "kh");
  if (!container || !hash) return std::nullopt;
  ParticipantIdentity identity{std::string(*container)};
  const auto [end, error] = std::from_chars(hash->data(), hash->data() + hash->size(), identity.composition, 16);
  if (error != std::errc{} || end != hash->data() + hash->size()) return std::nullopt;
  return identity;
}

Discovery::Discovery(Domain& domain, std::function<void()> wake) : wake_(std::move(wake)) {
  dds_listener_t* const listener = dds_create_listener(this);
  dds_lset_data_available(listener, [](dds_entity_t, void* self) { static_cast<Discovery*>(self)->wake_(); });
  const auto open = [&](dds_entity_t topic) {
    const dds_entity_t reader = dds_create_reader(domain.participant(), topic, nullptr, listener);
    if (reader < 0) {
      dds_delete_listener(listener);
      throw DdsError(std::string("cannot watch DDS discovery: ") + dds_strretcode(-reader));
    }
    return reader;
  };
  participant_reader_ = open(DDS_BUILTIN_TOPIC_DCPSPARTICIPANT);
  publication_reader_ = open(DDS_BUILTIN_TOPIC_DCPSPUBLICATION);
  subscription_reader_ = open(DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION);
  dds_delete_listener(listener);
}

Discovery::~Discovery() {
  for (const dds_entity_t reader : {subscription_reader_, publication_reader_, participant_reader_}) dds_delete(reader);
}

std::vector<DiscoveryEvent> Discovery::take() {
  std::vector<DiscoveryEvent> events;
  take_endpoints(publication_reader_, true, events);
  take_endpoints(subscription_reader_, false, events);
  // Afterwards: a participant is there before its endpoints are, so whoever owns one taken above is known now.
  take_participants();
  for (DiscoveryEvent& event : events) {
    if (!event.gone) {
      const auto owner = participants_.find(participant_of_[event.endpoint.handle]);
      if (owner != participants_.end()) event.endpoint.participant = owner->second;
      endpoints_[event.endpoint.handle] = event.endpoint;
    } else if (const auto known = endpoints_.extract(event.endpoint.handle)) {
      event.endpoint = std::move(known.mapped());
      participant_of_.erase(event.endpoint.handle);
    }
  }
  // One that came and went between two calls, and was never told of.
  std::erase_if(events, [](const DiscoveryEvent& event) { return event.gone && event.endpoint.topic.empty(); });
  return events;
}

void Discovery::take_participants() {
  take_all<dds_builtintopic_participant_t>(
      participant_reader_, [&](const dds_builtintopic_participant_t& sample, const dds_sample_info_t& info) {
        if (info.instance_state != DDS_ALIVE_INSTANCE_STATE)
          participants_.erase(to_guid(sample.key));
        else if (info.valid_data)
          participants_[to_guid(sample.key)] = to_participant(sample.qos);
      });
}

void Discovery::take_endpoints(std::int32_t reader, bool writers, std::vector<DiscoveryEvent>& events) {
  take_all<dds_builtintopic_endpoint_t>(reader,
                                        [&](const dds_builtintopic_endpoint_t& sample, const dds_sample_info_t& info) {
                                          DiscoveryEvent event;
                                          event.gone = info.instance_state != DDS_ALIVE_INSTANCE_STATE;
                                          event.endpoint.handle = info.instance_handle;
                                          if (!event.gone) {
                                            if (!info.valid_data) return;
                                            const std::string_view topic = sample.topic_name;
                                            event.endpoint.guid = to_guid(sample.key);
                                            event.endpoint.writer = writers;
                                            event.endpoint.topic = topic.starts_with("rt/") ? topic.substr(2) : topic;
                                            event.endpoint.wire_type = sample.type_name;
                                            event.endpoint.identity = parse_identity(user_data_of(sample.qos));
                                            event.endpoint.qos = endpoint_qos(sample.qos);
                                            participant_of_[info.instance_handle] = to_guid(sample.participant_key);
                                          }
                                          events.push_back(std::move(event));
                                        });
}

}  // namespace kervan::dds
