/// `links:` of a composition: what the network between its hosts is like where it is emulated.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/component/parameters.hpp"
#include "framework/component/time.hpp"
#include "framework/config/node.hpp"

namespace kervan::composition {

/// A time during which nothing passes, counted from the moment when the run has begun.
struct Outage {
  Duration from{};
  Duration until{};  ///< later than `from`
};

/// One direction of a link. A packet waits in the sender's queue, takes its time at the link's rate, and is then lost,
/// or delivered after the delay. What the words mean exactly is said in deploy/lab/link/link_model.hpp.
struct LinkSettings {
  double loss = 0.0;             ///< %
  double burst_loss = 0.0;       ///< %
  double burst_length = 5.0;     ///< packets
  double loss_in_burst = 100.0;  ///< %
  Duration delay{};
  Duration jitter{};
  bool keep_order = false;
  double rate = 0.0;       ///< bit/s; 0: as fast as it goes
  double queue = 64e3;     ///< B
  double duplicate = 0.0;  ///< %
  double reorder = 0.0;    ///< %
  double corrupt = 0.0;    ///< %
  std::vector<Outage> down = {};

  /// All but `down`, which is a list of spans.
  template <class Visitor>
  void describe(Visitor& v) {
    const auto share = [&](double& field, const char* name, const char* help) {
      v(field, name, {.unit = "%", .min = 0.0, .max = 100.0, .help = help});
    };
    share(loss, "loss", "Packets lost, each for itself.");
    share(burst_loss, "burst_loss", "Packets lost in bursts, beside those.");
    v(burst_length, "burst_length", {.min = 1.0, .max = 1e6, .help = "Mean length of a burst, in packets."});
    v(loss_in_burst, "loss_in_burst",
      {.unit = "%", .min = 1.0, .max = 100.0, .help = "Packets lost while a burst lasts."});
    v(delay, "delay", {.min = 0.0, .max = 60.0, .help = "Time on the way."});
    v(jitter, "jitter", {.min = 0.0, .max = 60.0, .help = "Largest difference from the delay, either way."});
    v(keep_order, "keep_order", {.help = "No packet arrives before an earlier one."});
    v(rate, "rate", {.unit = "bit/s", .min = 0.0, .max = 1e11, .help = "Bits a second; 0: as many as there are."});
    v(queue, "queue",
      {.unit = "B", .min = 1514.0, .max = 1e9, .help = "What waits before a link with a rate; more is dropped."});
    share(duplicate, "duplicate", "Packets that arrive twice.");
    share(reorder, "reorder", "Packets that skip the delay, and so overtake others.");
    share(corrupt, "corrupt", "Packets with one bit flipped.");
  }
};

/// What cannot be, and the setting to blame; nothing if all is well.
std::optional<std::pair<std::string, std::string>> contradiction(const LinkSettings& settings);

/// A profile that ships with the program: ethernet, wifi, lossy.
struct LinkProfile {
  std::string name;
  LinkSettings settings;
};
const std::vector<LinkProfile>& shipped_link_profiles();

/// The settings of a shipped profile. Throws ConfigError at `name` if there is none.
const LinkSettings& link_profile(const config::Node& name);

/// Reads the settings that `node` gives over those of `base`; keys in `others` belong to the caller. Throws
/// ConfigError.
LinkSettings read_link_settings(const config::Node& node, LinkSettings base,
                                const std::vector<std::string>& others = {});

struct Link {
  std::string from, to;  ///< hosts
  LinkSettings settings;
  Location location = {};
};

struct Links {
  std::uint64_t seed = 1;
  LinkSettings others;      ///< of every direction that `links` does not hold
  std::vector<Link> links;  ///< each direction at most once

  const LinkSettings& between(const std::string& from, const std::string& to) const;
};

/// Links as they are without a `links:` block: Ethernet.
Links default_links();

/// `links:` as written. Throws ConfigError, also for a host that is not one of `hosts`.
Links read_links(const config::Node& node, const std::vector<std::string>& hosts);

}  // namespace kervan::composition
