/// The running side of Input and Output: a DDS reader with its inbox and sample cache, a DDS writer with its trace.
#pragma once

#include <atomic>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "framework/component/ports.hpp"
#include "framework/dds/endpoint.hpp"
#include "framework/runtime/counted_writers.hpp"
#include "framework/runtime/port_health.hpp"
#include "framework/runtime/sample_cache.hpp"
#include "framework/runtime/spec.hpp"

namespace kervan::runtime {

class ComponentInstance;
class Countdown;

/// Where the run stands: logical time and delta cycle; under the wall clock the cycle stays 0.
struct Instant {
  Time time{};
  unsigned cycle = 0;
};

class InputPort final : public dds::SampleSink {
 public:
  /// `index` is the reader's place in the composition.
  InputPort(InputBase& input, const PortBinding& binding, ComponentInstance& owner, dds::Domain& domain,
            ClockMode clock, unsigned index);
  ~InputPort();

  const std::string& name() const { return input_.name(); }
  const TypeSupport& type() const { return input_.type(); }
  const PortBinding& binding() const { return binding_; }
  SampleCache& cache() { return cache_; }
  const SampleCache& cache() const { return cache_; }
  ComponentInstance& owner() { return owner_; }
  unsigned index() const { return index_; }  ///< of the reader, in the whole composition
  const dds::Reader& reader() const { return *reader_; }
  std::vector<dds::MatchedPeer> matched() const { return reader_->matched_writers(); }
  PortHealth& health() { return health_; }
  const PortHealth& health() const { return health_; }
  bool has_handler() const { return static_cast<bool>(input_.deliver_); }
  PortCounters counters() const;

  /// Moves what has arrived into the cache. Under lockstep in canonical order, stamped with the logical time.
  void stage(Time now);
  /// Hands every fresh sample to the handler; does nothing for a port without one.
  void deliver(Time now);
  /// Whether samples have arrived since the last stage(); clears the mark.
  bool take_ready() { return ready_.exchange(false, std::memory_order_acquire); }

  // Under lockstep in several containers.
  /// From now on counts what comes from this writer of another container. Returns its place, for expect().
  std::size_t count_writer(std::uint64_t handle, unsigned index);
  /// The writer had published `sent` samples up to the present cycle: those are staged next, and later ones wait.
  /// Unless all are here, `arrivals` waits for the last of them.
  void expect(std::size_t place, std::uint64_t sent, Countdown& arrivals);
  /// Those counted so far.
  std::vector<CountedWriters::Writer> counted_writers() const;

  // Used by InputBase.
  dds::SampleBlock* latest() const;
  std::vector<dds::SampleBlock*> take();
  std::vector<dds::SampleBlock*> instances() const;
  std::string missing() const;
  bool waiting() const;

  void on_sample(const dds::Arrival& arrival) noexcept override;
  void on_writer_gone(std::uint64_t writer) noexcept override;
  void on_writer_lost(std::uint64_t writer) noexcept override;
  void on_status() noexcept override;

 private:
  void count_gap(const dds::Arrival& arrival);
  void lock() const noexcept {
    while (spin_.test_and_set(std::memory_order_acquire)) {
    }
  }
  void unlock() const noexcept { spin_.clear(std::memory_order_release); }

  void mark_ready() noexcept;
  unsigned writer_of(const dds::Arrival& arrival) const;

  /// What has been received of one writer.
  struct Sequence {
    std::uint64_t writer;
    std::uint64_t last;
    Time since;  ///< when the first sample was received
  };

  InputBase& input_;
  PortBinding binding_;
  ComponentInstance& owner_;
  unsigned index_;
  ClockMode clock_;
  std::size_t inbox_limit_;
  SampleCache cache_;
  mutable std::atomic_flag spin_ = ATOMIC_FLAG_INIT;
  std::vector<dds::Arrival> inbox_;       ///< under spin_, from inbox_first_ on; its blocks are retained
  std::size_t inbox_first_ = 0;           ///< under spin_: what stood before it was dropped
  std::vector<std::uint64_t> gone_;       ///< under spin_: writers that left
  std::vector<std::uint64_t> lost_;       ///< under spin_: writers that were not alive for a lease
  std::vector<Sequence> sequences_;       ///< under spin_: by writer
  std::uint64_t gaps_ = 0;                ///< under spin_: samples that writers published and that never came
  std::uint64_t overflowed_ = 0;          ///< under spin_: dropped because the component did not run
  std::vector<dds::Arrival> arrived_;     ///< scratch of stage(), swapped with inbox_
  std::vector<dds::Arrival> early_;       ///< arrived from a container that is one cycle ahead; its blocks are retained
  CountedWriters counted_;                ///< under spin_; `allowed` and `staged` are the dispatching thread's
  Countdown* arrivals_ = nullptr;         ///< under spin_
  std::vector<StagedSample> staged_;      ///< scratch of stage()
  std::vector<dds::SampleBlock*> given_;  ///< taken by the component, kept alive until it takes again
  std::uint64_t late_ = 0;                ///< handled although older than the largest age
  Duration worst_latency_{};              ///< from receipt to handler
  std::atomic<bool> ready_{false};
  PortHealth health_;
  std::unique_ptr<dds::Reader> reader_;  ///< last: it calls into the members above

  friend class ComponentInstance;
};

class OutputPort final : public dds::StatusSink {
 public:
  OutputPort(OutputBase& output, const PortBinding& binding, ComponentInstance& owner, dds::Domain& domain,
             ClockMode clock, unsigned index);
  ~OutputPort();

  const std::string& name() const { return output_.name(); }
  const TypeSupport& type() const { return output_.type(); }
  const PortBinding& binding() const { return binding_; }
  ComponentInstance& owner() { return owner_; }
  unsigned index() const { return index_; }  ///< of the writer, in the whole composition
  const dds::Writer& writer() const { return writer_; }
  std::vector<dds::MatchedPeer> matched() const { return writer_.matched_readers(); }
  PortHealth& health() { return health_; }
  const PortHealth& health() const { return health_; }
  std::uint64_t published() const { return sequence_; }
  /// The chain over everything published so far; 0 while untraced.
  std::uint64_t trace() const { return trace_; }

  dds::SampleBlock* loan(bool cleared) { return writer_.loan(cleared); }
  enum class Operation { write, dispose, assertion };
  void publish(dds::SampleBlock* block, Operation operation);
  /// Under a logical clock, where DDS knows no lease, it travels as a repetition of the last sample.
  void assert_alive();
  /// Keyed topics: disposes of every living instance that this port has published, in the order of their keys.
  void dispose_all();
  /// The port takes up where an earlier one with the same index ended.
  void continue_trace(std::uint64_t sequence, std::uint64_t trace);

  void on_status() noexcept override;

 private:
  OutputBase& output_;
  PortBinding binding_;
  ComponentInstance& owner_;
  unsigned index_;
  bool traced_;
  std::uint64_t sequence_ = 0;
  std::uint64_t trace_ = 0;
  dds::SampleBlock* last_ = nullptr;  ///< published last, if an assertion has to repeat it
  bool keeps_last_;
  std::string key_;              ///< scratch of publish()
  std::set<std::string> alive_;  ///< keyed topics: keys of the instances that were published and not disposed of
  PortHealth health_;
  dds::Writer writer_;  ///< last: it calls into the members above
};

}  // namespace kervan::runtime
