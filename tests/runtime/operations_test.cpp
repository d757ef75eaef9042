/// What can be asked of a container while it runs, under lockstep: the same calls, between two logical times.
#include "framework/runtime/operations.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "builtin_interfaces/msg/Time.hpp"
#include "framework/kervan.hpp"
#include "framework/runtime/container.hpp"
#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"
#include "tests/runtime/operations_fixtures.hpp"

namespace {

using namespace std::chrono_literals;
using namespace kervan::test::operations;
using kervan::ComponentState;
using kervan::ValueMap;
using kervan::runtime::ComponentSpec;
using kervan::runtime::Container;
using kervan::runtime::ContainerSpec;
using kervan::runtime::Outcome;

kervan::Time at(kervan::Duration time) { return kervan::Time(time); }

std::string text(const Outcome& outcome) { return (outcome.accepted ? "yes: " : "no: ") + outcome.reason; }

class LockstepOperations : public ::testing::Test {
 protected:
  explicit LockstepOperations(ContainerSpec spec = lockstep_spec()) : container_(std::move(spec), registry_) {
    Listener::heard.clear();
    container_.activate();
  }
  ~LockstepOperations() override { container_.end(); }

  kervan::runtime::Operations& ask() { return container_.operations(); }
  void advance(kervan::Duration time) { container_.advance(container_.now() + time); }
  ComponentState state(const std::string& name) { return container_.find(name)->state(); }

  kervan::ComponentRegistry registry_ = operations_registry();
  Container container_;
};

TEST_F(LockstepOperations, AComponentIsLoadedAndRunsFromThenOn) {
  advance(20ms);
  EXPECT_EQ(text(ask().load({.name = "second", .type = "test/talker", .parameters = {{"word", "extra"}}})), "yes: ");
  advance(20ms);
  EXPECT_EQ(Listener::heard, (std::vector<std::string>{"talker 0", "talker 1", "talker 2", "extra 0", "talker 3",
                                                       "extra 1", "talker 4", "extra 2"}));
}

TEST_F(LockstepOperations, AComponentAnswersWhatItDeclaresAtTheNextLogicalTime) {
  advance(20ms);
  Listener::heard.clear();
  EXPECT_EQ(text(ask().call("talker", "say", {{"what", "hello"}, {"times", 2}})), "yes: said at 0.02 s");
  EXPECT_EQ(text(ask().call("talker", "say", {{"what", "far"}, {"volume", 7.5}})), "yes: said at 0.02 s over 7.5 m");
  EXPECT_EQ(text(ask().call("talker", "count", {})), "yes: 3");
  advance(10ms);
  EXPECT_EQ(Listener::heard, (std::vector<std::string>{"hello", "hello", "far", "talker 3"}));
}

TEST_F(LockstepOperations, ARequestThatCannotBeSaysWhy) {
  EXPECT_EQ(text(ask().call("talker", "say", {{"what", "nothing"}})), "no: there is nothing to say");
  EXPECT_EQ(text(ask().call("talker", "say", {})), "no: what: is missing: The words.");
  EXPECT_EQ(text(ask().call("talker", "say", {{"what", "x"}, {"times", 4}})),
            "no: times: 4 is out of range; allowed: 1 .. 3");
  EXPECT_EQ(text(ask().call("talker", "say", {{"what", "x"}, {"volume", -1.0}})),
            "no: volume: -1 m is out of range; allowed: at least 0 m");
  EXPECT_EQ(text(ask().call("talker", "say", {{"waht", "x"}})),
            "no: waht: there is no such parameter; did you mean 'what'? allowed: what, times, volume");
  EXPECT_EQ(text(ask().call("talker", "sya", {})),
            "no: 'talker' has no request 'sya'; did you mean 'say'? it has: say, count");
  EXPECT_EQ(text(ask().call("listener", "say", {})), "no: 'listener' has no request 'say'; it has: none");
  EXPECT_EQ(text(ask().call("nobody", "say", {})),
            "no: there is no component 'nobody' in container 'main'; there are: talker, listener, latched");
  EXPECT_EQ(state("talker"), ComponentState::active);
}

TEST_F(LockstepOperations, ARequestThatThrowsFailsTheComponentAndOneThatDoesNotRunAnswersNothing) {
  EXPECT_EQ(text(ask().call("talker", "say", {{"what", "fail"}})), "no: it failed: told to (in a request)");
  EXPECT_EQ(state("talker"), ComponentState::failed);
  EXPECT_EQ(text(ask().call("talker", "count", {})), "no: 'talker' does not run, it is failed");
}

TEST_F(LockstepOperations, ALateJoinerGetsWhatIsLatched) {
  advance(10ms);
  EXPECT_EQ(text(ask().load({.name = "late", .type = "test/listener", .ports = {{.port = "in", .topic = "/latched"}}})),
            "yes: ");
  Listener::heard.clear();
  advance(0ms);
  EXPECT_EQ(Listener::heard, (std::vector<std::string>{"latched"}));
}

TEST_F(LockstepOperations, LoadingWhatIsThereIsAcceptedAndDoesNothing) {
  EXPECT_EQ(text(ask().load({.name = "talker"})), "yes: already loaded");
  EXPECT_EQ(text(ask().load({.name = "talker", .type = "test/talker", .parameters = {{"word", "talker"}}})),
            "yes: already loaded");
  EXPECT_EQ(text(ask().load({.name = "talker", .type = "test/listener"})),
            "no: 'talker' is loaded already, a test/talker; unload it first");
  EXPECT_EQ(text(ask().load({.name = "talker", .parameters = {{"word", "other"}}})),
            "no: 'talker' is loaded already, with word = talker; unload it first");
  EXPECT_EQ(text(ask().load({.name = "talker", .ports = {{.port = "out", .topic = "/elsewhere"}}})),
            "no: 'talker' is loaded already, with out on /out; unload it first");
  EXPECT_EQ(container_.instances().size(), 3u);
}

TEST_F(LockstepOperations, WhatCannotBeLoadedIsRefusedAndChangesNothing) {
  const auto load = [&](const ComponentSpec& spec) { return text(ask().load(spec)); };
  EXPECT_EQ(load({.name = "x", .type = "test/takler"}),
            "no: there is no component type 'test/takler'; did you mean 'test/talker'? there are: test/broken, "
            "test/frail, test/keyed, test/latched, test/listener, test/slow, test/talker");
  EXPECT_EQ(load({.name = "x"}),
            "no: the composition knows no component 'x', so its type is needed; there are: test/broken, test/frail, "
            "test/keyed, test/latched, test/listener, test/slow, test/talker");
  EXPECT_EQ(load({.name = "x", .type = "test/broken"}), "no: 'test/broken' cannot be loaded: it is broken by design");
  EXPECT_EQ(load({.name = "x", .type = "test/frail"}),
            "no: 'test/frail' cannot be loaded: it does not want to (in on_activate)");
  EXPECT_EQ(load({.name = "x", .type = "test/talker", .parameters = {{"period", 100.0}}}),
            "no: 'test/talker' cannot be loaded: period: 100 s is out of range; allowed: 0.001 .. 1 s");
  EXPECT_EQ(load({.name = "x", .type = "test/talker", .parameters = {{"wrod", "hello"}}}),
            "no: 'test/talker' cannot be loaded: wrod: there is no such parameter; did you mean 'word'? allowed: word, "
            "period");
  EXPECT_EQ(load({.name = "x", .type = "test/talker", .ports = {{.port = "otu", .topic = "/out"}}}),
            "no: 'test/talker' has no port 'otu'; did you mean 'out'? it has: out");
  EXPECT_EQ(load({.name = "x", .type = "test/talker", .ports = {{.port = "out", .topic = "out"}}}),
            "no: port 'out': 'out' is no topic; write an absolute name, such as /out");
  EXPECT_EQ(load({.name = "x", .type = "test/keyed", .ports = {{.port = "requests", .topic = "/out"}}}),
            "no: port 'requests' carries kervan_msgs::msg::MotionRequest, but /out carries rcl_interfaces::msg::Log");
  EXPECT_EQ(
      load({.name = "x y", .type = "test/talker"}),
      "no: 'x y' is no name of a component; allowed: letters, digits and underscores, with slashes between parts");
  EXPECT_EQ(container_.instances().size(), 3u);
  EXPECT_TRUE(container_.spec().loaded.empty());
  advance(10ms);
  EXPECT_EQ(Listener::heard, (std::vector<std::string>{"talker 0", "talker 1"}));
}

TEST_F(LockstepOperations, AComponentOfAnotherContainerIsNotLoadedHere) {
  auto spec = lockstep_spec();
  spec.name = "here";
  spec.components.push_back({.name = "far", .type = "test/talker", .container = "there"});
  spec.domain.id = 231;
  Container container(spec, registry_);
  EXPECT_EQ(text(container.operations().load({.name = "far"})), "no: 'far' belongs to container 'there'");
}

TEST_F(LockstepOperations, LastWordsAreHeardWhenAComponentIsUnloaded) {
  EXPECT_EQ(text(ask().load({.name = "second", .type = "test/talker", .parameters = {{"word", "extra"}}})), "yes: ");
  advance(0ms);
  Listener::heard.clear();
  EXPECT_EQ(text(ask().unload("second")), "yes: ");
  EXPECT_EQ(container_.find("second"), nullptr);
  advance(10ms);
  EXPECT_EQ(Listener::heard, (std::vector<std::string>{"last words of extra", "talker 1"}));
  EXPECT_EQ(text(ask().unload("second")), "yes: already unloaded");
  EXPECT_EQ(text(ask().unload("secnd")),
            "no: there is no component 'secnd' in container 'main'; there are: talker, listener, latched");
}

TEST_F(LockstepOperations, TheInstancesOfAComponentThatIsUnloadedEndInTheOrderOfTheirKeys) {
  Requests::disposed.clear();
  EXPECT_EQ(text(ask().load({.name = "keyed", .type = "test/keyed"})), "yes: ");
  advance(0ms);
  EXPECT_EQ(text(ask().unload("keyed")), "yes: ");
  advance(0ms);
  EXPECT_EQ(Requests::disposed, (std::vector<std::string>{"a", "b", "c"}));
}

TEST_F(LockstepOperations, AComponentOfTheCompositionComesBackAsTheCompositionHasIt) {
  EXPECT_EQ(text(ask().unload("talker")), "yes: ");
  EXPECT_EQ(container_.spec().absent, (std::vector<std::string>{"talker"}));
  advance(30ms);
  EXPECT_EQ(Listener::heard, (std::vector<std::string>{"last words of talker"}));
  EXPECT_EQ(text(ask().load({.name = "talker"})), "yes: ");
  EXPECT_TRUE(container_.spec().absent.empty());
  EXPECT_TRUE(container_.spec().loaded.empty());
  advance(0ms);
  EXPECT_EQ(Listener::heard.back(), "talker 0");
  EXPECT_EQ(container_.find("talker")->outputs().front()->index(), 0u);
  EXPECT_EQ(container_.find("talker")->index(), 0u);
}

TEST_F(LockstepOperations, AComponentThatIsDeactivatedSaysItsLastWordsAndCanBeActivatedAgain) {
  advance(0ms);
  EXPECT_EQ(text(ask().deactivate("talker")), "yes: ");
  EXPECT_EQ(state("talker"), ComponentState::stopped);
  EXPECT_EQ(container_.find("talker")->reason(), "deactivated on request");
  EXPECT_EQ(text(ask().deactivate("talker")), "yes: already inactive");
  advance(30ms);
  EXPECT_EQ(Listener::heard, (std::vector<std::string>{"talker 0", "last words of talker"}));
  EXPECT_EQ(text(ask().activate("talker")), "yes: ");
  EXPECT_EQ(text(ask().activate("talker")), "yes: already active");
  advance(10ms);
  EXPECT_EQ(Listener::heard, (std::vector<std::string>{"talker 0", "last words of talker", "talker 1", "talker 2"}));
}

TEST_F(LockstepOperations, AFailedComponentIsNotActivatedButCanBeLoadedAnew) {
  EXPECT_EQ(text(ask().change_parameters("talker", {{"word", "fail"}})), "yes: ");
  advance(0ms);
  EXPECT_EQ(state("talker"), ComponentState::failed);
  EXPECT_EQ(text(ask().activate("talker")),
            "no: 'talker' has failed: told to (in a timer); unload it and load it again");
  EXPECT_EQ(text(ask().deactivate("talker")), "no: 'talker' has failed: told to (in a timer)");
  EXPECT_EQ(text(ask().unload("talker")), "yes: ");
  EXPECT_EQ(text(ask().load({.name = "talker", .parameters = {{"word", "fine"}}})), "yes: ");
  advance(0ms);
  EXPECT_EQ(state("talker"), ComponentState::active);
}

TEST_F(LockstepOperations, ParametersAreThoseThatWereGivenOrAreTheDefault) {
  EXPECT_EQ(text(ask().change_parameters("talker", {{"word", "hello"}})), "yes: ");
  const auto parameters = ask().parameters("talker");
  ASSERT_EQ(parameters.size(), 2u);
  EXPECT_EQ(parameters[0].info.name, "word");
  EXPECT_EQ(to_text(parameters[0].value), "hello");
  EXPECT_TRUE(parameters[0].given);
  EXPECT_EQ(to_text(parameters[1].value), "0.01");
  EXPECT_FALSE(parameters[1].given);
  EXPECT_EQ(container_.spec().components[0].parameters, (ValueMap{{"word", "hello"}}));
}

TEST_F(LockstepOperations, TheTraceIsTheSameForTheSameRequestsAndCountsWhoWasUnloaded) {
  const auto run = [&](bool with_extra) {
    auto spec = lockstep_spec();
    spec.domain.id = 232;
    Container container(spec, registry_);
    container.activate();
    container.advance(at(20ms));
    if (with_extra) container.operations().load({.name = "extra", .type = "test/talker"});
    container.advance(at(40ms));
    if (with_extra) container.operations().unload("extra");
    container.advance(at(60ms));
    container.end();
    return container.trace_hash();
  };
  EXPECT_EQ(run(true), run(true));
  EXPECT_EQ(run(false), run(false));
  EXPECT_NE(run(true), run(false));
}

TEST_F(LockstepOperations, WhatWasPostedIsDoneBeforeTheNextLogicalTime) {
  std::vector<kervan::Time> times;
  ask().post([&] { times.push_back(container_.now()); });
  EXPECT_TRUE(ask().pending());
  advance(0ms);
  EXPECT_EQ(times, (std::vector<kervan::Time>{at(0ms)}));
  EXPECT_FALSE(ask().pending());
}

TEST(LockstepOperationsRestart, AContainerComesBackWithWhatWasLoadedUnloadedAndStopped) {
  kervan::ComponentRegistry registry = operations_registry();
  ContainerSpec spec = lockstep_spec();
  spec.domain.id = 233;
  Listener::heard.clear();
  {
    Container container(spec, registry);
    container.activate();
    auto& ask = container.operations();
    ask.unload("talker");
    ask.load({.name = "second", .type = "test/talker", .parameters = {{"word", "second"}}});
    ask.load({.name = "third", .type = "test/talker", .parameters = {{"word", "third"}}});
    ask.deactivate("third");
    ask.change_parameters("second", {{"word", "changed"}});
    container.end();
    spec = container.spec();
  }
  Listener::heard.clear();
  Container container(spec, registry);
  container.activate();
  container.advance(at(0ms));
  EXPECT_EQ(Listener::heard, (std::vector<std::string>{"changed 0"}));
  EXPECT_EQ(container.find("talker"), nullptr);
  EXPECT_EQ(container.find("third")->state(), ComponentState::stopped);
  EXPECT_EQ(container.find("listener")->index(), 1u);
  container.end();
}

TEST(LockstepOperationsPeers, RefuseToLoadAndUnload) {
  kervan::ComponentRegistry registry = operations_registry();
  ContainerSpec spec = lockstep_spec();
  spec.domain = {.id = 34, .tag = "operations-" + std::to_string(getpid())};
  spec.members = {"main", "other"};
  Container container(spec, registry);
  EXPECT_EQ(
      text(container.operations().load({.name = "x", .type = "test/talker"})),
      "no: under lockstep a container that has peers cannot load components: all of them would have to know it at "
      "one logical time");
  EXPECT_EQ(text(container.operations().unload("talker")),
            "no: under lockstep a container that has peers cannot unload components: all of them would have to know it "
            "at one logical time");
}

}  // namespace
