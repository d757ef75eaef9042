#include "framework/dds/endpoint_qos.hpp"

#include <vector>

namespace kervan::dds {
namespace {

dds_duration_t to_dds(Duration duration) { return duration == forever ? DDS_INFINITY : duration.count(); }
Duration from_dds(dds_duration_t duration) { return duration == DDS_INFINITY ? forever : Duration(duration); }

}  // namespace

void set_endpoint_qos(dds_qos_t* to, const EndpointQos& qos) {
  // The enumerations have the order of DDS, which is what its rules compare.
  dds_qset_reliability(to, static_cast<dds_reliability_kind_t>(qos.reliability), DDS_INFINITY);
  dds_qset_durability(to, static_cast<dds_durability_kind_t>(qos.durability));
  dds_qset_deadline(to, to_dds(qos.deadline));
  dds_qset_latency_budget(to, to_dds(qos.latency_budget));
  dds_qset_ownership(to, static_cast<dds_ownership_kind_t>(qos.ownership));
  dds_qset_liveliness(to, static_cast<dds_liveliness_kind_t>(qos.liveliness), to_dds(qos.lease));
  dds_qset_destination_order(to, static_cast<dds_destination_order_kind_t>(qos.destination_order));
  dds_qset_presentation(to, static_cast<dds_presentation_access_scope_kind_t>(qos.access_scope), qos.coherent_access,
                        qos.ordered_access);
  std::vector<dds_data_representation_id_t> representations;
  for (const Representation r : qos.representations)
    representations.push_back(static_cast<dds_data_representation_id_t>(r));
  dds_qset_data_representation(to, static_cast<std::uint32_t>(representations.size()), representations.data());
  std::vector<const char*> names;
  for (const std::string& name : qos.partition) names.push_back(name.c_str());
  dds_qset_partition(to, static_cast<std::uint32_t>(names.size()), names.empty() ? nullptr : names.data());
}

EndpointQos endpoint_qos(const dds_qos_t* from) {
  EndpointQos qos;
  dds_duration_t duration = 0;
  if (dds_reliability_kind_t kind; dds_qget_reliability(from, &kind, nullptr))
    qos.reliability = static_cast<Reliability>(kind);
  if (dds_durability_kind_t kind; dds_qget_durability(from, &kind)) qos.durability = static_cast<DurabilityKind>(kind);
  if (dds_qget_deadline(from, &duration)) qos.deadline = from_dds(duration);
  if (dds_qget_latency_budget(from, &duration)) qos.latency_budget = from_dds(duration);
  if (dds_ownership_kind_t kind; dds_qget_ownership(from, &kind)) qos.ownership = static_cast<Ownership>(kind);
  if (dds_liveliness_kind_t kind; dds_qget_liveliness(from, &kind, &duration)) {
    qos.liveliness = static_cast<LivelinessKind>(kind);
    qos.lease = from_dds(duration);
  }
  if (dds_destination_order_kind_t kind; dds_qget_destination_order(from, &kind))
    qos.destination_order = static_cast<DestinationOrder>(kind);
  if (dds_presentation_access_scope_kind_t scope;
      dds_qget_presentation(from, &scope, &qos.coherent_access, &qos.ordered_access))
    qos.access_scope = static_cast<AccessScope>(scope);
  std::uint32_t count = 0;
  dds_data_representation_id_t* representations = nullptr;
  if (dds_qget_data_representation(from, &count, &representations) && count > 0) {
    qos.representations.clear();
    for (std::uint32_t i = 0; i < count; ++i)
      qos.representations.push_back(static_cast<Representation>(representations[i]));
  }
  dds_free(representations);
  char** names = nullptr;
  if (dds_qget_partition(from, &count, &names))
    for (std::uint32_t i = 0; i < count; ++i) {
      qos.partition.emplace_back(names[i]);
      dds_free(names[i]);
    }
  dds_free(names);
  return qos;
}

}  // namespace kervan::dds
