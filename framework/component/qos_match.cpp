#include "framework/component/qos_match.hpp"

#include <algorithm>

namespace kervan {
namespace {

std::string_view to_text(DurabilityKind kind) {
  switch (kind) {
    case DurabilityKind::volatile_: return "volatile";
    case DurabilityKind::transient_local: return "transient_local";
    case DurabilityKind::transient: return "transient";
    case DurabilityKind::persistent: return "persistent";
  }
  return "unknown";
}

std::string_view to_text(LivelinessKind kind) {
  switch (kind) {
    case LivelinessKind::automatic: return "automatic";
    case LivelinessKind::manual_by_participant: return "manual_by_participant";
    case LivelinessKind::manual_by_topic: return "manual_by_topic";
  }
  return "unknown";
}

std::string_view to_text(Representation representation) {
  switch (representation) {
    case Representation::xcdr1: return "xcdr1";
    case Representation::xml: return "xml";
    case Representation::xcdr2: return "xcdr2";
  }
  return "unknown";
}

std::string presentation_text(const EndpointQos& qos) {
  constexpr const char* scopes[] = {"instance", "topic", "group"};
  return std::string(scopes[static_cast<int>(qos.access_scope)]) + (qos.coherent_access ? ", coherent" : "") +
         (qos.ordered_access ? ", ordered" : "");
}

std::string representations_text(const std::vector<Representation>& representations) {
  std::string text;
  for (const Representation r : representations) text += (text.empty() ? "" : " or ") + std::string(to_text(r));
  return text;
}

/// Patterns come from other processes too, so the time is bounded: a star is only ever retried for the last one met.
bool fits_pattern(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0, star = std::string_view::npos, star_took = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_took = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p;
      ++n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++star_took;
    } else {
      return false;
    }
  }
  return pattern.substr(p).find_first_not_of('*') == std::string_view::npos;
}

bool names_meet(const std::string& a, const std::string& b) {
  const bool a_is_pattern = is_partition_pattern(a);
  if (a_is_pattern && is_partition_pattern(b)) return false;
  return a_is_pattern ? fits_pattern(a, b) : fits_pattern(b, a);
}

class Comparison {
 public:
  explicit Comparison(std::vector<QosConflict>& conflicts) : conflicts_(conflicts) {}

  void require(bool good, QosPolicy policy, std::string offered, std::string requested, const char* how = "") {
    if (good) return;
    std::string sentence = "the reader requests " + std::string(kervan::to_text(policy)) + " " + requested + how +
                           ", the writer offers " + offered;
    conflicts_.push_back({policy, std::move(offered), std::move(requested), std::move(sentence)});
  }

 private:
  std::vector<QosConflict>& conflicts_;
};

}  // namespace

std::string_view to_text(QosPolicy policy) {
  switch (policy) {
    case QosPolicy::durability: return "durability";
    case QosPolicy::presentation: return "presentation";
    case QosPolicy::deadline: return "deadline";
    case QosPolicy::latency_budget: return "latency budget";
    case QosPolicy::ownership: return "ownership";
    case QosPolicy::liveliness: return "liveliness";
    case QosPolicy::partition: return "partition";
    case QosPolicy::reliability: return "reliability";
    case QosPolicy::destination_order: return "destination order";
    case QosPolicy::representation: return "data representation";
  }
  return "unknown";
}

bool is_partition_pattern(std::string_view name) { return name.find_first_of("*?") != std::string_view::npos; }

bool partitions_meet(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  static const std::vector<std::string> only_the_unnamed{""};
  const std::vector<std::string>& of_a = a.empty() ? only_the_unnamed : a;
  const std::vector<std::string>& of_b = b.empty() ? only_the_unnamed : b;
  return std::ranges::any_of(of_a, [&](const std::string& name) {
    return std::ranges::any_of(of_b, [&](const std::string& other) { return names_meet(name, other); });
  });
}

std::vector<QosConflict> qos_conflicts(const EndpointQos& offered, const EndpointQos& requested) {
  std::vector<QosConflict> conflicts;
  Comparison compare(conflicts);
  compare.require(requested.reliability <= offered.reliability, QosPolicy::reliability,
                  std::string(to_text(offered.reliability)), std::string(to_text(requested.reliability)));
  compare.require(requested.durability <= offered.durability, QosPolicy::durability,
                  std::string(to_text(offered.durability)), std::string(to_text(requested.durability)));
  compare.require(requested.access_scope <= offered.access_scope &&
                      requested.coherent_access <= offered.coherent_access &&
                      requested.ordered_access <= offered.ordered_access,
                  QosPolicy::presentation, presentation_text(offered), presentation_text(requested));
  compare.require(requested.deadline >= offered.deadline, QosPolicy::deadline, duration_text(offered.deadline),
                  duration_text(requested.deadline), " or shorter");
  compare.require(requested.latency_budget >= offered.latency_budget, QosPolicy::latency_budget,
                  duration_text(offered.latency_budget), duration_text(requested.latency_budget), " or shorter");
  compare.require(requested.ownership == offered.ownership, QosPolicy::ownership,
                  std::string(to_text(offered.ownership)), std::string(to_text(requested.ownership)));
  const auto liveliness_text = [](const EndpointQos& qos) {
    return std::string(to_text(qos.liveliness)) + ", lease " + duration_text(qos.lease);
  };
  compare.require(requested.liveliness <= offered.liveliness && requested.lease >= offered.lease, QosPolicy::liveliness,
                  liveliness_text(offered), liveliness_text(requested), " or shorter");
  const auto order_text = [](const EndpointQos& qos) {
    return std::string(qos.destination_order == DestinationOrder::by_source ? "by source" : "by reception");
  };
  compare.require(requested.destination_order <= offered.destination_order, QosPolicy::destination_order,
                  order_text(offered), order_text(requested));
  compare.require(partitions_meet(offered.partition, requested.partition), QosPolicy::partition,
                  partition_text(offered.partition), partition_text(requested.partition));
  compare.require(!offered.representations.empty() &&
                      std::ranges::find(requested.representations, offered.representations.front()) !=
                          requested.representations.end(),
                  QosPolicy::representation, representations_text(offered.representations),
                  representations_text(requested.representations));
  return conflicts;
}

EndpointQos offered_qos(const QosProfile& profile) {
  EndpointQos qos;
  qos.reliability = profile.reliability;
  qos.durability =
      profile.durability == Durability::transient_local ? DurabilityKind::transient_local : DurabilityKind::volatile_;
  qos.deadline = profile.deadline;
  // A budget above zero leaves sending to Cyclone's own thread, so local readers do not wait for the network.
  qos.latency_budget = profile.network == Network::async ? std::chrono::microseconds(1) : Duration::zero();
  qos.ownership = profile.ownership;
  qos.liveliness =
      profile.liveliness == Liveliness::manual ? LivelinessKind::manual_by_topic : LivelinessKind::automatic;
  qos.lease = profile.lease;
  qos.partition = profile.partition;
  return qos;
}

EndpointQos requested_qos(const QosProfile& profile) {
  EndpointQos qos = offered_qos(profile);
  qos.deadline = qos.latency_budget = qos.lease = forever;
  qos.liveliness = LivelinessKind::automatic;
  return qos;
}

EndpointQos required_qos(const QosProfile& profile, const PortQos& port) {
  EndpointQos qos = requested_qos(profile);
  qos.deadline = port.deadline();
  qos.lease = port.lease();
  const QosProfile declared = builtin_profile(port.profile()).value_or(QosProfile{});
  qos.reliability = port.is_lossless() ? Reliability::reliable : Reliability::best_effort;
  const bool needs_old = port.is_from_before() || declared.durability == Durability::transient_local;
  qos.durability = needs_old ? DurabilityKind::transient_local : DurabilityKind::volatile_;
  return qos;
}

}  // namespace kervan
