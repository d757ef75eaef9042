/// Keeps the containers of a lockstep run in step: after every cycle each sends a Fence and waits for those of all others
/// and for the samples they announce. All hold the same numbers then, so all decide the same and nobody coordinates.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "framework/runtime/container.hpp"
#include "framework/runtime/countdown.hpp"
#include "framework/runtime/matching.hpp"

namespace kervan_msgs::msg {
struct Fence;
}

namespace kervan::runtime {

/// Why a run should end at the present time.
struct StopWish {
  RunEnd end = RunEnd::finished;  ///< finished or interrupted
  unsigned component = 0;         ///< finished: which one wants it
  std::string reason;
};

/// What is known after a cycle: first of one container, then of all.
struct Round {
  bool more = false;          ///< something was published that an input of the composition hears
  Time next = Time::max();    ///< the earliest timer or deadline; only said if there is no more
  std::optional<StopWish> stop = {};  ///< only said if there is no more
  std::vector<unsigned> ran = {};     ///< after the last cycle that is allowed: the components of the loop
};

class Fences final : public dds::SampleSink {
 public:
  /// The endpoints of the fence topic. Throws ConfigError if the container's spec cannot work, DdsError.
  explicit Fences(Container& container);
  ~Fences();

  /// Waits until every pair of endpoints of the composition is matched, seen from both sides. Nothing may be published
  /// before. `end` is when the run ends at the latest: in, by this container; out, by any. Says how it ended if it did.
  std::optional<RunReport> join(const RunControl& control, Time& end);

  /// Whether this container's writers have published anything that an input of the composition hears, since the last
  /// exchange().
  bool grew();
  /// Tells the others what is known here, and makes it what is known everywhere. Every sample of the cycle is here then,
  /// and the inputs that are to handle them are marked. False if a member is lost: from then on this container is alone.
  bool exchange(Instant at, Round& round);
  /// After the last cycle: everybody gets to know every trace. False if a member is lost.
  bool leave(Instant at);

  /// Which container was lost, where; empty as long as none is.
  const std::string& lost() const { return lost_reason_; }
  /// The traces of the writers elsewhere, after leave().
  const std::vector<std::pair<unsigned, std::uint64_t>>& traces() const { return traces_; }

  void on_sample(const dds::Arrival& arrival) noexcept override;
  void on_writer_gone(std::uint64_t writer) noexcept override;
  void on_status() noexcept override {}

 private:
  struct Member;
  struct HeardWriter;
  struct Hearer;

  bool is_self(unsigned member) const { return member == self_; }
  kervan_msgs::msg::Fence& begin(Instant at);
  void send();
  bool receive(Instant at);
  bool wait(Instant at);
  void give_up(Instant at);
  void diagnose(Instant at);
  bool matched();
  std::string missing() const;
  void prepare();
  void watch();
  void stop_watching();
  void member_gone(unsigned member) noexcept;

  Container& container_;
  unsigned self_ = 0;
  Matching matching_;
  std::shared_ptr<spdlog::logger> log_;
  std::vector<Member> members_;
  std::vector<HeardWriter> heard_writers_;     ///< of this container, those that any input of the composition hears
  std::vector<std::vector<Hearer>> hearers_;  ///< inputs of this container, by the writer elsewhere that they hear
  std::vector<dds::SampleBlock*> fences_;      ///< scratch: those of this round
  std::vector<std::pair<unsigned, std::uint64_t>> traces_;
  dds::SampleBlock* own_ = nullptr;  ///< the fence being filled

  Countdown countdown_;
  mutable std::atomic_flag spin_ = ATOMIC_FLAG_INIT;  ///< guards the members' fences
  std::atomic<int> gone_{-1};                         ///< the first member that was lost
  std::string relayed_;                               ///< under spin_: another container's words about a lost member
  std::string lost_reason_;

  std::atomic<std::uint64_t> progress_{0};  ///< odd while waiting
  std::atomic<bool> diagnosis_wanted_{false};
  std::mutex watch_mutex_;
  std::condition_variable watch_end_;
  bool watch_ended_ = false;  ///< under watch_mutex_
  std::thread watchdog_;

  std::unique_ptr<dds::Writer> writer_;
  std::unique_ptr<dds::Reader> reader_;  ///< last: it calls into the members above
};

}  // namespace kervan::runtime
