/// The request/offer rules of DDS as a function over plain values: whether a reader and a writer of one topic match,
/// and if not, why. The verdict is Cyclone DDS's; a conformance test compares the two. `kervan check` judges
/// compositions with it, discovery the endpoints of other processes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "framework/component/qos.hpp"

namespace kervan {

enum class DurabilityKind { volatile_, transient_local, transient, persistent };
enum class LivelinessKind { automatic, manual_by_participant, manual_by_topic };
enum class DestinationOrder { by_reception, by_source };
enum class AccessScope { instance, topic, group };
/// How samples are written on the wire; the numbers are those of DDS-XTypes.
enum class Representation : std::int16_t { xcdr1 = 0, xml = 1, xcdr2 = 2 };

/// Everything that decides whether two endpoints match, in the terms of DDS. The defaults are those of DDS for a
/// reader.
struct EndpointQos {
  Reliability reliability = Reliability::best_effort;
  DurabilityKind durability = DurabilityKind::volatile_;
  Duration deadline = forever;
  Duration latency_budget = Duration::zero();
  Ownership ownership = Ownership::shared;
  LivelinessKind liveliness = LivelinessKind::automatic;
  Duration lease = forever;
  DestinationOrder destination_order = DestinationOrder::by_reception;
  AccessScope access_scope = AccessScope::instance;
  bool coherent_access = false;
  bool ordered_access = false;
  std::vector<Representation> representations = {Representation::xcdr1};  ///< a writer uses its first, a reader any
  std::vector<std::string> partition = {};  ///< names, or patterns with * and ?; empty is the partition ""

  bool operator==(const EndpointQos&) const = default;
};

/// The policies that decide, with their numbers in DDS.
enum class QosPolicy : std::uint32_t {
  durability = 2,
  presentation = 3,
  deadline = 4,
  latency_budget = 5,
  ownership = 6,
  liveliness = 8,
  partition = 10,
  reliability = 11,
  destination_order = 12,
  representation = 25,
};
std::string_view to_text(QosPolicy policy);

/// One reason why two endpoints do not match.
struct QosConflict {
  QosPolicy policy;
  std::string offered;    ///< by the writer, as a person reads it: "best_effort", "400 ms"
  std::string requested;  ///< by the reader
  std::string sentence;   ///< "the reader requests reliability reliable, the writer offers best_effort"
};

/// All reasons, in the order in which Cyclone looks for them: the first is the one that it reports. Empty: they match.
std::vector<QosConflict> qos_conflicts(const EndpointQos& offered, const EndpointQos& requested);

/// Whether a name of one list fits a name of the other. `*` and `?` stand for any characters, also for slashes; a
/// pattern never fits another pattern.
bool partitions_meet(const std::vector<std::string>& a, const std::vector<std::string>& b);

/// Whether a partition's name is a pattern.
bool is_partition_pattern(std::string_view name);

/// What a writer with this profile offers to DDS under the wall clock.
EndpointQos offered_qos(const QosProfile& profile);

/// What a reader with this profile requests. It accepts any deadline, lease and latency budget: the sample cache
/// watches the first two, and asking for them would refuse every writer that offers none, as most ROS 2 drivers do.
EndpointQos requested_qos(const QosProfile& profile);

/// The same of a reader that insists on what its port requires: deadline, lease, reliability, durability.
EndpointQos required_qos(const QosProfile& profile, const PortQos& port);

}  // namespace kervan
