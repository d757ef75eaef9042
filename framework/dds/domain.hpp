/// A DDS domain of this process, with one participant and a configuration made here.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "framework/component/time.hpp"
#include "framework/dds/reports.hpp"
#include "framework/dds/type_support.hpp"

namespace kervan::dds {

/// DDS refused something. what() carries Cyclone's own words.
class DdsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct DomainConfig {
  std::uint32_t id = 0;
  bool network = true;                  ///< false: no sockets at all, the domain ends with this process
  std::string interface = "lo";         ///< name of the network interface; empty: the one with `address`
  std::string address = {};             ///< of the interface, if it has no name here
  std::string tag = {};                 ///< domains with different tags do not see each other
  std::vector<std::string> peers = {};  ///< addresses to look for, beside what multicast finds
  enum class Multicast { yes, discovery_only, no } multicast = Multicast::yes;
  int processes = 120;  ///< that can take part on one host; 120 is the most that the ports of DDS have room for
  /// The domain's number on the network when it is not `id`: several domains of one process meet there like processes.
  std::optional<std::uint32_t> external_id = {};
  /// How long the end of a writer may wait until its readers have everything. A reader that is dead takes it all.
  Duration linger = std::chrono::seconds(1);
  std::string user_data = {};  ///< what the participant says of itself to every peer; see participant_identity()
};

/// The configuration that Cyclone is given, as XML. Throws ConfigError for values that no network has.
std::string cyclone_configuration(const DomainConfig& config);

struct SampleType;

/// The first failure is fatal: after a failed domain a participant might come up on another interface, unasked.
class Domain {
 public:
  /// `time` stamps what arrives from other processes, in nanoseconds on the composition's clock; nullptr: the wall
  /// clock does. It must outlive the domain. Throws DdsError if the domain or its participant cannot be made.
  explicit Domain(const DomainConfig& config, const std::atomic<Time::rep>* time = nullptr);
  Domain(const Domain&) = delete;
  Domain& operator=(const Domain&) = delete;
  ~Domain();

  struct Topic {
    std::int32_t entity = 0;
    const SampleType* type = nullptr;
  };

  /// The topic called `name` ("/r1/scan", on the wire "rt/r1/scan"), made on first use. Throws DdsError when the name
  /// is in use with another type, or the type's name with another layout: Cyclone itself would accept both silently.
  Topic topic(const std::string& name, const TypeSupport& type);

  std::int32_t participant() const { return participant_; }

  /// What Cyclone logs about this domain, and whose samples could not be decoded.
  Reports& reports() { return reports_; }

 private:
  struct Known {
    Topic topic;
    const TypeSupport* type;
  };

  Reports reports_;
  CycloneLog log_;
  const std::atomic<Time::rep>* time_;
  std::int32_t domain_ = 0;
  std::int32_t participant_ = 0;
  std::mutex mutex_;
  std::map<std::string, Known> topics_;
  std::map<std::string, const TypeSupport*> types_;
};

}  // namespace kervan::dds
