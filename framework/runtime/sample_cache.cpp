#include "framework/runtime/sample_cache.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "framework/component/sample.hpp"

namespace kervan::runtime {

namespace {
Time later(Time t, Duration d) { return d == forever ? Time::max() : t + d; }
}  // namespace

SampleCache::SampleCache(const QosProfile& profile, Duration max_age, bool keyed, bool queued, bool watch_lease)
    : profile_(profile),
      max_age_(max_age),
      keyed_(keyed),
      most_kept_(static_cast<std::size_t>(profile.depth > 0   ? profile.depth
                                          : profile.limit > 0 ? profile.limit
                                                              : kMostKept)),
      limit_(profile.limit > 0 ? static_cast<std::size_t>(profile.limit) : std::numeric_limits<std::size_t>::max()),
      watch_lease_(watch_lease && profile.liveliness == Liveliness::manual && profile.lease != forever),
      queued_(queued) {}

SampleCache::~SampleCache() {
  for (std::size_t i = next_fresh_; i < fresh_.size(); ++i)
    if (fresh_[i].block) dds::release(fresh_[i].block);
  for (const Instance& instance : instances_)
    if (instance.newest) dds::release(instance.newest);
}

SampleCache::Instance& SampleCache::instance(std::uint64_t id) {
  if (!keyed_) {
    if (instances_.empty()) instances_.push_back({.id = 0});
    return instances_.front();
  }
  const auto [found, is_new] = index_.try_emplace(id, instances_.size());
  if (is_new) instances_.push_back({.id = id});
  return instances_[found->second];
}

/// Instances may come and go for ever; what is disposed of is swept out when it prevails, at constant cost per sample.
void SampleCache::forget_disposed() {
  if (disposed_ < 16 || disposed_ * 2 < instances_.size()) return;
  const std::uint64_t newest = instances_[newest_].id;
  std::erase_if(instances_, [&](const Instance& i) { return i.disposed && i.fresh == 0 && i.id != newest; });
  index_.clear();
  for (std::size_t i = 0; i < instances_.size(); ++i) {
    index_[instances_[i].id] = i;
    if (instances_[i].id == newest) newest_ = i;
  }
  disposed_ = 0;
}

bool SampleCache::owns(Instance& instance, const StagedSample& sample) {
  if (profile_.ownership == Ownership::shared) return true;
  const bool takes_over = !instance.owned || sample.writer == instance.owner || sample.strength > instance.strength ||
                          (sample.strength == instance.strength && sample.writer < instance.owner);
  if (!takes_over) return false;
  instance.owned = true;
  instance.owner = sample.writer;
  instance.strength = sample.strength;
  return true;
}

void SampleCache::renew_lease(const StagedSample& sample) {
  if (!watch_lease_) return;
  const Time due = later(sample.received, profile_.lease);
  for (Lease& lease : leases_) {
    if (lease.writer != sample.writer) continue;
    lease.due = due;
    return;
  }
  leases_.push_back({sample.writer, due});
}

void SampleCache::drop_oldest_fresh(Instance& instance) {
  for (std::size_t i = next_fresh_; i < fresh_.size(); ++i) {
    if (!fresh_[i].block || (keyed_ && fresh_[i].instance != instance.id)) continue;
    dds::release(fresh_[i].block);
    fresh_[i].block = nullptr;
    --instance.fresh;
    --live_fresh_;
    if (queued_) ++counters_.overwritten;
    break;
  }
  // Gaps are closed only when they prevail, so that the cost per sample stays constant.
  if (fresh_.size() > 2 * live_fresh_ + 16) {
    fresh_.erase(std::remove_if(fresh_.begin(), fresh_.end(), [](const Fresh& f) { return !f.block; }), fresh_.end());
    next_fresh_ = 0;
  }
}

void SampleCache::stage(const std::vector<StagedSample>& samples) {
  for (const StagedSample& sample : samples) {
    renew_lease(sample);
    Instance& target = instance(sample.instance);
    // An assertion repeats its writer's last sample, which is news to nobody but a late joiner.
    const bool late_joiner = !target.newest && profile_.durability == Durability::transient_local;
    if (watch_lease_ && dds::is_assertion(sample.block) && !late_joiner) {
      dds::release(sample.block);
      continue;
    }
    ++counters_.received;
    if (!owns(target, sample)) {
      ++counters_.not_owner;
      dds::release(sample.block);
      continue;
    }
    if (queued_ && live_fresh_ >= limit_) {
      ++counters_.refused;
      dds::release(sample.block);
      continue;
    }
    target.due = later(sample.received, profile_.deadline);
    target.received = sample.received;
    if (target.newest) dds::release(target.newest);
    target.newest = nullptr;
    target.disposed = dds::is_disposed(sample.block);
    if (target.disposed) {
      target.due = Time::max();
      target.owned = false;
      ++disposed_;
      // Nobody takes samples here, so nobody waits for the end of the instance either.
      while (!queued_ && target.fresh > 0) drop_oldest_fresh(target);
    } else {
      dds::retain(sample.block);
      target.newest = sample.block;
    }
    newest_ = static_cast<std::size_t>(&target - instances_.data());
    if (static_cast<std::size_t>(target.fresh) >= most_kept_) drop_oldest_fresh(target);
    if (target.disposed && !queued_) {
      dds::release(sample.block);
      continue;
    }
    fresh_.push_back({sample.block, target.id, sample.received});
    ++target.fresh;
    ++live_fresh_;
  }
  if (keyed_) forget_disposed();
}

dds::SampleBlock* SampleCache::take(Time now) {
  queued_ = true;
  while (next_fresh_ < fresh_.size()) {
    const Fresh fresh = std::exchange(fresh_[next_fresh_++], Fresh{});
    if (next_fresh_ == fresh_.size()) {
      fresh_.clear();
      next_fresh_ = 0;
    }
    if (!fresh.block) continue;
    --live_fresh_;
    --instance(fresh.instance).fresh;
    if (later(fresh.received, profile_.lifespan) <= now) {
      ++counters_.expired;
      dds::release(fresh.block);
      continue;
    }
    ++counters_.handled;
    return fresh.block;
  }
  return nullptr;
}

bool SampleCache::too_old(Time received, Time now) const {
  return later(received, profile_.lifespan) <= now || (max_age_ != forever && now - received > max_age_);
}

dds::SampleBlock* SampleCache::latest(Time now) const {
  if (instances_.empty()) return nullptr;
  const Instance& newest = instances_[newest_];
  return newest.newest && !too_old(newest.received, now) ? newest.newest : nullptr;
}

bool SampleCache::last_received(Time& at) const {
  if (instances_.empty()) return false;
  at = instances_[newest_].received;
  return true;
}

std::vector<dds::SampleBlock*> SampleCache::instances(Time now) const {
  std::vector<dds::SampleBlock*> alive;
  for (const Instance& instance : instances_)
    if (instance.newest && !too_old(instance.received, now)) alive.push_back(instance.newest);
  return alive;
}

void SampleCache::free_instances(unsigned owner) {
  for (Instance& instance : instances_)
    if (instance.owned && instance.owner == owner) instance.owned = false;
}

void SampleCache::writer_gone(unsigned writer) {
  free_instances(writer);
  std::erase_if(leases_, [&](const Lease& lease) { return lease.writer == writer; });
}

void SampleCache::writer_lost(unsigned writer) {
  ++counters_.liveliness_lost;
  free_instances(writer);
}

Time SampleCache::next_deadline() const {
  Time next = Time::max();
  for (const Lease& lease : leases_) next = std::min(next, lease.due);
  if (profile_.deadline == forever) return next;
  for (const Instance& instance : instances_) next = std::min(next, instance.due);
  return next;
}

void SampleCache::restart_deadlines(Time now) {
  for (Instance& instance : instances_)
    if (instance.due != Time::max()) instance.due = later(now, profile_.deadline);
}

bool SampleCache::check_deadlines(Time now) {
  bool missed = false;
  for (Lease& lease : leases_) {
    if (lease.due > now) continue;
    lease.due = Time::max();
    writer_lost(lease.writer);
    missed = true;
  }
  if (profile_.deadline == forever) return missed;
  for (Instance& instance : instances_) {
    while (instance.due <= now) {
      ++counters_.deadline_missed;
      instance.due = later(instance.due, profile_.deadline);
      instance.owned = false;  // whoever missed the deadline no longer owns the instance
      missed = true;
    }
  }
  return missed;
}

}  // namespace kervan::runtime
