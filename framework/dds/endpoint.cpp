#include "framework/dds/endpoint.hpp"

#include <dds/dds.h>
#include <dds/ddsc/dds_rhc.h>
#include <dds/ddsi/ddsi_tkmap.h>
#include <dds/ddsi/q_protocol.h>

#include <cstdio>
#include <mutex>
#include <type_traits>
#include <unordered_set>

#include "framework/component/sample.hpp"
#include "framework/dds/endpoint_qos.hpp"
#include "framework/dds/sample_block.hpp"

namespace kervan::dds {

bool is_disposed(const SampleBlock* block) noexcept {
  return (block->statusinfo & NN_STATUSINFO_DISPOSE) != 0 || block->kind != SDK_DATA;
}

namespace {

/// Peers read an endpoint's place in the composition and the layout of its type; `kind` is 'w' or 'r'.
void set_identity(dds_qos_t* qos, char kind, unsigned index, const TypeSupport& type) {
  char text[64];
  const int length = std::snprintf(text, sizeof text, "k%c=%u;kl=%016llx;", kind, index,
                                   static_cast<unsigned long long>(type.layout_hash));
  dds_qset_userdata(qos, text, static_cast<std::size_t>(length));
}

}  // namespace

std::optional<EndpointIdentity> parse_identity(std::string_view user_data) {
  unsigned index = 0;
  unsigned long long layout = 0;
  char role = 0;
  if (std::sscanf(std::string(user_data).c_str(), "k%c=%u;kl=%llx;", &role, &index, &layout) != 3) return std::nullopt;
  if (role != 'w' && role != 'r') return std::nullopt;
  return EndpointIdentity{index, layout};
}

namespace {

/// Frees the description that Cyclone gave of a matched endpoint.
std::optional<EndpointIdentity> identity_of(dds_builtintopic_endpoint_t* endpoint) {
  if (!endpoint) return std::nullopt;
  std::optional<EndpointIdentity> identity;
  void* data = nullptr;
  std::size_t size = 0;
  if (dds_qget_userdata(endpoint->qos, &data, &size) && data)
    identity = parse_identity({static_cast<const char*>(data), size});
  dds_free(data);
  dds_builtintopic_free_endpoint(endpoint);
  return identity;
}

using ListPeers = dds_return_t (*)(dds_entity_t, dds_instance_handle_t*, std::size_t);
using DescribePeer = dds_builtintopic_endpoint_t* (*)(dds_entity_t, dds_instance_handle_t);

std::vector<MatchedPeer> matched_peers(dds_entity_t endpoint, ListPeers list, DescribePeer describe) {
  std::vector<dds_instance_handle_t> handles(16);
  dds_return_t count = 0;
  while ((count = list(endpoint, handles.data(), handles.size())) > static_cast<dds_return_t>(handles.size()))
    handles.resize(static_cast<std::size_t>(count));
  std::vector<MatchedPeer> peers;
  for (dds_return_t i = 0; i < count; ++i) {
    const dds_instance_handle_t handle = handles[static_cast<std::size_t>(i)];
    peers.push_back({handle, identity_of(describe(endpoint, handle))});
  }
  return peers;
}

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using QosHandle = std::unique_ptr<dds_qos_t, QosDeleter>;

dds_duration_t to_dds(Duration duration) { return duration == forever ? DDS_INFINITY : duration.count(); }

/// Cyclone's form of what an endpoint offers or requests; `qos` is that of the whole profile.
QosHandle cyclone_qos(const QosProfile& profile, EndpointQos qos, CyclonePart part) {
  const bool carrier = part == CyclonePart::carrier;
  if (carrier) qos.reliability = Reliability::reliable;
  if (part != CyclonePart::whole_profile) {
    qos.deadline = qos.lease = forever;
    qos.liveliness = LivelinessKind::automatic;
    qos.ownership = Ownership::shared;
    qos.latency_budget = Duration::zero();  // the next cycle waits for the sample, so nobody gains by sending it later
  }
  QosHandle handle(dds_create_qos());
  set_endpoint_qos(handle.get(), qos);
  // Keeping all, Cyclone would make a writer wait for a reader that was stopped; keeping very many, it never does.
  const int depth = profile.depth > 0 ? profile.depth : profile.limit > 0 ? profile.limit : kMostKept;
  if (carrier)
    dds_qset_history(handle.get(), DDS_HISTORY_KEEP_ALL, DDS_LENGTH_UNLIMITED);
  else
    dds_qset_history(handle.get(), DDS_HISTORY_KEEP_LAST, depth);
  // A late joiner gets what the durability service keeps, not what the writer's history keeps: set both.
  if (profile.durability == Durability::transient_local)
    dds_qset_durability_service(handle.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  return handle;
}

/// Kervan's reader history cache. Cyclone calls store() for each sample instead of keeping it, so there is one cache
/// with one meaning of history, lifespan and ownership: the port's.
///
/// It holds on to the entries of Cyclone's instance map while their instances live. Otherwise every publish would make
/// the entry anew and hand it to the garbage collector's thread, which costs more than the hop itself.
class ReaderCache {
 public:
  ReaderCache(const dds_rhc_ops& operations, SampleSink& sink) : sink_(sink) { base_.common.ops = &operations; }
  ~ReaderCache() {
    for (ddsi_tkmap_instance* instance : instances_) ddsi_tkmap_instance_unref(map_, instance);
  }
  ReaderCache(const ReaderCache&) = delete;
  ReaderCache& operator=(const ReaderCache&) = delete;

  static ReaderCache& of(void* rhc) { return *static_cast<ReaderCache*>(rhc); }
  dds_rhc* base() { return &base_; }
  SampleSink& sink() { return sink_; }
  void use(ddsi_tkmap* map) { map_ = map; }

  void store(const ddsi_writer_info& writer, ddsi_serdata* sample, ddsi_tkmap_instance* instance) noexcept {
    // A writer that leaves tells so through unregister_wr; an unregistering sample carries no data.
    const bool dispose = sample->statusinfo & NN_STATUSINFO_DISPOSE;
    if ((sample->statusinfo & NN_STATUSINFO_UNREGISTER) && !dispose && sample->kind != SDK_DATA) return;
    hold(instance);
    SampleBlock* const block = as_block(sample);
    sink_.on_sample({block, writer.iid, block->instance, writer.ownership_strength, block->sequence});
    if (dispose) let_go(instance);
#ifdef __SANITIZE_THREAD__
    // It does not look into Cyclone, which lets go of the sample for us, and has to be shown that we are done with it.
    ddsi_serdata_unref(ddsi_serdata_ref(sample));
#endif
  }

 private:
  void hold(ddsi_tkmap_instance* instance) {
    if (newest_ == instance) return;
    newest_ = instance;
    const std::lock_guard lock(mutex_);
    if (instances_.insert(instance).second) ddsi_tkmap_instance_ref(instance);
  }
  void let_go(ddsi_tkmap_instance* instance) {
    newest_ = nullptr;
    const std::lock_guard lock(mutex_);
    if (instances_.erase(instance) != 0) ddsi_tkmap_instance_unref(map_, instance);
  }

  dds_rhc base_{};  // first: Cyclone's pointer to it is a pointer to this object
  SampleSink& sink_;
  ddsi_tkmap* map_ = nullptr;
  std::atomic<const ddsi_tkmap_instance*> newest_{nullptr};  ///< held for sure: the case of keyless topics
  std::mutex mutex_;
  std::unordered_set<ddsi_tkmap_instance*> instances_;
};

const dds_rhc_ops& reader_cache_operations() {
  static const dds_rhc_ops operations = [] {
    dds_rhc_ops ops{};
    ops.rhc_ops.store = [](ddsi_rhc* __restrict rhc, const ddsi_writer_info* __restrict writer,
                           ddsi_serdata* __restrict sample, ddsi_tkmap_instance* __restrict instance) {
      ReaderCache::of(rhc).store(*writer, sample, instance);
      return true;  // a refusal would make the writer wait and retry, and other readers miss the sample
    };
    ops.rhc_ops.unregister_wr = [](ddsi_rhc* __restrict rhc, const ddsi_writer_info* __restrict writer) {
      ReaderCache::of(rhc).sink().on_writer_gone(writer->iid);
    };
    ops.rhc_ops.relinquish_ownership = [](ddsi_rhc* __restrict rhc, const std::uint64_t writer) {
      ReaderCache::of(rhc).sink().on_writer_gone(writer);
    };
    ops.rhc_ops.set_qos = [](ddsi_rhc*, const dds_qos*) {};
    ops.rhc_ops.free = [](ddsi_rhc* rhc) { delete &ReaderCache::of(rhc); };
    // Nothing is kept here, so there is nothing to read.
    ops.read = ops.take = [](dds_rhc*, bool, void**, dds_sample_info_t*, std::uint32_t, std::uint32_t,
                             dds_instance_handle_t, dds_readcond*) -> std::int32_t { return 0; };
    ops.readcdr = ops.takecdr = [](dds_rhc*, bool, ddsi_serdata**, dds_sample_info_t*, std::uint32_t, std::uint32_t,
                                   std::uint32_t, std::uint32_t, dds_instance_handle_t) -> std::int32_t { return 0; };
    ops.add_readcondition = [](dds_rhc*, dds_readcond*) { return false; };
    ops.remove_readcondition = [](dds_rhc*, dds_readcond*) {};
    ops.lock_samples = [](dds_rhc*) -> std::uint32_t { return 0; };
    ops.associate = [](dds_rhc* rhc, dds_reader*, const ddsi_sertype*, ddsi_tkmap* map) -> dds_return_t {
      ReaderCache::of(rhc).use(map);
      return DDS_RETCODE_OK;
    };
    return ops;
  }();
  return operations;
}

static_assert(std::is_standard_layout_v<dds_rhc>);

}  // namespace

Reader::Reader(Domain& domain, const std::string& topic, const TypeSupport& type, const QosProfile& profile,
               CyclonePart part, SampleSink& sink, unsigned index) {
  const Domain::Topic handle = domain.topic(topic, type);
  const QosHandle qos = cyclone_qos(profile, requested_qos(profile), part);
  set_identity(qos.get(), 'r', index, type);
  auto* cache = new ReaderCache(reader_cache_operations(), sink);
  dds_listener_t* listener = dds_create_listener(&sink);
  dds_lset_subscription_matched(listener, [](dds_entity_t, dds_subscription_matched_status_t, void* to) {
    static_cast<SampleSink*>(to)->on_status();
  });
  dds_lset_liveliness_changed(listener, [](dds_entity_t, dds_liveliness_changed_status_t status, void* to) {
    auto& sink_of_reader = *static_cast<SampleSink*>(to);
    if (status.not_alive_count_change > 0) sink_of_reader.on_writer_lost(status.last_publication_handle);
    if (status.alive_count_change > 0) sink_of_reader.on_writer_alive(status.last_publication_handle);
  });
  dds_lset_requested_incompatible_qos(listener, [](dds_entity_t, dds_requested_incompatible_qos_status_t, void* to) {
    static_cast<SampleSink*>(to)->on_status();
  });
  entity_ = dds_create_reader_rhc(domain.participant(), handle.entity, qos.get(), listener, cache->base());
  dds_delete_listener(listener);
  if (entity_ < 0)
    throw DdsError("cannot create a reader of " + topic + " (" + type.name + "): " + dds_strretcode(-entity_));
  dds_get_instance_handle(entity_, &handle_);
}

Reader::~Reader() { dds_delete(entity_); }

EndpointStatus Reader::status() const {
  EndpointStatus status;
  dds_subscription_matched_status_t matched;
  if (dds_get_subscription_matched_status(entity_, &matched) == DDS_RETCODE_OK) {
    status.matched = matched.current_count;
    status.matched_ever = matched.total_count;
  }
  dds_requested_incompatible_qos_status_t incompatible;
  if (dds_get_requested_incompatible_qos_status(entity_, &incompatible) == DDS_RETCODE_OK) {
    status.incompatible = incompatible.total_count;
    status.last_incompatible_id = incompatible.last_policy_id;
  }
  return status;
}

std::optional<EndpointIdentity> Reader::matched_writer(std::uint64_t handle) const {
  return identity_of(dds_get_matched_publication_data(entity_, handle));
}

std::vector<MatchedPeer> Reader::matched_writers() const {
  return matched_peers(entity_, dds_get_matched_publications, dds_get_matched_publication_data);
}

Writer::Writer(Domain& domain, const std::string& topic, const TypeSupport& type, const QosProfile& profile,
               CyclonePart part, int strength, unsigned index, StatusSink* sink)
    : topic_(domain.topic(topic, type)) {
  const QosHandle qos = cyclone_qos(profile, offered_qos(profile), part);
  if (part == CyclonePart::whole_profile && profile.lifespan != forever)
    dds_qset_lifespan(qos.get(), profile.lifespan.count());
  dds_qset_ownership_strength(qos.get(), strength);
  set_identity(qos.get(), 'w', index, type);
  dds_listener_t* listener = sink ? dds_create_listener(sink) : nullptr;
  if (listener) {
    dds_lset_publication_matched(listener, [](dds_entity_t, dds_publication_matched_status_t, void* to) {
      static_cast<StatusSink*>(to)->on_status();
    });
    dds_lset_offered_incompatible_qos(listener, [](dds_entity_t, dds_offered_incompatible_qos_status_t, void* to) {
      static_cast<StatusSink*>(to)->on_status();
    });
  }
  entity_ = dds_create_writer(domain.participant(), topic_.entity, qos.get(), listener);
  dds_delete_listener(listener);
  if (entity_ < 0)
    throw DdsError("cannot create a writer of " + topic + " (" + type.name + "): " + dds_strretcode(-entity_));
  dds_get_instance_handle(entity_, &handle_);
}

Writer::~Writer() { dds_delete(entity_); }

bool Writer::wait_for_acknowledgement(Duration patience) const {
  return dds_wait_for_acks(entity_, to_dds(patience)) == DDS_RETCODE_OK;
}

SampleBlock* Writer::loan(bool cleared) {
  SampleBlock* block = topic_.type->pool->get(topic_.type, SDK_DATA);
  if (cleared) topic_.type->support->reset(block->value);
  return block;
}

void Writer::assert_alive() { dds_assert_liveliness(entity_); }

void Writer::publish(SampleBlock* block, Time now, bool dispose) {
  // The value goes along with the dispose: plain disposes of one instance merge, so they could not be counted.
  send(block, now, now.time_since_epoch().count(), dispose ? NN_STATUSINFO_DISPOSE : 0);
}

void Writer::publish_assertion(SampleBlock* block, Time now) {
  send(block, now, now.time_since_epoch().count() + kAssertionsFrom, 0);
}

void Writer::send(SampleBlock* block, Time now, std::int64_t timestamp, std::uint32_t status) {
  block->received = now;
  block->timestamp.v = timestamp;
  block->statusinfo = status;
  block->sequence = ++sequence_;
  seal(block);
  if (const dds_return_t code = dds_forwardcdr(entity_, block); code < 0)
    throw DdsError(std::string("publishing ") + topic_.type->support->name + " failed: " + dds_strretcode(-code));
}

EndpointStatus Writer::status() const {
  EndpointStatus status;
  dds_publication_matched_status_t matched;
  if (dds_get_publication_matched_status(entity_, &matched) == DDS_RETCODE_OK) {
    status.matched = matched.current_count;
    status.matched_ever = matched.total_count;
  }
  dds_offered_incompatible_qos_status_t incompatible;
  if (dds_get_offered_incompatible_qos_status(entity_, &incompatible) == DDS_RETCODE_OK) {
    status.incompatible = incompatible.total_count;
    status.last_incompatible_id = incompatible.last_policy_id;
  }
  return status;
}

std::vector<MatchedPeer> Writer::matched_readers() const {
  return matched_peers(entity_, dds_get_matched_subscriptions, dds_get_matched_subscription_data);
}

}  // namespace kervan::dds
