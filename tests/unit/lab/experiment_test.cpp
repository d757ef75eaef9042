#include "deploy/lab/experiment.hpp"

#include <gtest/gtest.h>

#include <set>

#include "deploy/lab/experiment_file.hpp"

using namespace kervan;
using namespace kervan::lab;

namespace {

Experiment parsed(const std::string& rest) {
  return parse_experiment("kervan_sweep: 1\nname: s\ncomposition: lab\n" + rest, "s.yaml", ".");
}

/// What is said about the three lines above and `rest`.
std::string refusal(const std::string& rest) {
  try {
    parsed(rest);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "it was taken";
}

const std::string responses = "responses: {time: robots.r1.time_s, reached: robots.r1.reached}\n";

std::vector<std::string> names(const Experiment& experiment) {
  std::vector<std::string> names;
  for (const Cell& cell : cells(experiment)) names.push_back(cell.name);
  return names;
}

TEST(Matrix, IsEveryCombinationWithTheLastFactorFastest) {
  const Experiment experiment = parsed("matrix: {controller: [a, b], seed: 1..3}\n" + responses);
  EXPECT_EQ(names(experiment),
            (std::vector<std::string>{"controller=a,seed=1", "controller=a,seed=2", "controller=a,seed=3",
                                      "controller=b,seed=1", "controller=b,seed=2", "controller=b,seed=3"}));
}

TEST(Matrix, GivesEachRunItsValues) {
  const Experiment experiment =
      parsed("set: {drift: 0.002, w: 1}\nmatrix: {w: [2], r1/control.params.rho0: [0.5 m, 1 m]}\n" + responses);
  const auto settings = settings_of(experiment, cells(experiment)[1]);
  ASSERT_EQ(settings.size(), 3u);
  EXPECT_EQ(settings[0].name + "=" + settings[0].text, "drift=0.002");
  EXPECT_EQ(settings[1].name + "=" + settings[1].text, "w=2") << "a factor's value is over one of all runs";
  EXPECT_EQ(settings[2].name + "=" + settings[2].text, "r1/control.params.rho0=1 m");
}

TEST(Matrix, HasLevelsOfSeveralSettings) {
  const Experiment experiment =
      parsed("matrix: {arm: {paper: {avoidance: none}, ours: {avoidance: vfh_plus, replan: true}}}\n" + responses);
  EXPECT_EQ(names(experiment), (std::vector<std::string>{"arm=paper", "arm=ours"}));
  EXPECT_EQ(settings_of(experiment, cells(experiment)[0]).size(), 1u);
  EXPECT_EQ(settings_of(experiment, cells(experiment)[1]).size(), 2u);
  EXPECT_EQ(describe(experiment, cells(experiment)[1]), "arm=ours");
}

TEST(Matrix, NamesFoldersSoThatTheyDiffer) {
  const Experiment experiment =
      parsed("matrix: {world: [worlds/a b.yaml, worlds/a_b.yaml, worlds/ab.yaml]}\n" + responses);
  const auto all = names(experiment);
  EXPECT_EQ(std::set<std::string>(all.begin(), all.end()).size(), 3u);
  for (const auto& name : all) EXPECT_EQ(name.find('/'), std::string::npos) << name;
}

TEST(Matrix, HasListsAsValues) {
  const Experiment experiment = parsed("matrix: {start: [[1 m, 2 m, 90 deg], [0 m, 0 m, 0 deg]]}\n" + responses);
  EXPECT_EQ(experiment.factors[0].levels[0].label, "[1 m, 2 m, 90 deg]");
  EXPECT_EQ(flow_text(experiment.factors[0].levels[0].settings[0]), "[1 m, 2 m, 90 deg]");
}

TEST(Sweep, GroupsByAllFactorsButTheSeedUnlessTold) {
  const Experiment experiment = parsed("matrix: {controller: [a, b], seed: 1..3}\n" + responses);
  EXPECT_EQ(experiment.table.rows, (std::vector<std::string>{"controller"}));
  EXPECT_TRUE(experiment.table.columns.empty());
  EXPECT_EQ(experiment.table.responses, (std::vector<std::string>{"time", "reached"}));
}

TEST(Sweep, RefusesWhatIsWrittenWronglyAtItsPlace) {
  const std::string matrix = "matrix: {controller: [a, b], seed: 1..3}\n";
  EXPECT_EQ(refusal(matrix), "s.yaml:1:1: the key 'responses' is missing");
  EXPECT_EQ(
      refusal("matirx: {}\n" + responses),
      "s.yaml:4:1: unknown key 'matirx'; did you mean 'matrix'? allowed: kervan_sweep, name, help, composition, for, "
      "wall_limit, set, matrix, responses, table, compare, overlay");
  EXPECT_EQ(refusal("for: 300\n" + matrix + responses), "s.yaml:4:6: for: 300 has no unit; write e.g. 300 s");
  EXPECT_EQ(refusal("for: 0s\n" + matrix + responses), "s.yaml:4:6: for: 0s is out of range; allowed: more than 0 s");
  EXPECT_EQ(refusal("matrix: {seed: 1}\n" + responses),
            "s.yaml:4:16: seed: expected a list of values, a range such as 1..20, or a map of named levels, found 1");
  EXPECT_EQ(refusal("matrix: {seed: 3..1}\n" + responses), "s.yaml:4:16: seed: the range 3..1 is empty");
  EXPECT_EQ(refusal("matrix: {seed: 1..9000000000}\n" + responses),
            "s.yaml:4:16: seed: the range 1..9000000000 is too long; allowed: at most 100000 values");
  EXPECT_EQ(refusal("matrix: {a: 1..1000, b: 1..1000}\n" + responses),
            "s.yaml:4:1: the matrix makes too many runs; allowed: at most 100000");
  EXPECT_EQ(refusal("matrix: {seed: []}\n" + responses), "s.yaml:4:16: seed: there must be at least one value");
  EXPECT_EQ(refusal("matrix: {}\n" + responses), "s.yaml:4:9: matrix: there must be at least one factor");
  EXPECT_EQ(refusal("matrix: {seed: [1, 2, 1]}\n" + responses),
            "s.yaml:4:16: seed: the value 1 is there twice; keep one of the two");
  EXPECT_EQ(refusal("matrix: {arm: {a: {w: 1}}, w: [1]}\n" + responses),
            "s.yaml:4:28: 'w' is given by the factor 'arm' already");
  EXPECT_EQ(refusal(matrix + "responses: {}\n"), "s.yaml:5:12: responses: there must be at least one response");
  EXPECT_EQ(refusal(matrix + "responses: {t: {figrue: x}}\n"),
            "s.yaml:5:17: unknown key 'figrue'; did you mean 'figure'? allowed: figure, unit, is, optional");
  EXPECT_EQ(
      refusal(matrix + responses + "table: {rows: [contoller]}\n"),
      "s.yaml:6:16: rows[0]: there is no factor 'contoller'; did you mean 'controller'? there are: controller, seed");
  EXPECT_EQ(refusal(matrix + responses + "table: {rows: [seed], columns: [seed]}\n"),
            "s.yaml:6:33: columns[0]: 'seed' makes the rows already");
  EXPECT_EQ(refusal(matrix + responses + "compare: {factor: controller, to: c}\n"),
            "s.yaml:6:35: to: 'controller' has no value c; it has: a, b");
  EXPECT_EQ(refusal(matrix + responses + "compare: {factor: controller, to: a, responses: [tiem]}\n"),
            "s.yaml:6:50: responses[0]: there is no response 'tiem'; did you mean 'time'? there are: time, reached");
  EXPECT_EQ(refusal(matrix + responses + "overlay: {by: [seed], colour: seed}\n"),
            "s.yaml:6:31: colour: 'seed' is one of 'by', so each picture would have one colour");
}

}  // namespace
