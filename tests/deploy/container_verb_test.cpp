// kervan container: asking the containers of a run that is under way, from another process.
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/deploy/supervised.hpp"

namespace kervan::test {
namespace {

const std::string pair =
    "components:\n"
    "  a: {type: test/beacon, params: {word: a is here}, remap: {out: /a, in: /b}}\n"
    "  b: {type: test/beacon, params: {word: b is here}, remap: {out: /b, in: /a}}\n"
    "containers:\n"
    "  one: {components: [a]}\n"
    "  two: {components: [b]}\n";

class ContainerVerb : public testing::Test {
 protected:
  ContainerVerb() {
    for (int i = 0; i < 2; ++i) run_.wait_for("] heard ");
  }
  ~ContainerVerb() override {
    run_.signal(SIGTERM);
    run_.wait();
  }

  /// What `kervan container …` says and returns, in the folder of the run.
  Result ask(const std::string& arguments) const {
    return run_line(KERVAN_PROGRAM, "container " + arguments, run_.folder());
  }

  Supervised run_{pair};
};

TEST_F(ContainerVerb, FindsTheRunThatIsUnderWayAndListsItsContainers) {
  const Result list = ask("list --timeout 60s");
  EXPECT_EQ(list.code, 0) << list.err;
  EXPECT_EQ(list.out, "container  components\none        1\ntwo        1\n");
  const Result state = ask("state two --timeout 60s");
  EXPECT_EQ(state.code, 0) << state.err;
  EXPECT_EQ(state.out, "b  test/beacon  active\n");
  const auto json = nlohmann::json::parse(ask("state two b --json --timeout 60s").out);
  EXPECT_EQ(json["result"], "accepted");
  EXPECT_EQ(json["components"][0]["state"], "active");
}

TEST_F(ContainerVerb, WhatItChangedIsThereAgainAfterTheContainerWasKilled) {
  EXPECT_EQ(ask("load two extra test/beacon --param word=extra --port out=/extra --port in=/a --timeout 60s").code, 0);
  EXPECT_NE(run_.wait_for("extra in "), "");
  EXPECT_EQ(ask("deactivate two b --timeout 60s").code, 0);
  ::kill(run_.container("two"), SIGKILL);
  EXPECT_NE(run_.wait_for("extra in "), "");
  const Result state = ask("state two --timeout 60s");
  EXPECT_EQ(state.code, 0) << state.err;
  EXPECT_NE(state.out.find("b      test/beacon  stopped  deactivated on request\n"), std::string::npos) << state.out;
  EXPECT_NE(state.out.find("extra  test/beacon  active   loaded on request\n"), std::string::npos) << state.out;
}

TEST_F(ContainerVerb, ARefusalSaysWhyAndIsTold) {
  const Result refused = ask("set two b word=other --timeout 60s");
  EXPECT_EQ(refused.code, 1);
  EXPECT_EQ(
      refused.err,
      "refused by container 'two': word: cannot be changed while the component runs; it has no live parameters\n");
  const Result unknown = ask("state tow");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_TRUE(unknown.err.starts_with("there is no container 'tow' in runs/")) << unknown.err;
  EXPECT_TRUE(unknown.err.ends_with("; did you mean 'two'? there are: one, two\n")) << unknown.err;
}

TEST_F(ContainerVerb, AContainerThatDoesNotAnswerIsNamedWithThoseThatAreThere) {
  // Somewhere else: nobody hears it.
  const Result silent = ask("state two --domain 3 --tag nobody-is-here --timeout 200ms");
  EXPECT_EQ(silent.code, 1);
  EXPECT_EQ(silent.err, "container 'two' did not answer within 200ms; there are: none\n");
}

TEST(ContainerVerbCall, ASimulatedWorldIsPausedChangedAndGoesOn) {
  Supervised run(
      "components:\n"
      "  a: {type: test/beacon, params: {word: a is here}, remap: {out: /a, in: /b}}\n"
      "  b: {type: test/beacon, params: {word: b is here}, remap: {out: /b, in: /a}}\n"
      "  world:\n"
      "    type: sim/world\n"
      "    params: {map: worlds/hall.yaml, robots: {r1: {model: robots/p3dx.yaml, start: [2 m, 6 m, 0 deg]}}}\n"
      "containers:\n"
      "  sim: {components: [world, a]}\n"
      "  other: {components: [b]}\n",
      "sim");
  run.wait_for("] heard ");
  const auto call = [&](const std::string& what) {
    return run_line(KERVAN_PROGRAM, "container call sim world " + what + " --timeout 60s", run.folder());
  };
  EXPECT_EQ(call("pause").out, "world  sim/world  degraded  paused on request\n");
  run.wait_for("paused on request");
  EXPECT_EQ(call("step steps=10").code, 0);
  EXPECT_EQ(call("teleport robot=r1 pose='[12 m, 6 m, 90 deg]'").code, 0);
  const Result refused = call("teleport robot=r1 pose='[0 m, 6 m, 90 deg]'");
  EXPECT_EQ(refused.code, 1);
  EXPECT_EQ(refused.err, "refused by container 'sim': 'r1' would stand in an obstacle of hall\n");
  EXPECT_EQ(call("resume").out, "world  sim/world  active\n");
  EXPECT_EQ(call("resume").out, "already running\nworld  sim/world  active\n");
  run.signal(SIGTERM);
  run.wait();
}

TEST(ContainerVerbUsage, IsNamedWhenItIsWrong) {
  const Folder folder;
  const auto says = [&](const std::string& arguments) {
    const Result result = run_line(KERVAN_PROGRAM, "container " + arguments, folder.path());
    EXPECT_EQ(result.code, 2) << arguments;
    return result.err;
  };
  EXPECT_EQ(
      says("list"),
      "no run with a container to ask is under way in runs; name one with --run FOLDER, or a domain with --domain "
      "ID (a lockstep run in one container has no network and cannot be asked)\n");
  EXPECT_EQ(says("list --run ."),
            "--run .: there is no specification of a container in it; name the folder of a run, such as runs/lab-…\n");
  EXPECT_EQ(says("list --timeout 5"), "--timeout 5: 5 has no unit; write e.g. 5 s\n");
  EXPECT_EQ(says("list --domain 900"), "--domain 900: 900 is out of range; allowed: 0 .. 232\n");
  EXPECT_EQ(says("set brain r1/control speed --domain 3"),
            "'speed' is no value of a parameter; write e.g. speed=\"0.4 m/s\"\n");
  EXPECT_EQ(says("call sim world spawn r2 --domain 3"), "'r2' is no value of an argument; write e.g. robot=r1\n");
  EXPECT_EQ(says(""),
            "kervan container: what to ask is missing: list, state, load, unload, activate, deactivate, set, call or "
            "snapshot; "
            "see kervan container --help\n");
}

}  // namespace
}  // namespace kervan::test
