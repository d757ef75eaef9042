/// Quality of service: a topic has one effective profile, used by its writers and readers alike; a port adds what it
/// requires of it. Profiles are named in compositions, where every value can be overridden.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/component/time.hpp"

namespace kervan {

enum class Reliability { best_effort, reliable };
enum class Durability { volatile_, transient_local };
enum class Ownership { shared, exclusive };

/// When a writer counts as alive: `automatic`, as long as its process is; `manual`, as long as it publishes, or says so
/// with Output::assert_alive(), at least once in every lease.
enum class Liveliness { automatic, manual };

/// `sync` sends to the network before local readers get the sample, as DDS does by default; `async` leaves sending to
/// Cyclone's own thread (a latency budget that a ROS 2 reader would refuse, so it is for Kervan's own types).
enum class Network { sync, async };

/// What "keep all" keeps of each instance while nobody takes its samples: without a bound memory would run out.
inline constexpr int kMostKept = 10'000;

/// The quality of service of one topic. History, limit, lifespan, deadline, ownership and a manual lease are applied by
/// the port's sample cache on the composition's clock, so they mean the same in one container and across a network.
/// Samples are ordered by writer, then by sequence: the cache fixes that, so there is no destination order to choose.
struct QosProfile {
  std::string name = "state";
  Reliability reliability = Reliability::reliable;
  Durability durability = Durability::volatile_;
  int depth = 1;  ///< samples kept per instance; 0 keeps all
  int limit = 0;  ///< samples that may wait in one input, of all instances; newer ones are refused; 0: none
  Duration deadline = forever;  ///< longest time between two samples of an instance
  Duration lifespan = forever;  ///< a sample older than this is not handed out
  Liveliness liveliness = Liveliness::automatic;
  Duration lease = forever;  ///< a writer that was not alive for so long is lost; manual needs one
  Ownership ownership = Ownership::shared;
  std::vector<std::string> partition = {};  ///< names; endpoints meet if one name fits; empty: those without any
  Network network = Network::sync;
  bool trace = true;  ///< whether its samples enter the trace hash of a lockstep run

  bool operator==(const QosProfile&) const = default;
};

/// sensor, state, command, latched, event: the profiles every composition knows.
const std::vector<QosProfile>& builtin_profiles();

/// One of the built-in profiles, or nothing.
std::optional<QosProfile> builtin_profile(std::string_view name);

std::string_view to_text(Reliability reliability);
std::string_view to_text(Durability durability);
std::string_view to_text(Ownership ownership);
std::string_view to_text(Network network);
std::string_view to_text(Liveliness liveliness);

/// "400 ms", "1.5 s", "none" for forever.
std::string duration_text(Duration duration);

/// "[r1, r2]", "none" for an empty list.
std::string partition_text(const std::vector<std::string>& names);

/// What a port declares: the profile its topic has unless the composition says otherwise, and what it requires of it.
class PortQos {
 public:
  constexpr explicit PortQos(const char* profile) : profile_(profile) {}

  /// Input only: a sample older than `age` counts as missing.
  constexpr PortQos max_age(Duration age) const { return with(&PortQos::max_age_, age); }
  /// The topic's deadline must be this or shorter.
  constexpr PortQos deadline(Duration period) const { return with(&PortQos::deadline_, period); }
  /// The lease of the topic's writers must be this or shorter, so that a lost one is noticed within it.
  constexpr PortQos lease(Duration time) const { return with(&PortQos::lease_, time); }
  /// Input only: losing a sample is not acceptable. Without it a best-effort topic under a reliable profile is a
  /// warning.
  constexpr PortQos lossless() const { return with(&PortQos::lossless_, true); }
  /// Input only: samples from before it started are needed. The profile `latched` implies it.
  constexpr PortQos from_before() const { return with(&PortQos::from_before_, true); }
  /// Input only: the composition may leave it without a writer.
  constexpr PortQos optional() const { return with(&PortQos::optional_, true); }
  /// Output only: strength under exclusive ownership.
  constexpr PortQos strength(int value) const { return with(&PortQos::strength_, value); }
  /// The port's samples stay out of the trace hash: they carry latencies or names of containers.
  constexpr PortQos untraced() const { return with(&PortQos::traced_, false); }

  constexpr const char* profile() const { return profile_; }
  constexpr Duration max_age() const { return max_age_; }
  constexpr Duration deadline() const { return deadline_; }
  constexpr Duration lease() const { return lease_; }
  constexpr bool is_lossless() const { return lossless_; }
  constexpr bool is_from_before() const { return from_before_; }
  constexpr bool is_optional() const { return optional_; }
  constexpr int strength() const { return strength_; }
  constexpr bool traced() const { return traced_; }

 private:
  template <class V>
  constexpr PortQos with(V PortQos::*field, V value) const {
    PortQos copy = *this;
    copy.*field = value;
    return copy;
  }

  const char* profile_;
  Duration max_age_ = forever;
  Duration deadline_ = forever;
  Duration lease_ = forever;
  bool lossless_ = false;
  bool from_before_ = false;
  bool optional_ = false;
  int strength_ = 0;
  bool traced_ = true;
};

namespace qos {
/// Best effort, the newest sample only, deadline 1 s: measurements that are soon followed by the next.
inline constexpr PortQos sensor{"sensor"};
/// Reliable, the newest sample only: the state of something.
inline constexpr PortQos state{"state"};
/// Reliable, the newest sample only, lifespan and deadline 250 ms: commands that must not be obeyed late.
inline constexpr PortQos command{"command"};
/// Reliable, transient local, the newest sample only: a late joiner gets it too.
inline constexpr PortQos latched{"latched"};
/// Reliable, the last 100 samples: every single one matters.
inline constexpr PortQos event{"event"};
}  // namespace qos

}  // namespace kervan
