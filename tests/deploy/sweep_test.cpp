// kervan sweep as a person meets it: what it refuses, what remains of it, and how it goes on.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/program/eventually.hpp"
#include "tests/program/program.hpp"

namespace fs = std::filesystem;

namespace kervan::test {
namespace {

class Sweep : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_.path() / name) << text; }

  Command command(std::vector<std::string> arguments) const {
    return {KERVAN_PROGRAM,
            std::move(arguments),
            {{"KERVAN_COMPONENT_PATH", TEST_COMPONENTS}, {"KERVAN_SHARE", KERVAN_SHARE_FOLDER}}};
  }
  Result kervan(std::vector<std::string> arguments) const { return run(command(std::move(arguments)), folder_.path()); }

  /// Refused with exit code 2 in one line, and nothing was made.
  void expect_refused(const std::string& sweep, const std::string& message) const {
    write("s.yaml", sweep);
    const Result result = kervan({"sweep", "s.yaml"});
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(result.err, message + "\n");
    EXPECT_FALSE(fs::exists(folder_.path() / "sweeps"));
  }

  /// The names of the shipped compositions, as messages list them.
  static std::string shipped() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(fs::path(KERVAN_SHARE_FOLDER) / "compositions"))
      names.push_back(entry.path().stem().string());
    std::ranges::sort(names);
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    return list;
  }

  std::string text(const std::string& file) const { return text_of(folder_.path() / file); }

  Folder folder_;
};

/// Two seconds of the laboratory.
std::string lab(const std::string& matrix, const std::string& more = "") {
  return "kervan_sweep: 1\nname: two\ncomposition: lab\nfor: 2s\nmatrix: " + matrix +
         "\nresponses: {path: {figure: robots.r1.path_m, unit: m}, trace: trace_hash}\n" + more;
}

std::vector<std::string> column(const std::string& csv, std::size_t index) {
  std::vector<std::string> values;
  for (const std::string& line : lines_of(csv)) {
    std::string rest = line;
    for (std::size_t i = 0; i < index; ++i) rest = rest.substr(rest.find(',') + 1);
    values.push_back(rest.substr(0, rest.find(',')));
  }
  return values;
}

TEST_F(Sweep, MakesTheRunsThatKervanRunMakes) {
  write("s.yaml",
        lab("{controller: [potential_classic, potential_gecui], seed: 1..2}", "overlay: {by: [], colour: seed}\n"));
  const Result result = kervan({"sweep", "s.yaml", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const auto object = nlohmann::json::parse(result.out);
  EXPECT_EQ(object["result"], "success");
  EXPECT_EQ(object["runs"], 4);
  for (const char* file : {"README.md", "runs.csv", "table.csv", "bars-path.svg", "paths-1.svg",
                           "runs/controller=potential_gecui,seed=2/map.svg"})
    EXPECT_TRUE(fs::exists(folder_.path() / "sweeps/two" / file)) << file;
  const Result alone =
      kervan({"run", "lab", "--arg", "seed=2", "--arg", "controller=potential_gecui", "--for", "2s", "--json"});
  const auto summary = nlohmann::json::parse(alone.out);
  EXPECT_EQ(column(text("sweeps/two/runs.csv"), 3).at(4), summary["trace_hash"]);
  const std::string page = text("sweeps/two/README.md");
  EXPECT_NE(page.find("4 runs of the composition `lab`.\n"), std::string::npos) << page;
  EXPECT_NE(page.find("![path](bars-path.svg)"), std::string::npos) << page;
  EXPECT_NE(page.find("(paths-1.svg)"), std::string::npos) << page;
}

TEST_F(Sweep, SetsParametersAsKervanRunDoes) {
  write("s.yaml", lab("{r1/control.params.speed: [0.2 m/s, 0.4 m/s]}"));
  ASSERT_EQ(kervan({"sweep", "s.yaml"}).code, 0);
  const Result alone = kervan({"run", "lab", "--set", "r1/control.params.speed=0.4 m/s", "--for", "2s", "--json"});
  ASSERT_EQ(alone.code, 1) << "the mission is not over after two seconds";
  const auto traces = column(text("sweeps/two/runs.csv"), 2);
  EXPECT_EQ(traces.at(2), nlohmann::json::parse(alone.out)["trace_hash"]);
  EXPECT_NE(traces.at(1), traces.at(2));
}

/// The paper's opening finder weighs three angles, of which only the ratios count.
TEST_F(Sweep, ShowsThatEqualRatiosOfWeightsDriveAlikeToTheLastBit) {
  write("s.yaml",
        "kervan_sweep: 1\nname: ratios\ncomposition: 22_vfh_weights\nfor: 30s\n"
        "matrix:\n  weights: {1 1 1: {a: 1, b: 1, c: 1}, 2 2 2: {a: 2, b: 2, c: 2}, 3 3 3: {a: 3, b: 3, c: 3}, "
        "3 1 1: {a: 3, b: 1, c: 1}}\n  seed: 1..2\n"
        "responses: {trace: trace_hash}\n");
  ASSERT_EQ(kervan({"sweep", "s.yaml"}).code, 0);
  const auto traces = column(text("sweeps/ratios/runs.csv"), 2);
  ASSERT_EQ(traces.size(), 9u);
  for (const std::size_t seed : {1u, 2u}) {
    EXPECT_EQ(traces[seed], traces[seed + 2]);
    EXPECT_EQ(traces[seed], traces[seed + 4]);
    EXPECT_NE(traces[seed], traces[seed + 6]);
  }
  EXPECT_NE(traces[1], traces[2]);
}

TEST_F(Sweep, BeginsWithEveryShippedOne) {
  for (const auto& entry : fs::directory_iterator(fs::path(KERVAN_SHARE_FOLDER) / "experiments")) {
    const std::string name = entry.path().stem().string();
    SCOPED_TRACE(name);
    Process sweep(command({"sweep", name, "--jobs", "1"}), folder_.path());
    const fs::path runs = folder_.path() / "sweeps" / name / "runs";
    const auto one_is_done = [&] {
      std::error_code none;
      for (const auto& run : fs::directory_iterator(runs, none))
        if (fs::exists(run.path() / "cell.json")) return true;
      return false;
    };
    EXPECT_TRUE(eventually(one_is_done));
    sweep.signal(SIGINT);
    const Result result = sweep.wait();
    EXPECT_EQ(result.code, 130) << result.err;
    EXPECT_EQ(result.err.find("failed"), std::string::npos) << result.err;
  }
}

TEST_F(Sweep, GoesOnWhereItWasInterruptedAndComesToTheSameTable) {
  write("s.yaml", lab("{seed: 1..30}"));
  {
    Process interrupted(command({"sweep", "s.yaml", "--jobs", "1"}), folder_.path());
    const fs::path first = folder_.path() / "sweeps/two/runs/seed=1/cell.json";
    ASSERT_TRUE(eventually([&] { return fs::exists(first); }));
    interrupted.signal(SIGINT);
    const Result result = interrupted.wait();
    EXPECT_EQ(result.code, 130);
    EXPECT_NE(result.out.find(" of 30 runs are done; the same command makes the rest\n"), std::string::npos)
        << result.out;
    EXPECT_FALSE(fs::exists(folder_.path() / "sweeps/two/runs.csv"));
  }
  for (const auto& entry : fs::directory_iterator(folder_.path() / "sweeps/two/runs"))
    EXPECT_TRUE(fs::exists(entry.path() / "cell.json")) << entry.path() << " is half a run";
  const Result resumed = kervan({"sweep", "s.yaml"});
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_NE(resumed.out.find(" of them done before"), std::string::npos) << resumed.out;
  ASSERT_EQ(kervan({"sweep", "s.yaml", "--out", "whole"}).code, 0);
  for (const char* file : {"runs.csv", "table.csv", "README.md", "bars-path.svg"})
    EXPECT_EQ(text(std::string("sweeps/two/") + file), text(std::string("whole/") + file)) << file;
}

TEST_F(Sweep, MakesOnlyWhatChanged) {
  const auto kept = [&](const std::string& sweep) {
    write("s.yaml", sweep);
    const Result result = kervan({"sweep", "s.yaml", "--json"});
    EXPECT_EQ(result.code, 0) << result.err;
    return nlohmann::json::parse(result.out)["kept"].get<int>();
  };
  EXPECT_EQ(kept(lab("{seed: 1..3}")), 0);
  EXPECT_EQ(kept(lab("{seed: 1..4}", "table: {rows: [seed]}\n")), 3) << "a seed more";
  EXPECT_EQ(kept("set: {drift: 0.002}\n" + lab("{seed: 1..4}")), 4) << "the default, given";
  EXPECT_EQ(kept("set: {drift: 0.003}\n" + lab("{seed: 1..4}")), 0) << "another drift";
}

TEST_F(Sweep, TellsWhichRunsFailedAndWhyAndGoesOn) {
  write("breaking.yaml",
        "kervan: 1\nname: breaking\nargs:\n  how: {type: enum, values: [segv, hang, nothing]}\n"
        "  where: {type: text, default: timer}\nclock: {mode: lockstep}\n"
        "components:\n  one: {type: test/saboteur, params: {where: \"${where}\", how: \"${how}\"}}\n");
  write("s.yaml",
        "kervan_sweep: 1\nname: breaking\ncomposition: ./breaking.yaml\nfor: 1s\nwall_limit: 1s\n"
        "matrix:\n  what: {crash: {how: segv}, hang: {how: hang}, good: {how: segv, where: nowhere}}\n"
        "responses: {ended: ended}\n");
  Command breaking = command({"sweep", "s.yaml"});
  // AddressSanitizer would make an exit code of the signal.
  breaking.environment["ASAN_OPTIONS"] = "handle_segv=0";
  const Result result = run(breaking, folder_.path());
  EXPECT_EQ(result.code, 1) << result.err;
  EXPECT_EQ(text("sweeps/breaking/runs.csv"),
            "what,ended,state,reason,folder\n"
            "crash,,failed,SIGSEGV,runs/what=crash\n"
            "hang,,failed,it did not end within 1 s and was killed,runs/what=hang\n"
            "good,time limit,done,,runs/what=good\n");
  EXPECT_NE(text("sweeps/breaking/README.md").find("- `what=crash`: SIGSEGV\n"), std::string::npos);
  EXPECT_NE(result.err.find("failed: what=crash: SIGSEGV\n"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("3 runs, 2 failed"), std::string::npos) << result.out;
}

TEST_F(Sweep, IsAloneInItsFolder) {
  write("hanging.yaml",
        "kervan: 1\nname: hanging\nclock: {mode: lockstep}\n"
        "components:\n  one: {type: test/saboteur, params: {where: timer, how: hang}}\n");
  write("s.yaml",
        "kervan_sweep: 1\nname: hanging\ncomposition: ./hanging.yaml\nmatrix: {one.params.how: [hang]}\nresponses: "
        "{ended: ended}\n");
  Process first(command({"sweep", "s.yaml"}), folder_.path());
  ASSERT_TRUE(
      eventually([&] { return fs::exists(folder_.path() / "sweeps/hanging/runs/one.params.how=hang.console"); }));
  const Result second = kervan({"sweep", "s.yaml"});
  EXPECT_EQ(second.code, 2);
  EXPECT_EQ(second.err, "--out sweeps/hanging: another sweep is at work in this folder\n");
  first.signal(SIGTERM);
  EXPECT_EQ(first.wait().code, 143);
}

TEST_F(Sweep, RefusesAFigureThatTheRunsDoNotHaveAfterTheFirstOne) {
  write("s.yaml",
        "kervan_sweep: 1\nname: two\ncomposition: lab\nfor: 1s\nmatrix: {seed: 1..20}\nresponses: {time: "
        "robots.r1.tiem_s}\n");
  const Result result = kervan({"sweep", "s.yaml", "--jobs", "1"});
  EXPECT_EQ(result.code, 2);
  EXPECT_EQ(
      result.err,
      "s.yaml:6:19: the runs have no figure 'robots.r1.tiem_s'; did you mean 'robots.r1.time_s'? they have: ended, "
      "reason, result, robots.r1.contacts, robots.r1.error_m, robots.r1.min_clearance_m, robots.r1.path_m, "
      "robots.r1.reached, robots.r1.time_s, simulated_s, trace_hash, wall_s\n");
  EXPECT_FALSE(fs::exists(folder_.path() / "sweeps/two/runs/seed=20"));
}

TEST_F(Sweep, RefusesWhatTheCompositionDoesNotTakeAtItsPlaceInTheSweep) {
  expect_refused(lab("{sede: 1..3}"),
                 "s.yaml:5:10: the composition 'lab' has no argument 'sede'; did you mean 'seed'? it has: controller, "
                 "seed, drift, waypoints");
  expect_refused(lab("{seed: [1, -1]}"), "s.yaml:5:20: seed: -1 is out of range; allowed: 0 .. 4294967295");
  expect_refused(lab("{controller: [vff]}"),
                 "s.yaml:5:23: controller: vff is not one of potential_classic, potential_gecui");
  expect_refused(lab("{seed: [1]}", "set: {drift: 1}\n"), "s.yaml:7:14: drift: 1 is out of range; allowed: 0 .. 0.5");
  expect_refused(lab("{r1/control.params.rho0: [1 m, 1]}"), "s.yaml:5:40: rho0: 1 has no unit; write e.g. 1 m");
  expect_refused(lab("{r1/contrl.params.rho0: [1 m]}"),
                 "s.yaml:5:10: there is no component 'r1/contrl'; did you mean 'r1/control'? there are: world, "
                 "r1/planner, r1/follower, r1/control, r1/guard, report, mission");
  expect_refused(lab("{r1/control.type: [1 m]}"),
                 "s.yaml:5:10: 'r1/control.type' names no parameter; write r1/control.params.NAME");
  expect_refused(
      "kervan_sweep: 1\nname: x\ncomposition: lba\nmatrix: {seed: [1]}\nresponses: {r: result}\n",
      "s.yaml:3:14: composition: there is no composition 'lba'; did you mean 'lab'? there are: " + shipped());
  expect_refused("kervan_sweep: 1\nname: x\ncomposition: ./c.yaml\nmatrix: {seed: [1]}\nresponses: {r: result}\n",
                 "s.yaml:3:14: composition: there is no file c.yaml");
}

TEST_F(Sweep, RefusesACompositionThatIsWrongOnlyUnderItsValues) {
  write(
      "c.yaml",
      "kervan: 1\nname: c\nargs: {rate: {type: number, unit: s, default: 1 s}, mode: {type: text, default: lockstep}}\n"
      "clock: {mode: \"${mode}\"}\n"
      "components:\n  one: {type: test/saboteur, params: {after: \"${rate}\"}}\n");
  const std::string begin = "kervan_sweep: 1\nname: x\ncomposition: ./c.yaml\n", end = "responses: {r: result}\n";
  expect_refused(
      begin + "matrix: {rate: [1 s, 200 s]}\n" + end,
      "s.yaml:3:14: the run rate=200 s: c.yaml:6:46: after: 200 s is out of range; allowed: 0 .. 100 s (from "
      "${rate})");
  expect_refused(begin + "set: {mode: wall}\nmatrix: {rate: [1 s]}\n" + end,
                 "s.yaml:3:14: composition: 'c' runs under clock wall; a sweep runs in lockstep");
}

TEST_F(Sweep, RefusesPathsOfSeveralWorldsInOnePicture) {
  expect_refused(
      "kervan_sweep: 1\nname: x\ncomposition: 10_wall_follow\n"
      "matrix: {world: [worlds/room.yaml, worlds/corner_90.yaml]}\nresponses: {r: result}\n"
      "overlay: {by: []}\n",
      "s.yaml:6:1: overlay: runs in different worlds would be in one picture; add to 'by' what chooses the "
      "world");
}

TEST_F(Sweep, RefusesWhatTheCommandLineGetsWrong) {
  const auto says = [&](const std::vector<std::string>& arguments) {
    const Result result = kervan(arguments);
    EXPECT_EQ(result.code, 2);
    return result.err;
  };
  EXPECT_EQ(says({"sweep"}),
            "kervan sweep: a sweep is missing; name a shipped one, or a file; see kervan sweep --help\n");
  EXPECT_EQ(says({"sweep", "x.yaml"}), "x.yaml: there is no such file\n");
  EXPECT_EQ(says({"sweep", "gnorn"}).substr(0, 51), "there is no sweep 'gnorn'; did you mean 'gnron'? th");
  EXPECT_EQ(says({"sweep", "gnron", "--jobs", "0"}), "--jobs 0: 0 is out of range; allowed: 1 .. 256\n");
  EXPECT_EQ(says({"run", "lab", "--set", "r1/control.params.rho0"}),
            "--set r1/control.params.rho0: write --set COMPONENT.params.NAME=VALUE\n");
  EXPECT_EQ(says({"run", "lab", "--set", "r1/control.params.rho=1 m"})
                .find("--set r1/control.params.rho=1 m: control/potential_field has no parameter 'rho'; did you mean "
                      "'rho0'? it has: period, "),
            0u);
  EXPECT_EQ(says({"run", "lab", "--set", "world.params.robots.r1.start=[1 m"}),
            "--set world.params.robots.r1.start=[1 m: '[1 m' is no list and no map\n");
  write("something", "");
  EXPECT_EQ(says({"run", "lab", "--out", "."}),
            "--out .: the folder is not empty; name one that is, or one that is not there\n");
  EXPECT_TRUE(fs::exists(folder_.path() / "something"));
}

}  // namespace
}  // namespace kervan::test
