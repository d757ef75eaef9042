/// The members with which a component declares what it can be asked while it runs, beside new values of its live
/// parameters. The container's service carries a request to it (`kervan container call`), and the harness does in
/// tests.
///
///   struct Place {
///     std::string robot;
///     geometry::Pose2 pose;
///     template <class Visitor> void describe(Visitor& v) {
///       v(robot, "robot", {.help = "Its name.", .required = true});
///       v(pose, "pose", {.help = "Where to.", .required = true});
///     }
///   };
///   Request<Place> teleport_{this, "teleport", &World::on_teleport, "Puts a robot somewhere else."};
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

#include "framework/component/manifest.hpp"
#include "framework/component/parameters.hpp"
#include "framework/component/time.hpp"

namespace kervan {

class Component;

/// What a handler throws when what it was asked cannot be, with one sentence that says why.
class RequestRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The arguments of a request that has none.
struct NoArguments {
  template <class Visitor>
  void describe(Visitor&) {}
};

/// What every request is, whatever its arguments; see Request.
class RequestBase {
 public:
  RequestBase(const RequestBase&) = delete;
  RequestBase& operator=(const RequestBase&) = delete;

  const RequestInfo& info() const { return info_; }

  /// Calls the handler. Throws ParameterError for an argument that is unknown, missing or refused, and what the handler
  /// throws.
  std::string answer(const ValueMap& arguments, Time now) const {
    validate(info_.arguments, arguments);
    return handler_(arguments, now);
  }

 protected:
  using Handler = std::function<std::string(const ValueMap&, Time)>;

  RequestBase(Component* owner, RequestInfo info, Handler handler);
  ~RequestBase() = default;

 private:
  RequestInfo info_;
  Handler handler_;
};

/// A request with the arguments P, described like parameters. `handler` is a member function of the owner:
/// std::string (const P&, Time). It runs between two other handlers of the component, under lockstep before anything
/// else at a logical time. It returns one sentence for whoever asked, which may be empty, or throws RequestRefused;
/// then nothing may have changed. Whoever asks may repeat a request without a second effect, so a request for what is
/// so already is best accepted.
template <class P>
class Request : public RequestBase {
 public:
  template <class Owner>
  Request(Owner* owner, std::string name, std::string (Owner::*handler)(const P&, Time), std::string help)
      : RequestBase(owner, {std::move(name), schema_of<P>(), std::move(help)},
                    [owner, handler](const ValueMap& arguments, Time now) {
                      return (owner->*handler)(load_parameters<P>(arguments), now);
                    }) {}
};

}  // namespace kervan
