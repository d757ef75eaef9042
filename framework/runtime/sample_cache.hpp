/// The one implementation of history, limit, lifespan, deadline, max age, ownership and manual lease: what an input
/// port keeps of the samples that reached it. Times are on the composition's clock and always passed in. Not
/// thread-safe: the component's thread.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "framework/component/qos.hpp"
#include "framework/component/time.hpp"

namespace kervan::dds {
struct SampleBlock;
}

namespace kervan::runtime {

/// A sample on its way into the cache. The reference to the block travels with it.
struct StagedSample {
  dds::SampleBlock* block;
  unsigned writer;         ///< its index in the composition: the canonical order
  std::uint64_t instance;  ///< equal for equal keys
  std::int32_t strength;   ///< of the writer, for exclusive ownership
  Time received;
};

/// What happened to the samples of one port so far.
struct PortCounters {
  std::uint64_t received = 0;
  std::uint64_t handled = 0;          ///< given to the component
  std::uint64_t overwritten = 0;      ///< pushed out by newer ones before the component took them
  std::uint64_t expired = 0;          ///< past their lifespan before the component took them
  std::uint64_t refused = 0;          ///< not taken in: the profile's limit was reached, or the inbox was full
  std::uint64_t not_owner = 0;        ///< from a writer that did not own the instance
  std::uint64_t deadline_missed = 0;  ///< periods of the deadline without a sample
  std::uint64_t liveliness_lost = 0;  ///< times that a writer was not alive for a whole lease
  std::uint64_t late = 0;             ///< handled although older than the port's largest age
  std::uint64_t lost = 0;             ///< published by a matched writer, but never received: gaps in its sequence
  std::uint64_t undecodable = 0;      ///< received, but no message of the port's type
  Duration worst_latency{};           ///< longest time from receipt to the beginning of the handler

  bool operator==(const PortCounters&) const = default;
};

class SampleCache {
 public:
  /// `queued`: each sample is waited for; otherwise that is assumed from the first take() on. `watch_lease`: a manual
  /// lease runs here, from sample to sample; else writer_lost() says that it is over.
  SampleCache(const QosProfile& profile, Duration max_age, bool keyed, bool queued = false, bool watch_lease = false);
  SampleCache(const SampleCache&) = delete;
  SampleCache& operator=(const SampleCache&) = delete;
  ~SampleCache();

  /// Takes the samples over, in this order: ownership first, then the limit, then history depth per instance.
  void stage(const std::vector<StagedSample>& samples);

  /// The oldest sample that was not yet given out and is not past its lifespan; nullptr if none is left. The caller
  /// gets the reference.
  dds::SampleBlock* take(Time now);
  bool has_fresh() const { return live_fresh_ > 0; }

  /// The newest live sample of any instance; nullptr if there is none or it is too old. Not retained for the caller.
  dds::SampleBlock* latest(Time now) const;
  /// When the newest sample was received, however old; false if there is none.
  bool last_received(Time& at) const;
  /// The newest live sample of each instance, in order of first appearance. Not retained for the caller.
  std::vector<dds::SampleBlock*> instances(Time now) const;

  /// Instances that take up memory, those disposed of a moment ago included.
  std::size_t remembered_instances() const { return instances_.size(); }

  /// The writer ended: what it owned is free, and no lease of it runs any more.
  void writer_gone(unsigned writer);
  /// The writer was not alive for a whole lease: what it owned is free until it is heard of again.
  void writer_lost(unsigned writer);

  /// The earliest time at which an instance misses the deadline or a lease ends; Time::max() if there is none.
  Time next_deadline() const;
  /// The deadlines of all instances begin anew: nobody watched them until now.
  void restart_deadlines(Time now);
  /// Counts the deadlines missed and leases ended at or before `now`; true if there was one.
  bool check_deadlines(Time now);

  const PortCounters& counters() const { return counters_; }
  const QosProfile& profile() const { return profile_; }

 private:
  struct Instance {
    std::uint64_t id;
    dds::SampleBlock* newest = nullptr;  ///< nullptr once disposed
    Time received{};
    Time due = Time::max();
    bool owned = false;
    unsigned owner = 0;
    std::int32_t strength = 0;
    int fresh = 0;          ///< samples of it in fresh_
    bool disposed = false;  ///< forgotten once nothing of it is left in fresh_
  };
  struct Lease {
    unsigned writer;
    Time due;
  };
  struct Fresh {
    dds::SampleBlock* block = nullptr;  ///< nullptr once given out or overwritten
    std::uint64_t instance = 0;
    Time received{};
  };

  Instance& instance(std::uint64_t id);
  void forget_disposed();
  bool owns(Instance& instance, const StagedSample& sample);
  void renew_lease(const StagedSample& sample);
  void free_instances(unsigned owner);
  void drop_oldest_fresh(Instance& instance);
  bool too_old(Time received, Time now) const;

  QosProfile profile_;
  Duration max_age_;
  bool keyed_;
  std::size_t most_kept_;  ///< of each instance
  std::size_t limit_;      ///< of all instances together
  bool watch_lease_;
  std::vector<Lease> leases_;                             ///< of the writers heard of, while watched here
  std::vector<Instance> instances_;                       ///< in order of first appearance
  std::unordered_map<std::uint64_t, std::size_t> index_;  ///< of keyed topics: id -> place in instances_
  std::size_t disposed_ = 0;                              ///< disposed instances that may be forgotten
  std::vector<Fresh> fresh_;                              ///< those not yet given out, from next_fresh_ on
  std::size_t next_fresh_ = 0;
  std::size_t live_fresh_ = 0;  ///< blocks in fresh_
  bool queued_;                 ///< somebody takes; a port that only looks at the newest loses nothing
  std::size_t newest_ = 0;      ///< place of the instance that got the newest sample
  PortCounters counters_;
};

}  // namespace kervan::runtime
