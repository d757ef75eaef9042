/// Tests a component by itself: feed its inputs, advance logical time, read its outputs and its state. It runs in
/// lockstep in a domain without a network, so nothing sleeps, nothing is flaky, and the same test always does the same.
///
///   kervan::test::Harness harness("control/potential_field", {{"law", "potential_gecui"}});
///   harness.feed("odom", odometry);
///   harness.advance(100ms);
///   EXPECT_GT(harness.latest<geometry_msgs::msg::TwistStamped>("cmd_vel_raw")->twist.linear.x, 0.0);
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "framework/component/component.hpp"
#include "framework/component/sample.hpp"
#include "framework/component/value.hpp"

namespace kervan::test {

class Harness {
 public:
  /// The component type called `type`, found as a container finds it (see ComponentRegistry). Parameters are in SI
  /// units: {{"period", 0.1}}. Throws what the component's constructor throws, std::invalid_argument for an unknown
  /// type. `run_folder` is where it keeps files; empty: nowhere.
  explicit Harness(const std::string& type, const ValueMap& parameters = {},
                   const std::filesystem::path& run_folder = {});

  /// A component of the test program itself; see define().
  explicit Harness(const ComponentClass& type, const ValueMap& parameters = {});

  Harness(const Harness&) = delete;
  Harness& operator=(const Harness&) = delete;
  ~Harness();

  /// Publishes a message on the topic of an input, now; it is handled by the next advance().
  /// Throws std::invalid_argument if there is no such input or it takes another type.
  template <class T>
  void feed(const std::string& input, const T& message) {
    feed(input, shared_type_support<T>(), &message);
  }

  /// Changes live parameters, as a request to its container does. Throws std::invalid_argument with the reason of a
  /// refusal.
  void change_parameters(const ValueMap& changes);

  /// Asks the component what it declares as a request, as a request to its container does. Returns its answer; throws
  /// std::invalid_argument with the reason of a refusal.
  std::string call(const std::string& request, const ValueMap& arguments = {});

  /// Handles everything at the present time, then every timer and sample up to `duration` later.
  void advance(Duration duration);

  /// The newest message an output published; nullptr if it has published nothing yet.
  template <class T>
  const T* latest(const std::string& output) const {
    return static_cast<const T*>(latest(output, shared_type_support<T>()));
  }

  /// All messages an output published since the last call.
  template <class T>
  std::vector<Sample<T>> take(const std::string& output) {
    std::vector<Sample<T>> samples;
    for (dds::SampleBlock* block : take(output, shared_type_support<T>())) {
      samples.emplace_back(block);
      dds::release(block);
    }
    return samples;
  }

  Time now() const;
  ComponentState state() const;
  const std::string& reason() const;  ///< why, when degraded or failed
  bool finished() const;              ///< the component has ended the run with finish()
  std::uint64_t trace_hash() const;

  /// Ends the run as a container does: last words, then shutdown. The destructor does it if the test does not.
  void end();

 private:
  struct Impl;

  void feed(const std::string& input, const TypeSupport& type, const void* message);
  const void* latest(const std::string& output, const TypeSupport& type) const;
  std::vector<dds::SampleBlock*> take(const std::string& output, const TypeSupport& type);

  std::unique_ptr<Impl> impl_;
};

/// Makes a component type of a class of the test program.
template <class C>
ComponentClass define(const char* type) {
  return {type, "defined by a test", []() -> std::unique_ptr<Component> { return std::make_unique<C>(); }};
}

}  // namespace kervan::test
