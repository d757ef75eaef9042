#include "deploy/lab/link/ethernet_switch.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace kervan::link {
namespace {

constexpr std::size_t kHeader = 14;  ///< two addresses and the type
/// Frames that may be on their way at a time; beyond them the emulator itself would be what a test measures.
constexpr std::size_t kMostFrames = 65536;
/// Frames read from one port before the others have their turn.
constexpr int kBatch = 32;

bool is_group(std::byte first) { return (first & std::byte{1}) != std::byte{0}; }

}  // namespace

MacAddress mac_of_port(std::size_t number) {
  // 02: an address that a local administrator gave.
  const std::size_t n = number + 1;
  return {0x02, 0x6b, 0x76, 0x6e, static_cast<std::uint8_t>(n >> 8), static_cast<std::uint8_t>(n)};
}

EthernetSwitch::EthernetSwitch(std::vector<SwitchPort> ports, const composition::Links& links)
    : ports_(std::move(ports)) {
  for (std::size_t from = 0; from < ports_.size(); ++from)
    for (std::size_t to = 0; to < ports_.size(); ++to) {
      if (from == to) continue;
      const std::string &a = ports_[from].name, &b = ports_[to].name;
      links_.push_back({from, to, LinkModel(links.between(a, b), links.seed, a + ">" + b), {}});
      links_.back().report.from = a;
      links_.back().report.to = b;
    }
}

Duration EthernetSwitch::now() { return std::chrono::steady_clock::now().time_since_epoch(); }

std::size_t EthernetSwitch::link_index(std::size_t from, std::size_t to) const {
  return from * (ports_.size() - 1) + to - (to > from ? 1 : 0);
}

void EthernetSwitch::begin() {
  const Duration time = now();
  for (Link& link : links_) link.model.begin(time);
}

void EthernetSwitch::put_off(const Frame& frame, std::size_t link, const Delivery& delivery) {
  if (free_frames_.empty() && frames_.size() < kMostFrames) {
    free_frames_.push_back(frames_.size());
    frames_.emplace_back();
  }
  if (free_frames_.empty()) {
    ++links_[link].report.overflowed;
    return;
  }
  const std::size_t slot = free_frames_.back();
  free_frames_.pop_back();
  Frame& kept = frames_[slot];
  std::copy_n(frame.bytes.begin(), frame.size, kept.bytes.begin());
  kept.size = frame.size;
  if (delivery.flip && frame.size > kHeader) {
    // Beyond the header: a frame with another address would be somebody else's.
    const std::size_t bit = *delivery.flip % ((frame.size - kHeader) * 8);
    kept.bytes[kHeader + bit / 8] ^= std::byte{1} << bit % 8;
  }
  pending_.push({delivery.at, order_++, slot, link});
}

void EthernetSwitch::send(const Frame& frame, Link& link, Duration now) {
  const Decision decision = link.model.decide(frame.size, now);
  for (std::size_t copy = 0; copy < decision.copies; ++copy) {
    const Delivery& delivery = decision.deliveries[copy];
    // What need not wait is not copied.
    if (delivery.at <= now && !delivery.flip)
      hand_over(frame, link, delivery.at);
    else
      put_off(frame, static_cast<std::size_t>(&link - links_.data()), delivery);
  }
}

void EthernetSwitch::receive(std::size_t port) {
  Frame frame;
  for (int i = 0; i < kBatch; ++i) {
    const ssize_t size = ::read(ports_[port].tap.number(), frame.bytes.data(), frame.bytes.size());
    if (size < 0 && errno == EINTR) continue;
    if (size < static_cast<ssize_t>(kHeader)) return;
    frame.size = static_cast<std::size_t>(size);
    const Duration time = now();
    const bool to_all = is_group(frame.bytes[0]);
    for (std::size_t to = 0; to < ports_.size(); ++to) {
      if (to == port) continue;
      const MacAddress mac = mac_of_port(to);
      const auto same = [](std::byte a, std::uint8_t b) { return a == std::byte{b}; };
      if (to_all || std::equal(mac.begin(), mac.end(), frame.bytes.begin(), [&](auto b, auto a) { return same(a, b); }))
        send(frame, links_[link_index(port, to)], time);
    }
  }
}

void EthernetSwitch::hand_over(const Frame& frame, Link& link, Duration at) {
  const ssize_t written = ::write(ports_[link.to].tap.number(), frame.bytes.data(), frame.size);
  if (written != static_cast<ssize_t>(frame.size)) {
    ++link.report.undeliverable;
    return;
  }
  const Duration lateness = std::max(Duration::zero(), now() - at);
  ++link.report.handed_over;
  link.report.total_lateness += lateness;
  link.report.greatest_lateness = std::max(link.report.greatest_lateness, lateness);
}

void EthernetSwitch::deliver_due() {
  while (!pending_.empty() && pending_.top().at <= now()) {
    const Pending due = pending_.top();
    pending_.pop();
    hand_over(frames_[due.frame], links_[due.link], due.at);
    free_frames_.push_back(due.frame);
  }
}

/// False: it is time to end.
bool EthernetSwitch::obey(int control) {
  char word = 'q';
  const ssize_t size = ::read(control, &word, 1);
  if (size < 0) return errno == EINTR || errno == EAGAIN;
  if (size == 1 && word == 'b') begin();
  return size == 1 && word != 'q';
}

void EthernetSwitch::run(int control, Duration limit) {
  // The kernel would otherwise wake us up to 50 us late, to save power.
  ::prctl(PR_SET_TIMERSLACK, 1UL);
  const Duration end = limit == forever ? forever : now() + limit;
  std::vector<pollfd> watched = {{control, POLLIN, 0}};
  for (const SwitchPort& port : ports_) watched.push_back({port.tap.number(), POLLIN, 0});
  for (;;) {
    deliver_due();
    const Duration time = now();
    if (time >= end) return;
    const Duration next = std::min(end, pending_.empty() ? forever : pending_.top().at);
    const Duration wait = next == forever ? forever : std::max(Duration::zero(), next - time);
    const timespec timeout{wait.count() / 1'000'000'000, wait.count() % 1'000'000'000};
    const int ready = ::ppoll(watched.data(), watched.size(), next == forever ? nullptr : &timeout, nullptr);
    if (ready < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "cannot wait for packets");
    if (ready <= 0) continue;
    if (watched[0].revents != 0 && !obey(control)) return;
    for (std::size_t port = 0; port < ports_.size(); ++port)
      if ((watched[port + 1].revents & POLLIN) != 0)
        receive(port);
      else if (watched[port + 1].revents != 0)
        watched[port + 1].fd = -1;  // somebody took the interface away
  }
}

std::vector<LinkReport> EthernetSwitch::reports() const {
  std::vector<LinkReport> reports;
  for (const Link& link : links_) {
    reports.push_back(link.report);
    reports.back().counters = link.model.counters();
  }
  return reports;
}

}  // namespace kervan::link
