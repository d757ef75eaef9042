#include "c_peer.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "RosLaserScan.h"
#include "dds/dds.h"

typedef sensor_msgs_msg_dds__LaserScan_ scan_t;

enum { MAX_RANGES = 100000, PACE_MS = 10 };

static float buffer_of_ranges[MAX_RANGES], buffer_of_intensities[3];

/* Sample number n; wire_test.cpp has the same for Kervan's type. */
static scan_t scan_number(int n) {
  const float x = (float)n;
  scan_t scan = {
      .header = {.stamp = {.sec = n, .nanosec = 1000u * (unsigned)n}, .frame_id = (char *)"r1/laser"},
      .angle_min = -0.5f * x,
      .angle_max = 0.5f * x,
      .angle_increment = 0.25f,
      .time_increment = 0.125f,
      .scan_time = x / 16.0f,
      .range_min = 0.05f,
      .range_max = x + 0.5f,
  };
  scan.ranges._buffer = buffer_of_ranges;
  scan.ranges._length = n % 5 == 0 ? MAX_RANGES : (unsigned)(n % 5); /* every fifth needs many datagrams */
  for (unsigned i = 0; i < scan.ranges._length; ++i) buffer_of_ranges[i] = x + 0.5f * (float)i;
  scan.intensities._buffer = buffer_of_intensities;
  scan.intensities._length = (unsigned)(n % 3);
  for (unsigned i = 0; i < scan.intensities._length; ++i) buffer_of_intensities[i] = -(float)i;
  return scan;
}

static bool same_sequence(const dds_sequence_float *a, const dds_sequence_float *b) {
  return a->_length == b->_length &&
         (a->_length == 0 || memcmp(a->_buffer, b->_buffer, a->_length * sizeof(float)) == 0);
}

static bool same(const scan_t *a, const scan_t *b) {
  return a->header.stamp.sec == b->header.stamp.sec && a->header.stamp.nanosec == b->header.stamp.nanosec &&
         strcmp(a->header.frame_id, b->header.frame_id) == 0 && a->angle_min == b->angle_min &&
         a->angle_max == b->angle_max && a->angle_increment == b->angle_increment &&
         a->time_increment == b->time_increment && a->scan_time == b->scan_time && a->range_min == b->range_min &&
         a->range_max == b->range_max && same_sequence(&a->ranges, &b->ranges) &&
         same_sequence(&a->intensities, &b->intensities);
}

static const char *const wire_name = "sensor_msgs::msg::dds_::LaserScan_";

typedef struct endpoint {
  dds_entity_t domain, participant, entity;
} endpoint_t;

/* The type's descriptor under another name, with or without XTypes information. */
static dds_topic_descriptor_t descriptor_of(const dds_topic_descriptor_t *type, const char *name,
                                            bool type_information) {
  const struct dds_type_meta_ser none = {NULL, 0};
  const dds_topic_descriptor_t descriptor = {
      .m_size = type->m_size,
      .m_align = type->m_align,
      .m_flagset = type_information ? type->m_flagset : type->m_flagset & ~DDS_TOPIC_XTYPES_METADATA,
      .m_nkeys = type->m_nkeys,
      .m_typename = name,
      .m_keys = type->m_keys,
      .m_nops = type->m_nops,
      .m_ops = type->m_ops,
      .m_meta = type->m_meta,
      .type_information = type_information ? type->type_information : none,
      .type_mapping = type_information ? type->type_mapping : none,
      .restrict_data_representation = type->restrict_data_representation,
  };
  return descriptor;
}

static bool open_endpoint(endpoint_t *endpoint, const c_peer_options_t *options, const dds_topic_descriptor_t *type,
                          const char *name, bool reader) {
  char configuration[512];
  snprintf(configuration, sizeof configuration,
           "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/></Interfaces></General>"
           "<Discovery><Tag>%s</Tag><ParticipantIndex>auto</ParticipantIndex>"
           "<MaxAutoParticipantIndex>119</MaxAutoParticipantIndex></Discovery>",
           options->tag);
  endpoint->domain = dds_create_domain(options->domain, configuration);
  endpoint->participant = dds_create_participant(options->domain, NULL, NULL);
  const dds_topic_descriptor_t descriptor = descriptor_of(type, name, options->type_information);
  const dds_entity_t topic = dds_create_topic(endpoint->participant, &descriptor, "rt/scan", NULL, NULL);
  dds_qos_t *qos = dds_create_qos();
  dds_qset_reliability(qos, options->reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, DDS_INFINITY);
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, DDS_LENGTH_UNLIMITED);
  if (options->transient_local) dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  if (!options->type_information) { /* as ROS 2: XCDR1 and nothing else */
    const dds_data_representation_id_t xcdr1 = DDS_DATA_REPRESENTATION_XCDR1;
    dds_qset_data_representation(qos, 1, &xcdr1);
  }
  endpoint->entity = reader ? dds_create_reader(endpoint->participant, topic, qos, NULL)
                            : dds_create_writer(endpoint->participant, topic, qos, NULL);
  dds_delete_qos(qos);
  if (endpoint->entity > 0) return true;
  fprintf(stderr, "the C peer cannot open its endpoint: %s\n", dds_strretcode(-endpoint->entity));
  return false;
}

bool c_peer_wanted(void) {
  struct pollfd in = {.fd = STDIN_FILENO, .events = POLLIN};
  return poll(&in, 1, PACE_MS) == 0;
}

static void say_ready_once(bool *said, bool matched) {
  if (*said || !matched) return;
  puts("ready");
  fflush(stdout);
  *said = true;
}

int c_peer_read(const c_peer_options_t *options) {
  endpoint_t endpoint;
  if (!open_endpoint(&endpoint, options, &sensor_msgs_msg_dds__LaserScan__desc, wire_name, true)) return 1;
  bool ready = false;
  while (c_peer_wanted()) {
    dds_subscription_matched_status_t matched;
    dds_get_subscription_matched_status(endpoint.entity, &matched);
    say_ready_once(&ready, matched.current_count > 0);
    for (;;) {
      void *sample = NULL;
      dds_sample_info_t info;
      if (dds_take(endpoint.entity, &sample, &info, 1, 1) <= 0) break;
      if (info.valid_data) {
        const scan_t *scan = sample;
        const scan_t expected = scan_number(scan->header.stamp.sec);
        printf("sample %d %s\n", (int)scan->header.stamp.sec, same(scan, &expected) ? "right" : "wrong");
        fflush(stdout);
      }
      dds_return_loan(endpoint.entity, &sample, 1);
    }
  }
  return dds_delete(endpoint.domain) == DDS_RETCODE_OK ? 0 : 1;
}

static bool wait_for_a_reader(dds_entity_t writer) {
  bool ready = false;
  while (!ready) {
    if (!c_peer_wanted()) return false;
    dds_publication_matched_status_t matched;
    dds_get_publication_matched_status(writer, &matched);
    say_ready_once(&ready, matched.current_count > 0);
  }
  return true;
}

int c_peer_write(const c_peer_options_t *options) {
  endpoint_t endpoint;
  if (!open_endpoint(&endpoint, options, &sensor_msgs_msg_dds__LaserScan__desc, wire_name, false)) return 1;
  if (!wait_for_a_reader(endpoint.entity)) return 1;
  for (int n = 1;; ++n) {
    if (n > options->count) {
      if (options->reliable) break;
      n = 1;
    }
    const scan_t scan = scan_number(n);
    if (dds_write(endpoint.entity, &scan) != DDS_RETCODE_OK) return 1;
    if (!c_peer_wanted()) break;
  }
  while (c_peer_wanted()) {
  }
  return dds_delete(endpoint.domain) == DDS_RETCODE_OK ? 0 : 1;
}

int c_peer_write_short(const c_peer_options_t *options) {
  endpoint_t endpoint;
  if (!open_endpoint(&endpoint, options, &wire_test_ShortScan_desc, wire_name, false)) return 1;
  if (!wait_for_a_reader(endpoint.entity)) return 1;
  for (int n = 1; n <= options->count; ++n) {
    const wire_test_ShortScan scan = {.header = {.stamp = {.sec = n}, .frame_id = (char *)"r1/laser"}};
    if (dds_write(endpoint.entity, &scan) != DDS_RETCODE_OK) return 1;
  }
  if (options->reliable && dds_wait_for_acks(endpoint.entity, DDS_SECS(30)) == DDS_RETCODE_OK) puts("acknowledged");
  fflush(stdout);
  while (c_peer_wanted()) {
  }
  return dds_delete(endpoint.domain) == DDS_RETCODE_OK ? 0 : 1;
}

int c_peer_write_other(const c_peer_options_t *options) {
  endpoint_t endpoint;
  const dds_topic_descriptor_t *type = &wire_test_ShortScan_desc;
  if (!open_endpoint(&endpoint, options, type, type->m_typename, false)) return 1;
  while (c_peer_wanted()) {
  }
  return dds_delete(endpoint.domain) == DDS_RETCODE_OK ? 0 : 1;
}
