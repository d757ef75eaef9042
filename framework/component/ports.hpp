/// The members with which a component declares what it reads, what it writes and when it runs.
///
///   Input<nav_msgs::msg::Odometry> odometry_{this, "odom", qos::sensor.max_age(500ms), "Pose and speed of
///   base_link."}; Input<kervan_msgs::msg::Goal> goals_{this, "goal", qos::event, &Planner::on_goal, "Where to go."};
///   Output<geometry_msgs::msg::TwistStamped> cmd_vel_{this, "cmd_vel", qos::command, "Speed wanted of base_link."};
///   Timer tick_{this, params_.period, &Planner::on_tick};
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "framework/component/manifest.hpp"
#include "framework/component/sample.hpp"
#include "framework/dds/message.hpp"

namespace kervan {

class Component;

namespace runtime {
class InputPort;
class OutputPort;
}  // namespace runtime

namespace detail {
const TypeSupport& require_layout(const TypeSupport& type, std::uint64_t compiled);
}

/// The TypeSupport of T out of its package's library. Throws std::runtime_error if that was built with another layout
/// of T than the calling code: a process has one library of a name, whichever module brought it along.
template <class T>
const TypeSupport& shared_type_support() {
  return detail::require_layout(type_support<T>(), compiled_layout<T>);
}

/// What every input is, whatever its message type; see Input.
class InputBase {
 public:
  InputBase(const InputBase&) = delete;
  InputBase& operator=(const InputBase&) = delete;

  const std::string& name() const { return info_.name; }
  const PortInfo& info() const { return info_; }
  const TypeSupport& type() const { return type_; }

  /// Empty while latest() would give a sample, else the reason why it does not, as a sentence for a person:
  /// "odom: nothing received yet", "odom: no sample for more than 0.50 s".
  std::string missing() const;

  /// A sample has arrived while the present handler runs, and waits for its own: for handlers that take long and may
  /// no longer be needed. Always false under lockstep, where nothing arrives meanwhile.
  bool waiting() const;

 protected:
  using Deliver = std::function<void(dds::SampleBlock*, Time)>;

  InputBase(Component* owner, std::string name, const TypeSupport& type, PortQos qos, Deliver deliver,
            std::string help);
  ~InputBase() = default;

  dds::SampleBlock* latest_block() const;
  std::vector<dds::SampleBlock*> take_blocks();
  std::vector<dds::SampleBlock*> instance_blocks() const;

 private:
  friend class Component;
  friend class runtime::InputPort;

  PortInfo info_;
  const TypeSupport& type_;
  Deliver deliver_;
  runtime::InputPort* port_ = nullptr;  ///< set once the container has created the reader
};

/// A port that reads one topic. With a handler, each new sample is handed to it, oldest first; without, the component
/// looks with latest(), take() or instances() when it runs. A pointer is valid until the handler returns; keep a Sample
/// to hold on to one.
template <class T>
class Input : public InputBase {
 public:
  Input(Component* owner, std::string name, PortQos qos, std::string help)
      : InputBase(owner, std::move(name), shared_type_support<T>(), qos, nullptr, std::move(help)) {}

  /// `handler` is a member function of the owner: void (const T&, Time) sees the samples that carry data,
  /// void (const Sample<T>&, Time) also those that dispose of an instance.
  template <class Owner, class Argument>
  Input(Owner* owner, std::string name, PortQos qos, void (Owner::*handler)(Argument, Time), std::string help)
      : InputBase(owner, std::move(name), shared_type_support<T>(), qos, deliver_to(owner, handler), std::move(help)) {}

  /// The newest sample; nullptr if there is none, if its lifespan is over or if it is older than the port's max_age.
  const T* latest() const {
    dds::SampleBlock* block = latest_block();
    return block ? static_cast<const T*>(dds::value_of(block)) : nullptr;
  }

  /// As latest(), as a handle that keeps the sample alive.
  Sample<T> latest_sample() const {
    dds::SampleBlock* block = latest_block();
    return block ? Sample<T>(block) : Sample<T>();
  }

  /// The samples that arrived since the last call, oldest first, at most the profile's depth per instance.
  std::vector<Sample<T>> take() { return samples(take_blocks()); }

  /// Keyed topics: the newest sample of every instance that is alive and fresh, in order of first appearance.
  std::vector<Sample<T>> instances() const { return samples(instance_blocks()); }

 private:
  template <class Owner, class Argument>
  static Deliver deliver_to(Owner* owner, void (Owner::*handler)(Argument, Time)) {
    if constexpr (std::is_same_v<std::remove_cvref_t<Argument>, Sample<T>>) {
      return [owner, handler](dds::SampleBlock* block, Time now) { (owner->*handler)(Sample<T>(block), now); };
    } else {
      static_assert(std::is_same_v<std::remove_cvref_t<Argument>, T>, "the handler takes const T& or const Sample<T>&");
      return [owner, handler](dds::SampleBlock* block, Time now) {
        if (!dds::is_disposed(block)) (owner->*handler)(*static_cast<const T*>(dds::value_of(block)), now);
      };
    }
  }

  static std::vector<Sample<T>> samples(const std::vector<dds::SampleBlock*>& blocks) {
    std::vector<Sample<T>> result;
    result.reserve(blocks.size());
    for (dds::SampleBlock* block : blocks) result.emplace_back(block);
    return result;
  }
};

/// What every output is, whatever its message type; see Output.
class OutputBase {
 public:
  OutputBase(const OutputBase&) = delete;
  OutputBase& operator=(const OutputBase&) = delete;

  const std::string& name() const { return info_.name; }
  const PortInfo& info() const { return info_; }
  const TypeSupport& type() const { return type_; }

 protected:
  OutputBase(Component* owner, std::string name, const TypeSupport& type, PortQos qos, std::string help);
  ~OutputBase() = default;

  dds::SampleBlock* loan_block(bool cleared);
  void publish_block(dds::SampleBlock* block, bool dispose);

 public:
  /// For a topic with liveliness `manual`: says that the component is alive although it has nothing to publish.
  /// Publishing says so too. From handlers.
  void assert_alive();

 private:
  friend class Component;
  friend class runtime::OutputPort;

  PortInfo info_;
  const TypeSupport& type_;
  runtime::OutputPort* port_ = nullptr;  ///< set once the container has created the writer
};

/// A port that writes one topic. Usable from handlers, not from the constructor.
template <class T>
class Output : public OutputBase {
 public:
  Output(Component* owner, std::string name, PortQos qos, std::string help)
      : OutputBase(owner, std::move(name), shared_type_support<T>(), qos, std::move(help)) {}

  /// A default-initialised message that keeps the memory of one published before: no allocation in the steady state.
  Loan<T> loan() { return Loan<T>(loan_block(true)); }

  /// As loan(), but with whatever an earlier message left in it, for large data that is overwritten anyway.
  Loan<T> loan_uncleared() { return Loan<T>(loan_block(false)); }

  /// Hands the message to every reader; readers in this container get the very same object.
  void publish(Loan<T>&& loan) { publish_block(std::exchange(loan.block_, nullptr), false); }

  /// Copies `message` into a loan and publishes that.
  void publish(const T& message) {
    Loan<T> copy = loan_uncleared();
    *copy = message;
    publish(std::move(copy));
  }

  /// Keyed topics: ends the life of the instance that the key members of `message` name.
  void dispose(const T& message) {
    Loan<T> copy = loan_uncleared();
    *copy = message;
    publish_block(std::exchange(copy.block_, nullptr), true);
  }
};

/// Calls a member function of its owner at activation and every `period` after it.
class Timer {
 public:
  template <class Owner>
  Timer(Owner* owner, Duration period, void (Owner::*handler)(Time))
      : Timer(static_cast<Component*>(owner), period, [owner, handler](Time now) { (owner->*handler)(now); }) {}
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

  Duration period() const { return period_; }
  void fire(Time now) const { handler_(now); }

 private:
  Timer(Component* owner, Duration period, std::function<void(Time)> handler);

  Duration period_;
  std::function<void(Time)> handler_;
};

}  // namespace kervan
