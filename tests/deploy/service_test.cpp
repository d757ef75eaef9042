/// The container's service: what it answers, that a repetition has no second effect, and what survives a restart.
#include "deploy/container/service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "deploy/container/changes.hpp"
#include "deploy/container/parameter_text.hpp"
#include "deploy/container/service_client.hpp"
#include "tests/program/program.hpp"
#include "tests/runtime/operations_fixtures.hpp"

namespace {

using namespace std::chrono_literals;
using namespace kervan::test::operations;
using kervan::ParameterInfo;
using kervan::ParameterKind;
using kervan::Value;
using kervan::ValueList;
using kervan::ValueMap;
using kervan::container::Changes;
using kervan::container::ContainerService;
using kervan::container::ServiceClient;
using kervan::runtime::Container;
using kervan::runtime::ContainerSpec;
using kervan_msgs::msg::ComponentState;
using kervan_msgs::msg::ContainerReply;
using kervan_msgs::msg::ContainerRequest;
using kervan_msgs::msg::ContainerVerb;
using Steady = std::chrono::steady_clock;

ContainerRequest request(ContainerVerb verb, const std::string& component = {}) {
  ContainerRequest request;
  request.id = kervan::container::new_request_id();
  request.container = "main";
  request.timeout = 10.0;
  request.verb = verb;
  request.component = component;
  return request;
}

ContainerRequest setting(const std::string& component, const std::string& name, const std::string& text) {
  ContainerRequest one = request(ContainerVerb::CONTAINER_SET, component);
  one.parameters.push_back({.name = name, .text = text});
  return one;
}

std::string text(const ContainerReply& reply) { return (reply.accepted ? "yes: " : "no: ") + reply.reason; }

/// A container under lockstep whose service is asked without a network.
class Service : public ::testing::Test {
 protected:
  Service() { container_.activate(); }
  ~Service() override { container_.end(); }

  static ContainerSpec spec() {
    ContainerSpec spec = lockstep_spec();
    spec.domain.id = 225;
    return spec;
  }
  ContainerReply ask(const ContainerRequest& one) { return service_.answer(one, Steady::now()); }

  kervan::ComponentRegistry registry_ = operations_registry();
  Container container_{spec(), registry_};
  int changes_ = 0;
  ContainerService service_{container_, registry_, [this] { ++changes_; }};
};

TEST_F(Service, SaysWhatIsThereAndHowItIs) {
  const ContainerReply reply = ask(request(ContainerVerb::CONTAINER_STATE));
  EXPECT_EQ(text(reply), "yes: ");
  EXPECT_EQ(reply.container, "main");
  ASSERT_EQ(reply.components.size(), 3u);
  EXPECT_EQ(reply.components[0].name, "talker");
  EXPECT_EQ(reply.components[0].type, "test/talker");
  EXPECT_EQ(reply.components[0].state, ComponentState::COMPONENT_ACTIVE);
  EXPECT_FALSE(reply.components[0].loaded);
  EXPECT_EQ(ask(request(ContainerVerb::CONTAINER_STATE, "listener")).components.size(), 1u);
  EXPECT_EQ(text(ask(request(ContainerVerb::CONTAINER_STATE, "listner"))),
            "no: there is no component 'listner' in container 'main'; did you mean 'listener'? there are: talker, "
            "listener, latched");
  EXPECT_EQ(changes_, 0);
}

TEST_F(Service, ShowsParametersAsACompositionWouldHoldThem) {
  const ContainerReply reply = ask(request(ContainerVerb::CONTAINER_SNAPSHOT, "talker"));
  ASSERT_EQ(reply.parameters.size(), 2u);
  EXPECT_EQ(reply.parameters[0].name + " = " + reply.parameters[0].value, "word = talker");
  EXPECT_TRUE(reply.parameters[0].live);
  EXPECT_EQ(reply.parameters[1].name + " = " + reply.parameters[1].value, "period = 0.01 s");
  EXPECT_FALSE(reply.parameters[1].live);
  EXPECT_FALSE(reply.parameters[1].given);
  EXPECT_EQ(ask(request(ContainerVerb::CONTAINER_SNAPSHOT)).components.size(), 3u);
}

TEST_F(Service, ChangesParametersAndShowsTheNewValues) {
  const ContainerReply reply = ask(setting("talker", "word", "hello"));
  EXPECT_EQ(text(reply), "yes: ");
  ASSERT_EQ(reply.parameters.size(), 1u);
  EXPECT_EQ(reply.parameters[0].value, "hello");
  EXPECT_EQ(changes_, 1);
  EXPECT_EQ(text(ask(setting("talker", "period", "20ms"))),
            "no: period: cannot be changed while the component runs; live are: word");
  EXPECT_EQ(text(ask(setting("talker", "period", "20"))), "no: period: 20 has no unit; write e.g. 20 s");
  EXPECT_EQ(text(ask(setting("talker", "period", "20 s"))), "no: period: 20 s is out of range; allowed: 0.001 .. 1 s");
  EXPECT_EQ(text(ask(setting("talker", "wrod", "x"))),
            "no: wrod: there is no such parameter; did you mean 'word'? allowed: word, period");
  EXPECT_EQ(text(ask(setting("nobody", "word", "x"))),
            "no: there is no component 'nobody' in container 'main'; there are: talker, listener, latched");
  ContainerRequest twice = setting("talker", "word", "x");
  twice.parameters.push_back({.name = "word", .text = "y"});
  EXPECT_EQ(text(ask(twice)), "no: word: is given twice");
  EXPECT_EQ(changes_, 1);
}

TEST_F(Service, PutsWhatAComponentDeclaresAsRequestsToIt) {
  ContainerRequest call = request(ContainerVerb::CONTAINER_CALL, "talker");
  call.request = "say";
  call.parameters = {{.name = "what", .text = "hello"}, {.name = "volume", .text = "20 cm"}};
  const ContainerReply reply = ask(call);
  EXPECT_EQ(text(reply), "yes: said at 0 s over 0.2 m");
  ASSERT_EQ(reply.components.size(), 1u);
  EXPECT_EQ(reply.components[0].name, "talker");
  EXPECT_EQ(text(ask(call)), "yes: said at 0 s over 0.2 m") << "the same id: the same answer";
  EXPECT_EQ(container_.find("talker")->outputs().front()->published(), 1u) << "and no second effect";
  EXPECT_EQ(changes_, 0) << "nothing of it is to survive a restart";
  call.id = kervan::container::new_request_id();
  call.parameters[1].text = "20";
  EXPECT_EQ(text(ask(call)), "no: volume: 20 has no unit; write e.g. 20 m");
  call.id = kervan::container::new_request_id();
  call.request = "shout";
  EXPECT_EQ(text(ask(call)), "no: 'talker' has no request 'shout'; it has: say, count");
}

TEST_F(Service, LoadsWithParametersPortsAndALevel) {
  ContainerRequest load = request(ContainerVerb::CONTAINER_LOAD, "second");
  load.type = "test/talker";
  load.parameters.push_back({.name = "period", .text = "5ms"});
  load.ports.push_back({.name = "out", .text = "/elsewhere"});
  load.log_level = "debug";
  const ContainerReply reply = ask(load);
  EXPECT_EQ(text(reply), "yes: ");
  ASSERT_EQ(reply.components.size(), 1u);
  EXPECT_TRUE(reply.components[0].loaded);
  EXPECT_EQ(container_.find("second")->outputs().front()->binding().topic, "/elsewhere");
  EXPECT_EQ(container_.spec().loaded.front().parameters, (ValueMap{{"period", 0.005}}));

  load = request(ContainerVerb::CONTAINER_LOAD, "third");
  load.type = "test/tolker";
  EXPECT_EQ(text(ask(load)),
            "no: there is no component type 'test/tolker'; did you mean 'test/talker'? there are: test/broken, "
            "test/frail, test/keyed, test/latched, test/listener, test/slow, test/talker");
  load = request(ContainerVerb::CONTAINER_LOAD, "third");
  load.type = "test/talker";
  load.log_level = "loud";
  EXPECT_EQ(text(ask(load)), "no: 'loud' is no level of the log; allowed: trace, debug, info, warn, error, off");
  EXPECT_EQ(container_.instances().size(), 4u);
}

TEST_F(Service, ARepeatedRequestGetsTheSameReplyWithoutASecondEffect) {
  ContainerRequest load = request(ContainerVerb::CONTAINER_LOAD, "second");
  load.type = "test/talker";
  EXPECT_EQ(text(ask(load)), "yes: ");
  EXPECT_EQ(text(ask(request(ContainerVerb::CONTAINER_UNLOAD, "second"))), "yes: ");
  EXPECT_EQ(text(ask(load)), "yes: ");  // the same id: it was carried out long ago
  EXPECT_EQ(container_.find("second"), nullptr);
  EXPECT_EQ(changes_, 2);
  load.id = kervan::container::new_request_id();
  EXPECT_EQ(text(ask(load)), "yes: ");
  EXPECT_NE(container_.find("second"), nullptr);
  load.id = kervan::container::new_request_id();
  EXPECT_EQ(text(ask(load)), "yes: already loaded");
}

TEST_F(Service, RemembersTheLastRepliesOnly) {
  const ContainerRequest first = setting("talker", "word", "first");
  EXPECT_EQ(text(ask(first)), "yes: ");
  for (std::size_t i = 0; i < ContainerService::kRemembered; ++i) ask(request(ContainerVerb::CONTAINER_STATE));
  EXPECT_EQ(text(ask(setting("talker", "word", "second"))), "yes: ");
  EXPECT_EQ(text(ask(first)), "yes: ");
  EXPECT_EQ(kervan::to_text(container_.operations().parameters("talker").front().value), "first");
}

TEST_F(Service, ARequestThatHasWaitedTooLongIsNotCarriedOut) {
  ContainerRequest late = setting("talker", "word", "late");
  late.timeout = 2.0;
  const std::string why = text(service_.answer(late, Steady::now() - 3s));
  EXPECT_EQ(why, "no: not carried out: the request has waited for 3.0 s, and its sender only waits for 2.0 s");
  EXPECT_EQ(text(ask(late)), why);
  EXPECT_EQ(changes_, 0);
}

/// A container that runs under the wall clock, in a domain without a network.
class RunningService {
 public:
  RunningService() {
    ContainerSpec spec = operations_spec();
    spec.domain.id = 226;
    container_.emplace(spec, registry_);
    service_.emplace(*container_, registry_);
    thread_ = std::thread([this] { container_->run({.stop = &stop_}); });
  }
  ~RunningService() {
    stop_ = true;
    thread_.join();
    service_.reset();
  }
  Container& container() { return *container_; }

 private:
  kervan::ComponentRegistry registry_ = operations_registry();
  std::optional<Container> container_;
  std::optional<ContainerService> service_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

TEST(ServiceOverTopics, AnswersItsClients) {
  RunningService running;
  ServiceClient one(running.container().domain(), "main"), two(running.container().domain(), "main");
  for (int round = 0; round < 20; ++round) {
    const auto load = [&] {
      ContainerRequest wanted = request(ContainerVerb::CONTAINER_LOAD, "extra");
      wanted.type = "test/talker";
      return one.ask(wanted, 60s);
    }();
    ASSERT_TRUE(load);
    EXPECT_EQ(text(*load), "yes: ");
    const auto unload = two.ask(request(ContainerVerb::CONTAINER_UNLOAD, "extra"), 60s);
    ASSERT_TRUE(unload);
    EXPECT_EQ(text(*unload), "yes: ");
  }
}

TEST(ServiceOverTopics, AClientWhoseReplyWasLostGetsItWhenItAsksAgain) {
  RunningService running;
  ContainerRequest load = request(ContainerVerb::CONTAINER_LOAD, "extra");
  load.type = "test/talker";
  {
    ServiceClient dies(running.container().domain(), "main");
    ASSERT_TRUE(dies.ask(load, 60s));
  }
  ServiceClient again(running.container().domain(), "main");
  const auto reply = again.ask(load, 60s);
  ASSERT_TRUE(reply);
  EXPECT_EQ(text(*reply), "yes: ");  // not "already loaded": the reply of that time
}

TEST(ServiceOverTopics, WhoIsNotThereDoesNotAnswer) {
  RunningService running;
  ServiceClient client(running.container().domain(), "nobody");
  EXPECT_FALSE(client.ask(request(ContainerVerb::CONTAINER_STATE), 50ms));
}

TEST(ServiceChanges, SurviveARestartOfTheSameSpecificationOnly) {
  const kervan::test::Folder folder;
  kervan::ComponentRegistry registry = operations_registry();
  ContainerSpec spec = lockstep_spec();
  spec.domain.id = 227;
  spec.run_folder = folder.path();
  {
    ContainerSpec started = spec;
    const Changes changes(started);
    Container container(started, registry);
    container.activate();
    ContainerService service(container, registry, [&] { changes.keep(container.spec()); });
    const auto ask = [&](const ContainerRequest& one) { return text(service.answer(one, Steady::now())); };
    ContainerRequest load = request(ContainerVerb::CONTAINER_LOAD, "second");
    load.type = "test/talker";
    EXPECT_EQ(ask(load), "yes: ");
    EXPECT_EQ(ask(request(ContainerVerb::CONTAINER_UNLOAD, "listener")), "yes: ");
    EXPECT_EQ(ask(request(ContainerVerb::CONTAINER_DEACTIVATE, "latched")), "yes: ");
    EXPECT_EQ(ask(setting("talker", "word", "changed")), "yes: ");
    // No end in good order: the process was killed.
  }
  {
    ContainerSpec started = spec;
    const Changes changes(started);
    Container container(started, registry);
    container.activate();
    EXPECT_NE(container.find("second"), nullptr);
    EXPECT_EQ(container.find("listener"), nullptr);
    EXPECT_EQ(container.find("latched")->state(), kervan::ComponentState::stopped);
    EXPECT_EQ(kervan::to_text(container.operations().parameters("talker").front().value), "changed");
    container.end();
  }
  spec.components.front().parameters["word"] = "edited";
  const Changes changes(spec);
  EXPECT_TRUE(spec.loaded.empty());
  EXPECT_EQ(spec.components.front().parameters, (ValueMap{{"word", "edited"}}));
}

TEST(ServiceChanges, AFileThatCannotBeWrittenIsNamedInTheReply) {
  kervan::ComponentRegistry registry = operations_registry();
  ContainerSpec spec = lockstep_spec();
  spec.domain.id = 228;
  Container container(spec, registry);
  container.activate();
  ContainerService service(container, registry, [] {
    throw kervan::ConfigError({"x.json", 0, 0}, "cannot be written");
  });
  EXPECT_EQ(text(service.answer(setting("talker", "word", "hello"), Steady::now())),
            "yes: done, but it will not survive a restart: x.json: cannot be written");
  container.end();
}

TEST(ParameterText, IsReadBackAsTheSameValue) {
  const auto back = [](const ParameterInfo& info, const Value& value) {
    const std::string shown = kervan::container::to_parameter_text(info, value);
    EXPECT_EQ(kervan::container::parameter_from_text(info, shown), value) << shown;
    return shown;
  };
  const auto info = [](ParameterKind kind, const char* unit = "") {
    return ParameterInfo{.name = "p", .kind = kind, .unit = unit, .choices = {"low", "high"}};
  };
  EXPECT_EQ(back(info(ParameterKind::boolean), true), "true");
  EXPECT_EQ(back(info(ParameterKind::integer), std::int64_t{-3}), "-3");
  EXPECT_EQ(back(info(ParameterKind::number, "m/s"), 0.5), "0.5 m/s");
  EXPECT_EQ(back(info(ParameterKind::number), 0.5), "0.5");
  EXPECT_EQ(back(info(ParameterKind::duration), 0.25), "0.25 s");
  EXPECT_EQ(back(info(ParameterKind::text), "two words"), "\"two words\"");
  EXPECT_EQ(back(info(ParameterKind::choice), "high"), "high");
  EXPECT_EQ(back(info(ParameterKind::numbers, "m"), ValueList{1.0, 2.5}), "[1 m, 2.5 m]");
  EXPECT_EQ(back(info(ParameterKind::texts), ValueList{"a", "b c"}), "[a, \"b c\"]");
  EXPECT_EQ(back(info(ParameterKind::pose), ValueList{1.0, 2.0, 0.5}), "[1 m, 2 m, 0.5 rad]");
  EXPECT_EQ(back(info(ParameterKind::points), ValueList{Value(ValueList{1.0, 2.0})}), "[[1 m, 2 m]]");
  EXPECT_EQ(back(info(ParameterKind::pairs), ValueList{Value(ValueList{std::int64_t{0}, std::int64_t{1}})}),
            "[[0, 1]]");
  ParameterInfo records = info(ParameterKind::records);
  records.members = {ParameterInfo{.name = "x", .kind = ParameterKind::number, .unit = "m"}};
  EXPECT_EQ(back(records, ValueMap{{"r1", ValueMap{{"x", 1.0}}}}), "{r1: {x: 1 m}}");
}

}  // namespace
