#include "deploy/lab/link/link_model.hpp"

#include <algorithm>
#include <utility>

#include "sim/random.hpp"

namespace kervan::link {
namespace {

double fraction(std::uint32_t word) { return static_cast<double>(word) * 0x1p-32; }

/// FNV-1a.
std::uint64_t hash_of(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

std::uint32_t low(std::uint64_t value) { return static_cast<std::uint32_t>(value); }
std::uint32_t high(std::uint64_t value) { return static_cast<std::uint32_t>(value >> 32); }

}  // namespace

/// The random numbers of one packet, in [0, 1) but for the bits to flip.
struct LinkModel::Draws {
  double loss, burst, loss_in_burst, duplicate, reorder;
  std::array<double, 2> delay, corrupt;
  std::array<std::uint32_t, 2> flip;
};

LinkModel::LinkModel(composition::LinkSettings settings, std::uint64_t seed, std::string_view name)
    : settings_(std::move(settings)) {
  const std::uint64_t hash = hash_of(name);
  const auto words = sim::philox4x32({low(hash), high(hash), 0, 0}, {low(seed), high(seed)});
  key_ = {words[0], words[1]};
  share_in_burst_ = settings_.burst_loss / settings_.loss_in_burst;
  end_burst_ = 1.0 / settings_.burst_length;
  if (share_in_burst_ > 0.0) begin_burst_ = end_burst_ * share_in_burst_ / (1.0 - share_in_burst_);
}

LinkModel::Draws LinkModel::draws_of(std::uint64_t packet) const {
  std::array<std::array<std::uint32_t, 4>, 3> words{};
  for (std::uint32_t i = 0; i < words.size(); ++i) words[i] = sim::philox4x32({i, 0, low(packet), high(packet)}, key_);
  const auto& [a, b, c] = words;
  return {fraction(a[0]),
          fraction(a[1]),
          fraction(a[2]),
          fraction(a[3]),
          fraction(b[0]),
          {fraction(b[1]), fraction(b[2])},
          {fraction(b[3]), fraction(c[0])},
          {c[1], c[2]}};
}

bool LinkModel::is_down(Duration now) const {
  return began_ && std::ranges::any_of(settings_.down, [&](const composition::Outage& outage) {
           return now - *began_ >= outage.from && now - *began_ < outage.until;
         });
}

/// Takes the chain's step of this packet. The first one finds it in its steady state.
bool LinkModel::in_burst(double draw) {
  const double stays = packets_ == 1 ? share_in_burst_ : bursting_ ? 1.0 - end_burst_ : begin_burst_;
  bursting_ = draw < stays;
  return bursting_;
}

/// When the packet has left; nothing if there is no room for it to wait.
std::optional<Duration> LinkModel::departure(std::size_t bytes, Duration now) {
  if (settings_.rate <= 0.0) return now;
  const auto time_for = [&](double size) { return from_seconds(size * 8.0 / settings_.rate); };
  free_ = std::max(free_, now);
  if (free_ - now > time_for(settings_.queue)) return std::nullopt;
  free_ += time_for(static_cast<double>(bytes));
  return free_;
}

Delivery LinkModel::delivery(Duration departure, double draw, bool skips_delay) {
  Delivery delivery{departure, std::nullopt};
  if (!skips_delay) delivery.at += settings_.delay + from_seconds((2.0 * draw - 1.0) * seconds(settings_.jitter));
  if (settings_.keep_order) delivery.at = std::max(delivery.at, latest_);
  if (delivery.at < latest_) ++counters_.reordered;
  latest_ = std::max(latest_, delivery.at);
  return delivery;
}

Decision LinkModel::decide(std::size_t bytes, Duration now) {
  const Draws draws = draws_of(packets_++);
  const auto happens = [](double draw, double percent) { return draw * 100.0 < percent; };
  Decision decision;
  const bool burst = in_burst(draws.burst);
  const auto left = is_down(now) ? std::nullopt : departure(bytes, now);
  if (is_down(now))
    decision.fate = Fate::down;
  else if (!left)
    decision.fate = Fate::queue_full;
  else if (happens(draws.loss, settings_.loss))
    decision.fate = Fate::lost;
  else if (burst && happens(draws.loss_in_burst, settings_.loss_in_burst))
    decision.fate = Fate::lost_in_burst;
  else {
    decision.copies = happens(draws.duplicate, settings_.duplicate) ? 2 : 1;
    for (std::size_t copy = 0; copy < decision.copies; ++copy) {
      Delivery& one = decision.deliveries[copy];
      one = delivery(*left, draws.delay[copy], happens(draws.reorder, settings_.reorder));
      if (happens(draws.corrupt[copy], settings_.corrupt)) one.flip = draws.flip[copy];
    }
  }
  count(bytes, now, decision);
  return decision;
}

void LinkModel::count(std::size_t bytes, Duration now, const Decision& decision) {
  ++counters_.packets;
  counters_.bytes += bytes;
  switch (decision.fate) {
    case Fate::delivered: break;
    case Fate::lost: ++counters_.lost; return;
    case Fate::lost_in_burst: ++counters_.lost_in_burst; return;
    case Fate::queue_full: ++counters_.queue_full; return;
    case Fate::down: ++counters_.down; return;
  }
  ++counters_.delivered;
  counters_.delivered_bytes += bytes;
  if (decision.copies > 1) ++counters_.duplicated;
  for (std::size_t copy = 0; copy < decision.copies; ++copy) {
    const Duration delay = decision.deliveries[copy].at - now;
    if (decision.deliveries[copy].flip) ++counters_.corrupted;
    if (delay > Duration::zero()) ++counters_.delayed;
    counters_.total_delay += delay;
    counters_.longest_delay = std::max(counters_.longest_delay, delay);
  }
}

}  // namespace kervan::link
