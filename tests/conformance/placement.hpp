/// The same four components, two that write a topic and two that read it, in every placement that the suite compares. A
/// case tells them what to do and looks at what has come; it does not know where they run.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/component/qos.hpp"
#include "framework/runtime/sample_cache.hpp"

namespace kervan::test {

enum class Where { same_thread, two_threads, two_domains, two_processes, lockstep };

/// The quality of service that a case is about.
struct CaseQos {
  QosProfile profile;                            ///< of both writers and of the reader "other"
  std::vector<std::string> sink_partition = {};  ///< of the reader "sink", where it is another
};
/// By the case's name, so that another process knows it too.
CaseQos qos_of(const std::string& name);

/// A sample that a reader took.
struct Got {
  std::string key;
  int number = 0;
  std::size_t bytes = 0;  ///< of its load, if that is what it should be
  bool disposed = false;

  bool operator==(const Got&) const = default;
};

/// Writers are called "strong" and "weak", readers "sink" and "other"; all share one topic. A reader's samples wait in
/// its port until it is told to take them.
class Placement {
 public:
  /// Everything is matched and runs.
  Placement(Where where, const std::string& name);
  ~Placement();
  Placement(const Placement&) = delete;
  Placement& operator=(const Placement&) = delete;

  /// `count` samples with the numbers from `number` on, each with a load of `bytes`.
  void publish(const std::string& writer, const std::string& key, int number, int count = 1, std::size_t bytes = 0);
  void dispose(const std::string& writer, const std::string& key);

  std::vector<Got> take(const std::string& reader);
  runtime::PortCounters counters(const std::string& reader) const;
  /// Keys of the instances that live, in the order of their appearance.
  std::vector<std::string> living(const std::string& reader) const;
  /// What a reader gets that is only made now, as soon as it has `count` samples.
  std::vector<Got> late_joiner_takes(std::size_t count);

  /// Lets time go on until it is so; false if it has not become so with all patience.
  bool eventually(const std::function<bool()>& condition);
  /// Lets this time pass on the composition's clock.
  void pass(Duration duration);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The process that the writers run in: does what its standard input says until that is closed. Its exit code.
int run_placement_peer(const std::string& name, std::uint32_t domain, const std::string& tag);

}  // namespace kervan::test
