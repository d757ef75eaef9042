// How the containers of a lockstep run find each other, before the first cycle.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <thread>

#include "framework/dds/hash.hpp"
#include "framework/runtime/fences.hpp"
#include "framework/runtime/members.hpp"
#include "kervan_msgs/msg/Fence.hpp"

namespace kervan::runtime {

namespace {

using namespace std::chrono_literals;
using kervan_msgs::msg::Fence;

/// Matching takes some milliseconds, once in a run, and is asked about so often.
constexpr Duration kMatchingPeriod = 2ms;
constexpr std::size_t kPairsNamed = 3;

RunReport cannot_begin(std::string reason) {
  return {.end = RunEnd::peer_lost, .reason = std::move(reason), .broken_off = true};
}

std::string pair_text(const Matching& matching, const Matching::Pair& pair) {
  return matching.writers()[pair.writer].name + " -> " + matching.readers()[pair.reader].name;
}

}  // namespace

bool Fences::find_members() {
  std::vector<bool> hears_us(members_.size(), false);
  for (const dds::MatchedPeer& reader : writer_->matched_readers())
    if (reader.identity && reader.identity->index < members_.size()) hears_us[reader.identity->index] = true;
  bool complete = true;
  std::vector<std::uint64_t> lost;
  for (const dds::MatchedPeer& writer : reader_->matched_writers()) {
    if (!writer.identity || writer.identity->index >= members_.size()) continue;
    const unsigned index = writer.identity->index;
    if (!hears_us[index] || members_[index].there) continue;
    members_[index].there = true;
    lock();
    members_[index].writer = writer.handle;
    const bool left = std::ranges::count(left_, writer.handle) > 0;
    unlock();
    if (left) member_gone(index);
  }
  for (const Member& member : members_) complete = complete && member.there;
  return complete;
}

bool Fences::find_everybody() { return find_members() && matching_.complete(); }

std::string Fences::not_found() const {
  std::string text;
  for (const Member& member : members_)
    if (!member.there) text += (text.empty() ? "container " : ", ") + member.name;
  if (!text.empty()) return text;
  std::size_t missing = 0;
  for (const Matching::Pair& pair : matching_.pairs())
    if (!pair.matched && ++missing <= kPairsNamed)
      text += (missing == 1 ? "these to find each other: " : ", ") + pair_text(matching_, pair) + " (" +
              matching_.other_container(pair) + ")";
  if (missing > kPairsNamed) text += " and " + std::to_string(missing - kPairsNamed) + " more";
  return text;
}

/// Everything that must be the same in all containers of a run.
std::uint64_t Fences::hash_of_run() const {
  Hash64 hash;
  hash.number(composition_hash(container_.spec()));
  for (const Member& member : members_) hash.text(member.name);
  for (const ComponentSpec& component : container_.spec().components)
    if (!component.container.empty()) hash.text(component.container);  // else it is this container's own addition
  return hash.value();
}

void Fences::count_writers_elsewhere() {
  for (const CompositionEndpoint& reader : matching_.readers()) {
    if (!reader.input) continue;
    for (const dds::MatchedPeer& peer : reader.input->reader().matched_writers()) {
      if (!peer.identity || peer.identity->index >= hearers_.size()) continue;
      const CompositionEndpoint& writer = matching_.writers()[peer.identity->index];
      if (writer.output || writer.topic != reader.topic) continue;
      const std::size_t place = reader.input->count_writer(peer.handle, peer.identity->index);
      hearers_[peer.identity->index].push_back({reader.input, place});
    }
  }
}

std::optional<RunReport> Fences::join(const RunControl& control, Time& end) {
  stop_ = control.stop;
  longest_handler_ = control.longest_handler.count();
  const Steady::time_point began = Steady::now(), latest = began + control.members_within;
  const std::string within =
      " within " + std::to_string(std::chrono::ceil<std::chrono::seconds>(control.members_within).count()) + " s";
  const Instant start{Time(Duration(-1)), 0};

  Steady::time_point words_at = began + kPatience;
  while (!find_everybody()) {
    for (const Matching::Pair& pair : matching_.pairs())
      if (pair.another_layout)
        return cannot_begin(pair_text(matching_, pair) + ": container " + matching_.other_container(pair) +
                            " was built with another version of the message");
    if (told_to_stop() || gone_.load() >= 0) {
      break_off(start, not_found());
      return broken_off_;
    }
    if (Steady::now() >= latest) return cannot_begin("waited in vain for " + not_found() + within);
    if (Steady::now() >= words_at) {
      log_->warn("waiting for {}", not_found());
      words_at += kPatience;
    }
    std::this_thread::sleep_for(kMatchingPeriod);
  }
  count_writers_elsewhere();

  Fence& fence = own();
  fence.next = end.time_since_epoch().count();
  fence.run = hash_of_run();
  send(start);
  if (!receive(start, latest))
    return broken_off_ ? broken_off_ : cannot_begin("waited in vain for " + still_missing() + within);
  for (const Fence* other : fences_) {
    end = std::min(end, Time(Duration(other->next)));
    if (other->run == hash_of_run()) continue;
    return cannot_begin("container " + members_[other->container].name +
                        " runs another composition, or places it differently");
  }
  return std::nullopt;
}

}  // namespace kervan::runtime
