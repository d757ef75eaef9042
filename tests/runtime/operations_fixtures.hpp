/// Components that are loaded, stopped and changed in the tests of a container's operations.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "framework/kervan.hpp"
#include "framework/runtime/spec.hpp"
#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"
#include "rcl_interfaces/msg/Log.hpp"

namespace kervan::test::operations {

using kervan_msgs::msg::MotionRequest;
using Words = rcl_interfaces::msg::Log;

struct TalkerParams {
  std::string word = "talker";
  Duration period = std::chrono::milliseconds(10);
  template <class Visitor>
  void describe(Visitor& v) {
    v(word, "word", {.help = "What it says.", .live = true});
    v(period, "period", {.min = 0.001, .max = 1.0, .help = "Between two."});
  }
};

struct SayArguments {
  std::string what;
  std::int64_t times = 1;
  std::optional<double> volume;
  template <class Visitor>
  void describe(Visitor& v) {
    v(what, "what", {.help = "The words.", .required = true});
    v(times, "times", {.min = 1, .max = 3, .help = "How often."});
    v(volume, "volume", {.unit = "m", .min = 0.0, .help = "How far it is to be heard; else as far as it goes."});
  }
};

/// Counts aloud, and says so when it ends.
class Talker final : public Component {
  const TalkerParams& params_ = parameters<TalkerParams>();
  Output<Words> out_{this, "out", qos::event, "What it says."};
  Timer tick_{this, params_.period, &Talker::on_tick};
  Request<SayArguments> say_{this, "say", &Talker::on_say, "Says something once more than it would."};
  Request<NoArguments> count_request_{this, "count", &Talker::on_count, "How far it has counted."};
  int count_ = 0;

  void say(const std::string& text) {
    auto message = out_.loan();
    message->msg = text;
    out_.publish(std::move(message));
  }
  void on_tick(Time) {
    if (params_.word == "fail") throw std::runtime_error("told to");
    say(params_.word + " " + std::to_string(count_++));
  }
  std::string on_say(const SayArguments& arguments, Time now) {
    if (arguments.what == "nothing") throw RequestRefused("there is nothing to say");
    if (arguments.what == "fail") throw std::runtime_error("told to");
    for (std::int64_t i = 0; i < arguments.times; ++i) say(arguments.what);
    const std::string far = arguments.volume ? " over " + to_text(Value(*arguments.volume)) + " m" : "";
    return "said at " + to_text(Value(seconds(now))) + " s" + far;
  }
  std::string on_count(const NoArguments&, Time) { return std::to_string(count_); }
  void on_deactivate(Time) override { say("last words of " + params_.word); }
};

/// Remembers all it hears, and which instances end.
class Listener final : public Component {
  Input<Words> in_{this, "in", qos::event, &Listener::on_message, "What is said."};
  void on_message(const Words& message, Time) { heard.push_back(message.msg); }

 public:
  static inline std::vector<std::string> heard;
};

class Latched final : public Component {
  Output<Words> out_{this, "latched", qos::latched, "Said once."};
  Input<MotionRequest> requests_{this, "requests", qos::state.optional(), &Latched::on_request, "Seen to end."};
  void on_activate(Time) override {
    Words message;
    message.msg = "latched";
    out_.publish(message);
  }
  void on_request(const Sample<MotionRequest>& request, Time);
};

/// Which requests were disposed of, in the order in which that was heard.
struct Requests {
  static inline std::vector<std::string> disposed;
};

inline void Latched::on_request(const Sample<MotionRequest>& request, Time) {
  if (request.disposed()) Requests::disposed.push_back(request->behaviour);
}

class Keyed final : public Component {
  Output<MotionRequest> out_{this, "requests", qos::state, "Three instances, and one that ends by itself."};
  void on_activate(Time) override {
    MotionRequest request;
    for (const char* key : {"c", "a", "gone", "b"}) {
      request.behaviour = key;
      out_.publish(request);
    }
    request.behaviour = "gone";
    out_.dispose(request);
  }
  void on_deactivate(Time) override { Requests::disposed.clear(); }
};

class Broken final : public Component {
 public:
  Broken() {
    if (!describing()) throw std::runtime_error("it is broken by design");
  }
};

class Frail final : public Component {
  void on_activate(Time) override { throw std::runtime_error("it does not want to"); }
};

/// Stays in a handler for as long as it is told to.
class Slow final : public Component {
  Timer tick_{this, std::chrono::milliseconds(1), &Slow::on_tick};
  void on_tick(Time) {
    inside = true;
    while (stay) std::this_thread::yield();
  }

 public:
  static inline std::atomic<bool> stay = false;
  static inline std::atomic<bool> inside = false;
};

inline ComponentRegistry operations_registry() {
  ComponentRegistry registry({});
  registry.add(define<Talker>("test/talker"));
  registry.add(define<Listener>("test/listener"));
  registry.add(define<Latched>("test/latched"));
  registry.add(define<Keyed>("test/keyed"));
  registry.add(define<Broken>("test/broken"));
  registry.add(define<Frail>("test/frail"));
  registry.add(define<Slow>("test/slow"));
  return registry;
}

/// A talker, who hears it, and somebody who said something once.
inline runtime::ContainerSpec operations_spec() {
  runtime::ContainerSpec spec;
  spec.domain = {.id = 230, .network = false};
  spec.log_to_console = false;
  const QosProfile event = *builtin_profile("event");
  spec.components.push_back({.name = "talker", .type = "test/talker", .ports = {{"out", "/out", event}}});
  spec.components.push_back({.name = "listener", .type = "test/listener", .ports = {{"in", "/out", event}}});
  spec.components.push_back({.name = "latched", .type = "test/latched"});
  return spec;
}

inline runtime::ContainerSpec lockstep_spec() {
  runtime::ContainerSpec spec = operations_spec();
  spec.clock = runtime::ClockMode::lockstep;
  return spec;
}

}  // namespace kervan::test::operations
