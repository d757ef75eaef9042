#include "framework/dds/reports.hpp"

#include <dds/ddsrt/log.h>

#include <cstdio>
#include <cstring>
#include <utility>

namespace kervan::dds {

namespace {

/// The reports of each domain of the process, by its number.
struct Sinks {
  std::mutex mutex;
  std::map<std::uint32_t, Reports*> by_domain;
};

Sinks& sinks() {
  static Sinks* const all = new Sinks;  // Cyclone's threads may log until the very end of the process
  return *all;
}

void print(const LogLine& line) { std::fprintf(stderr, "Cyclone DDS: %s\n", line.text.c_str()); }

void take_line(void*, const dds_log_data_t* data) {
  if (!(data->priority & (DDS_LC_ERROR | DDS_LC_FATAL | DDS_LC_WARNING))) return;
  LogLine line;
  line.error = (data->priority & (DDS_LC_ERROR | DDS_LC_FATAL)) != 0;
  line.text.assign(data->message, data->size ? data->size : std::strlen(data->message));
  while (!line.text.empty() && (line.text.back() == '\n' || line.text.back() == '\0')) line.text.pop_back();
  const std::lock_guard lock(sinks().mutex);
  // Before a domain has its number, and beside all domains, it logs under none.
  const auto found = sinks().by_domain.find(data->domid);
  for (const auto& [id, reports] : sinks().by_domain)
    if (found == sinks().by_domain.end() || id == found->first) reports->add_line(line);
  if (sinks().by_domain.empty()) print(line);
}

}  // namespace

void Reports::listen(std::function<void()> wake) {
  const std::lock_guard lock(mutex_);
  wake_ = std::move(wake);
  if (wake_ && !lines_.empty()) wake_();
}

void Reports::print_unheard() {
  const std::lock_guard lock(mutex_);
  print_ = true;
}

void Reports::add_line(LogLine line) noexcept {
  const std::lock_guard lock(mutex_);
  if (print_ && !wake_) {
    print(line);
    return;
  }
  if (lines_.size() < kMostLines) lines_.push_back(std::move(line));
  if (wake_) wake_();
}

void Reports::add_undecodable(const Guid& writer) noexcept {
  const std::lock_guard lock(mutex_);
  ++undecodable_[writer];
  if (wake_) wake_();
}

std::vector<LogLine> Reports::take_lines() {
  const std::lock_guard lock(mutex_);
  return std::exchange(lines_, {});
}

std::map<Guid, std::uint64_t> Reports::undecodable() const {
  const std::lock_guard lock(mutex_);
  return undecodable_;
}

CycloneLog::CycloneLog(std::uint32_t id, Reports& reports) : id_(id) {
  const std::lock_guard lock(sinks().mutex);
  if (sinks().by_domain.empty()) dds_set_log_sink(take_line, nullptr);
  sinks().by_domain[id] = &reports;
}

CycloneLog::~CycloneLog() {
  const std::lock_guard lock(sinks().mutex);
  sinks().by_domain.erase(id_);
}

}  // namespace kervan::dds
