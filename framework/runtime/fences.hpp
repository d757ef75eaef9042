/// Keeps the containers of a lockstep run in step: after every cycle each sends a Fence and waits for those of all
/// others and for the samples they announce. All hold the same numbers then, so all decide the same and nobody
/// coordinates.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
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
  bool more = false;                  ///< something was published that an input of the composition hears
  Time next = Time::max();            ///< the earliest timer or deadline; only said if there is no more
  std::optional<StopWish> stop = {};  ///< only said if there is no more
  std::vector<unsigned> loop = {};    ///< after the last cycle that is allowed: components that go on and on
};

class Fences final : public dds::SampleSink {
 public:
  /// Makes the endpoints of the fence topic. Throws ConfigError if the container's spec cannot work, DdsError.
  explicit Fences(Container& container);
  ~Fences();

  /// Waits until every pair of endpoints of the composition is matched, seen from both sides; nothing may be published
  /// before. `end` is when the run ends at the latest: going in, for this container; coming out, for all. If the run
  /// cannot begin, says why. Waits no longer, here and later, when `control.stop` is set.
  std::optional<RunReport> join(const RunControl& control, Time& end);

  /// Whether the writers of this container have published anything since the last exchange() that an input hears.
  bool grew();
  /// Tells the others what is known here, and makes of it what is known everywhere. Every sample of the cycle is here
  /// then, and the inputs that handle them next are marked. False if a container is lost, or if this one or another was
  /// told to stop and waited in vain: from then on, this is over.
  bool exchange(Instant at, Round& round);
  /// From now on a stop that is wanted ends no waiting.
  void wait_whatever_happens() { stop_ = nullptr; }
  /// After the last cycle: tells everybody every trace. False if a container is lost.
  bool leave(Instant at);

  /// How this container ended apart from the others: which one was lost, or why it was not waited for, and where the
  /// run stood. Nothing as long as all are together.
  const std::optional<RunReport>& broken_off() const { return broken_off_; }
  /// By writer index, those of the writers elsewhere; after leave().
  const std::vector<std::pair<unsigned, std::uint64_t>>& traces() const { return traces_; }

  void on_sample(const dds::Arrival& arrival) noexcept override;
  void on_writer_gone(std::uint64_t writer) noexcept override;
  void on_status() noexcept override {}

 private:
  using Steady = std::chrono::steady_clock;

  /// After so long, and again after as long, whoever waits says for what.
  static constexpr Duration kPatience = std::chrono::seconds(5);

  struct Member {
    std::string name;
    bool there = false;                         ///< its fence endpoints and ours are matched
    std::uint64_t writer = 0;                   ///< under spin_: Cyclone's handle of its fence writer
    std::array<dds::SampleBlock*, 2> fences{};  ///< under spin_: it may be one cycle ahead, and no more
    unsigned count = 0;                         ///< under spin_: of `fences`
    bool awaited = false;                       ///< under spin_
    bool leaving = false;                       ///< under spin_: it has sent its last fence
  };
  struct HeardWriter {
    OutputPort* output;
    bool elsewhere;  ///< an input of another container hears it
    std::uint64_t sent = 0;
  };
  struct Hearer {
    InputPort* input;
    std::size_t place;  ///< of the writer among those it counts
  };

  void lock() const noexcept {
    while (spin_.test_and_set(std::memory_order_acquire)) {
    }
  }
  void unlock() const noexcept { spin_.clear(std::memory_order_release); }

  kervan_msgs::msg::Fence& own();
  void send(Instant at);
  bool receive(Instant at, Steady::time_point until = Steady::time_point::max());
  bool wait(Instant at, Steady::time_point until = Steady::time_point::max());
  void release_fences();
  void member_gone(unsigned member) noexcept;
  bool told_to_stop() const { return stop_ && stop_->load(std::memory_order_relaxed); }
  void break_off(Instant at, const std::string& missing);
  std::string still_missing() const;

  bool find_members();
  bool find_everybody();
  std::string not_found() const;
  void count_writers_elsewhere();
  std::uint64_t hash_of_run() const;

  void watch();

  Container& container_;
  unsigned self_ = 0;
  Matching matching_;
  std::shared_ptr<spdlog::logger> log_;
  std::vector<Member> members_;
  std::vector<HeardWriter> heard_;                      ///< writers of this container that an input hears
  std::vector<std::vector<Hearer>> hearers_;            ///< inputs of this container, by the writer elsewhere they hear
  std::vector<const kervan_msgs::msg::Fence*> fences_;  ///< of this round
  std::vector<dds::SampleBlock*> blocks_;               ///< that hold them
  std::vector<std::pair<unsigned, std::uint64_t>> traces_;
  std::optional<RunReport> broken_off_;
  const std::atomic<bool>* stop_ = nullptr;  ///< ends the waiting when set; may be null

  Countdown countdown_;
  mutable std::atomic_flag spin_ = ATOMIC_FLAG_INIT;
  std::atomic<int> gone_{-1};        ///< the first member that was lost, or that gave the others up
  std::string words_;                ///< under spin_: what another container said of it
  bool given_up_ = false;            ///< under spin_: it was told to stop, and waited in vain
  std::vector<std::uint64_t> left_;  ///< under spin_: writers that were gone before it was known whose they were

  std::atomic<Duration::rep> longest_handler_;
  std::atomic<std::uint64_t> progress_{0};  ///< counts beginnings and ends of waiting: odd while waiting
  std::mutex watch_mutex_;
  std::condition_variable watch_end_;
  bool watch_ended_ = false;  ///< under watch_mutex_
  std::thread watchdog_;

  std::unique_ptr<dds::Writer> writer_;
  dds::SampleBlock* own_ = nullptr;      ///< being filled
  std::unique_ptr<dds::Reader> reader_;  ///< last: it calls into the members above
};

}  // namespace kervan::runtime
