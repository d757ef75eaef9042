#include "tests/bench/split_reference.hpp"

#include <dds/dds.h>

#include <cstdio>
#include <cstdlib>
#include <thread>

#include "bench_msgs/msg/Payload.h"
#include "framework/dds/domain.hpp"
#include "tests/bench/statistics.hpp"

namespace kervan::bench {

namespace {

constexpr std::uint32_t domain_id = 224;
constexpr std::int64_t period_ns = 1'000'000;

dds_entity_t checked(dds_entity_t entity) {
  if (entity >= 0) return entity;
  std::fprintf(stderr, "reference: %s\n", dds_strretcode(-entity));
  std::exit(1);
}

/// With the configuration that Kervan gives Cyclone, so that only what is built on it differs.
struct Participant {
  explicit Participant(const std::string& tag)
      : domain(checked(dds_create_domain(
            domain_id,
            dds::cyclone_configuration({.id = domain_id, .network = true, .interface = "lo", .tag = tag}).c_str()))),
        participant(checked(dds_create_participant(domain_id, nullptr, nullptr))),
        qos(dds_create_qos()) {
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
  }
  dds_entity_t topic(int place) const {
    const std::string name = "chain" + std::to_string(place);
    return checked(dds_create_topic(participant, &bench_msgs_msg_Payload_desc, name.c_str(), nullptr, nullptr));
  }
  dds_entity_t writer(int place) const { return checked(dds_create_writer(participant, topic(place), qos, nullptr)); }
  dds_entity_t reader(int place) const { return checked(dds_create_reader(participant, topic(place), qos, nullptr)); }

  dds_entity_t domain;
  dds_entity_t participant;
  dds_qos_t* qos;
};

struct Waitset {
  Waitset(const Participant& dds, dds_entity_t reader) : entity(checked(dds_create_waitset(dds.participant))) {
    dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS);
    checked(dds_waitset_attach(entity, reader, 0));
  }
  void wait() const {
    dds_attach_t triggered[1];
    dds_waitset_wait(entity, triggered, 1, DDS_INFINITY);
  }
  dds_entity_t entity;
};

void wait_for_reader(dds_entity_t writer) {
  dds_publication_matched_status_t status{};
  while (dds_get_publication_matched_status(writer, &status) == DDS_RETCODE_OK && status.current_count == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void wait_for_writer(dds_entity_t reader) {
  dds_subscription_matched_status_t status{};
  while (dds_get_subscription_matched_status(reader, &status) == DDS_RETCODE_OK && status.current_count == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

bool take(dds_entity_t reader, bench_msgs_msg_Payload& sample) {
  void* samples[1] = {&sample};
  dds_sample_info_t info[1];
  return dds_take(reader, samples, info, 1, 1) > 0;
}

[[noreturn]] void write_for_ever(dds_entity_t writer) {
  unsigned char data[64] = {};
  bench_msgs_msg_Payload message{};
  message.data._buffer = data;
  message.data._length = message.data._maximum = sizeof data;
  for (std::int64_t next = now_ns();; next += period_ns) {
    std::this_thread::sleep_for(std::chrono::nanoseconds(next - now_ns()));
    ++message.number;
    message.stamp = now_ns();
    dds_write(writer, &message);
  }
}

}  // namespace

void raw_c_link(const std::string& tag, int place, bool last) {
  const Participant dds(tag);
  const dds_entity_t writer = dds.writer(place);
  const dds_entity_t reader = place > 0 ? dds.reader(place - 1) : 0;
  if (!last) wait_for_reader(writer);
  if (reader > 0) wait_for_writer(reader);
  std::puts("matched");
  std::fflush(stdout);
  if (reader == 0) write_for_ever(writer);
  const Waitset waitset(dds, reader);
  for (bench_msgs_msg_Payload sample{};;) {
    waitset.wait();
    while (take(reader, sample)) dds_write(writer, &sample);
  }
}

std::vector<std::int64_t> raw_c_split_hops(const std::string& tag, std::size_t count) {
  const Participant dds(tag);
  const dds_entity_t reader = dds.reader(0);
  const Waitset waitset(dds, reader);
  std::vector<std::int64_t> hops;
  hops.reserve(count);
  for (bench_msgs_msg_Payload sample{}; hops.size() < count;) {
    waitset.wait();
    while (take(reader, sample)) hops.push_back(now_ns() - sample.stamp);
  }
  dds_delete_qos(dds.qos);
  dds_delete(dds.domain);
  return hops;
}

}  // namespace kervan::bench
