/// What Cyclone and the data path have to say of a domain besides samples: log lines, and writers whose samples are no
/// message of the type they say. They are kept until somebody takes them, since nobody may be called where they arise.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace kervan::dds {

/// Of an endpoint or participant, as DDS prints it: in network byte order.
using Guid = std::array<std::uint8_t, 16>;

struct LogLine {
  bool error = false;  ///< otherwise it is a warning
  std::string text;
};

class Reports {
 public:
  /// From here on `wake` is called when there is something new, under Cyclone's locks: it may only mark and notify.
  void listen(std::function<void()> wake);
  /// From here on lines that nobody listens for go to the standard error stream; before, they are kept.
  void print_unheard();

  void add_line(LogLine line) noexcept;
  void add_undecodable(const Guid& writer) noexcept;

  std::vector<LogLine> take_lines();
  /// How many samples of each writer could not be decoded so far.
  std::map<Guid, std::uint64_t> undecodable() const;

 private:
  static constexpr std::size_t kMostLines = 200;  ///< what comes while so many wait is dropped

  mutable std::mutex mutex_;
  std::function<void()> wake_;
  bool print_ = false;
  std::vector<LogLine> lines_;
  std::map<Guid, std::uint64_t> undecodable_;
};

/// Makes Cyclone log into the reports of its domains, in the whole process and for good.
class CycloneLog {
 public:
  /// While it exists, what Cyclone logs about domain `id` goes to `reports`.
  CycloneLog(std::uint32_t id, Reports& reports);
  CycloneLog(const CycloneLog&) = delete;
  CycloneLog& operator=(const CycloneLog&) = delete;
  ~CycloneLog();

 private:
  std::uint32_t id_;
};

}  // namespace kervan::dds
