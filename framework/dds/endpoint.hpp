/// DDS readers and writers as Kervan uses them: samples arrive by a call into our own reader cache, leave as blocks.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/component/qos.hpp"
#include "framework/dds/domain.hpp"

namespace kervan::dds {

struct SampleBlock;

/// How much of a profile Cyclone is asked for; the port's sample cache applies the rest on the composition's clock.
enum class CyclonePart {
  whole_profile,  ///< clock wall: Cyclone's own time is the composition's
  untimed,        ///< clock sim: reliability, history and durability; nothing that has to do with time, no ownership
  carrier,        ///< clock lockstep: reliable, everything kept, and durability
};

/// One event of an endpoint, as a value.
struct EndpointStatus {
  std::uint32_t matched = 0;  ///< peers matched now
  std::uint32_t matched_ever = 0;
  std::uint32_t incompatible = 0;          ///< peers refused for their QoS, so far
  std::uint32_t last_incompatible_id = 0;  ///< DDS policy id of the last refusal
};

/// The index of an endpoint that has no place in a composition: the framework's own, and a test's.
inline constexpr unsigned kInternal = ~0u;

/// What one of our endpoints says of itself to every peer. Writers are counted through a composition, and so are
/// readers.
struct EndpointIdentity {
  unsigned index = kInternal;     ///< its place among the composition's writers, or among its readers
  std::uint64_t layout_hash = 0;  ///< of its type

  bool operator==(const EndpointIdentity&) const = default;
};

/// Reads what an endpoint's user data says; nothing if it is none of ours.
std::optional<EndpointIdentity> parse_identity(std::string_view user_data);

/// A peer that an endpoint is matched with now, in this process or elsewhere.
struct MatchedPeer {
  std::uint64_t handle = 0;                  ///< Cyclone's instance handle; of a writer as in Arrival::writer
  std::optional<EndpointIdentity> identity;  ///< nothing if it is none of ours
};

/// What travels with a block from its writer to a reader of it.
struct Arrival {
  SampleBlock* block;      ///< not retained; retain it to keep it
  std::uint64_t writer;    ///< Cyclone's instance handle of the writer
  std::uint64_t instance;  ///< the same for equal keys, in every process and run; 0 for keyless types
  std::int32_t strength;   ///< the writer's ownership strength
  std::uint64_t sequence;  ///< number of the sample among its writer's, without gaps where it is published; 0: unknown
};

/// Told under Cyclone's locks, in whatever thread. It may only store and mark: no call back into DDS, no user code.
class StatusSink {
 public:
  /// Another peer is matched, one is so no longer, or one was refused.
  virtual void on_status() noexcept = 0;

 protected:
  ~StatusSink() = default;
};

/// Receives samples, in the thread that published or that received from the network; under the same rules.
class SampleSink : public StatusSink {
 public:
  virtual void on_sample(const Arrival& arrival) noexcept = 0;
  /// The writer is gone or no longer alive.
  virtual void on_writer_gone(std::uint64_t writer) noexcept = 0;
  /// The writer was not alive for a whole lease; on_writer_gone() was called before.
  virtual void on_writer_lost(std::uint64_t writer) noexcept { (void)writer; }
  /// A writer is alive, for the first time or again.
  virtual void on_writer_alive(std::uint64_t writer) noexcept { (void)writer; }

 protected:
  ~SampleSink() = default;
};

class Reader {
 public:
  /// `sink` must outlive the reader. `index` is the reader's place in the composition, the same everywhere. Throws
  /// DdsError.
  Reader(Domain& domain, const std::string& topic, const TypeSupport& type, const QosProfile& profile, CyclonePart part,
         SampleSink& sink, unsigned index = kInternal);
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  /// After this no call into the sink is under way or will come.
  ~Reader();

  /// Cyclone's instance handle, as Discovery gives it.
  std::uint64_t handle() const { return handle_; }
  EndpointStatus status() const;

  /// Who a writer is that is matched now; nothing if it is not, or none of ours. Not from a SampleSink's call.
  std::optional<EndpointIdentity> matched_writer(std::uint64_t handle) const;
  /// All writers that are matched now. Not from a SampleSink's call.
  std::vector<MatchedPeer> matched_writers() const;

 private:
  std::int32_t entity_ = 0;
  std::uint64_t handle_ = 0;
};

class Writer {
 public:
  /// `index` is the writer's place in the composition, the same everywhere; `sink`, if any, must outlive the writer.
  /// Throws DdsError.
  Writer(Domain& domain, const std::string& topic, const TypeSupport& type, const QosProfile& profile, CyclonePart part,
         int strength, unsigned index, StatusSink* sink = nullptr);
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer();

  /// A block to fill; `cleared`: its value is default-initialised, keeping the memory it owns.
  SampleBlock* loan(bool cleared);

  /// Publishes the block, which must be this writer's loan, and gives it up. Throws DdsError if Cyclone refuses it.
  void publish(SampleBlock* block, Time now, bool dispose);

  /// Says to DDS that the writer is alive, without publishing anything.
  void assert_alive();
  /// Publishes the block as an assertion, for carriers, of which DDS does not watch the liveliness.
  void publish_assertion(SampleBlock* block, Time now);

  /// Cyclone's instance handle, as readers see it in Arrival::writer.
  std::uint64_t handle() const { return handle_; }
  EndpointStatus status() const;
  /// All readers that are matched now. Not from a SampleSink's call.
  std::vector<MatchedPeer> matched_readers() const;

  /// Waits until every reliable reader has what was published; false if that takes longer than `patience`.
  bool wait_for_acknowledgement(Duration patience) const;

 private:
  void send(SampleBlock* block, Time now, std::int64_t timestamp, std::uint32_t status);

  Domain::Topic topic_;
  std::int32_t entity_ = 0;
  std::uint64_t handle_ = 0;
  std::uint64_t sequence_ = 0;  ///< of the sample published last
};

}  // namespace kervan::dds
