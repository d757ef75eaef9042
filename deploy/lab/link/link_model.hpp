/// What becomes of each packet on one direction of a link: a plain value, which knows no network and no clock. The same
/// seed, name and sequence of packets (sizes and times) give the same fates; every packet has its own place in the
/// random numbers, so what is asked of one effect does not move the others.
///
/// A packet goes through these stages, in this order:
///   down      an outage of the schedule: dropped
///   queue     waits until the link is free; dropped if more than `queue` bytes would wait. Then it takes size / rate.
///   loss      dropped with the probability `loss`; or in a burst. Bursts are Gilbert and Elliott's chain of two states
///             (E. N. Gilbert, Capacity of a burst-noise channel, Bell System Technical Journal 39, 1960; E. O.
///             Elliott, 42, 1963), which takes a step a packet: `burst_length` is the mean stay in the bad state, where
///             `loss_in_burst` get lost, and `burst_loss` the share of all packets that do.
///   delay     uniform in delay ± jitter; with `reorder` a packet skips it
///   duplicate a second copy, with a delay of its own
///   corrupt   one bit of a copy is flipped
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "deploy/composition/links.hpp"

namespace kervan::link {

enum class Fate { delivered, lost, lost_in_burst, queue_full, down };

/// One copy of a packet that arrives.
struct Delivery {
  Duration at{};
  std::optional<std::uint32_t> flip;  ///< which bit is flipped: this number modulo how many there are
};

struct Decision {
  Fate fate = Fate::delivered;
  std::size_t copies = 0;  ///< how many of `deliveries` count
  std::array<Delivery, 2> deliveries = {};
};

/// What a link did so far. A packet that arrives twice was delivered once, and duplicated.
struct LinkCounters {
  std::uint64_t packets = 0, bytes = 0;  ///< that came
  std::uint64_t delivered = 0, delivered_bytes = 0;
  std::uint64_t lost = 0, lost_in_burst = 0, queue_full = 0, down = 0;
  std::uint64_t duplicated = 0, corrupted = 0;
  std::uint64_t reordered = 0;  ///< copies that arrive before one that was sent earlier
  std::uint64_t delayed = 0;    ///< copies that arrive later than they were sent
  Duration total_delay{}, longest_delay{};

  bool operator==(const LinkCounters&) const = default;
};

class LinkModel {
 public:
  /// `name` tells the numbers of one direction ("base>r1") from those of the others.
  LinkModel(composition::LinkSettings settings, std::uint64_t seed, std::string_view name);

  /// The schedule of outages begins now; before it there are none.
  void begin(Duration now) { began_ = now; }

  /// The fate of the next packet. `now` never goes back.
  Decision decide(std::size_t bytes, Duration now);

  const LinkCounters& counters() const { return counters_; }

 private:
  struct Draws;
  Draws draws_of(std::uint64_t packet) const;
  bool is_down(Duration now) const;
  bool in_burst(double draw);
  std::optional<Duration> departure(std::size_t bytes, Duration now);
  Delivery delivery(Duration departure, double draw, bool skips_delay);
  void count(std::size_t bytes, Duration now, const Decision& decision);

  composition::LinkSettings settings_;
  std::array<std::uint32_t, 2> key_{};
  double begin_burst_ = 0.0, end_burst_ = 0.0, share_in_burst_ = 0.0;  ///< probabilities
  std::optional<Duration> began_;
  std::uint64_t packets_ = 0;
  bool bursting_ = false;
  Duration free_{};  ///< when everything that waits will have left
  Duration latest_{};
  LinkCounters counters_;
};

}  // namespace kervan::link
