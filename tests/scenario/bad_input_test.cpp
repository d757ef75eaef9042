// Everything a person can get wrong: one line that says where and what is allowed, exit code 2, and nothing written.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

namespace fs = std::filesystem;

class BadInput : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << text;
  }

  Result kervan(std::vector<std::string> arguments) const {
    return run({KERVAN_PROGRAM, std::move(arguments), environment_}, folder_.path());
  }

  /// The message's beginning is enough: lists of what is allowed grow.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& message) const {
    const auto before = folder_.everything_in_it();
    const Result result = kervan(arguments);
    EXPECT_EQ(result.code, 2) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err.substr(0, message.size()), message);
    EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
    EXPECT_EQ(folder_.everything_in_it(), before) << "something was written";
  }

  const fs::path& path() const { return folder_.path(); }

  std::map<std::string, std::string> environment_ = {{"KERVAN_COMPONENT_PATH", SCENARIO_COMPONENTS}};

 private:
  Folder folder_;
};

/// One mistake in the good composition: `wrong` stands where `right` stood. The message begins with "c.yaml:".
struct Mistake {
  const char* name;
  std::string right, wrong;
  const char* message;
};

std::ostream& operator<<(std::ostream& out, const Mistake& mistake) { return out << mistake.wrong; }

class Spoilt : public BadInput, public testing::WithParamInterface<Mistake> {};

TEST_P(Spoilt, CompositionIsRefusedAtItsPlace) {
  std::string text = text_of(SCENARIO_TESTS "/compositions/one_robot.yaml");
  const auto at = text.find(GetParam().right);
  ASSERT_NE(at, std::string::npos) << "one_robot.yaml has changed";
  text.replace(at, GetParam().right.size(), GetParam().wrong);
  write("c.yaml", text);
  expect_refused({"run", "c.yaml"}, std::string("c.yaml:") + GetParam().message);
}

const Mistake mistakes[] = {
    {"UnknownComponent", "control/route_follower", "control/rout_follower",
     "17:24: type: there is no component type 'control/rout_follower'; did you mean 'control/route_follower'? there "
     "are: "},
    {"UnknownPort", "remap: {command: cmd_vel}", "remap: {comand: cmd_vel}",
     "20:90: scenario/command_recorder has no port 'comand'; did you mean 'command'? it has: command"},
    {"UnknownParameter", "rho0: 1.0 m", "rho: 1.0 m",
     "18:81: control/potential_field has no parameter 'rho'; did you mean 'rho0'? it has: period, "},
    {"WrongType", "rho0: 1.0 m", "rho0: far",
     "18:87: rho0: 'far' is not a length; write a number and a unit, e.g. 1 m"},
    {"NoUnit", "rho0: 1.0 m", "rho0: 1.0", "18:87: rho0: 1.0 has no unit; write e.g. 1.0 m"},
    {"WrongUnit", "rho0: 1.0 m", "rho0: 1.0 s", "18:87: rho0: 1.0 s is not a length; allowed units: m, cm, mm, km"},
    {"OutOfRange", "rho0: 1.0 m", "rho0: 100 m", "18:87: rho0: 100 m is out of range; allowed: 0.05 .. 10 m"},
    {"MissingWorld", "worlds/lab.yaml", "worlds/lob.yaml",
     "25:12: map: there is no file worlds/lob.yaml; looked for worlds/lob.yaml, "},
    {"MissingRobotModel", "robots/p3dx.yaml", "robots/p3xd.yaml",
     "27:28: model: there is no file robots/p3xd.yaml; looked for robots/p3xd.yaml, "},
    {"PortOfAnotherType", "world: world/outline", "world: world/r1/odom",
     "29:77: the topic '/r1/odom' is written by world.r1/odom (c.yaml:27:16) as nav_msgs::msg::Odometry, but read by "
     "report.world (c.yaml:29:77) as kervan_msgs::msg::Outline"},
    {"RobotThatTheWorldDoesNotHave", "goals: {r1: ", "goals: {r2: ",
     "14:7: nothing writes '/r1/goal', which r1/planner.goal needs; did you mean '/r2/goal'?; and 1 more error, see "
     "kervan check c.yaml"},
    {"RecordedRobotThatTheWorldDoesNotHave", "{robots: [r1]}", "{robots: [r1, r9]}",
     "29:60: nothing writes '/r9/truth', which report.r9/truth needs; did you mean '/r1/truth'?"},
    {"RobotRecordedTwice", "{robots: [r1]}", "{robots: [r1, r1]}",
     "29:60: robots[1]: 'r1' is there already; name each robot once"},
    {"RobotNameThatIsNoTopic", "robots: {r1: ", "robots: {\"r 1\": ",
     "27:16: '/r 1/cmd_vel' is not a topic, so world.r 1/cmd_vel cannot be one; use names of letters, digits and _"},
    {"StartInAWall", "start: [0 m, 0 m, 0 deg]", "start: [16.4 m, 8 m, 0 deg]",
     "27:53: robots.r1.start: the robot would stand in an obstacle of lab"},
    {"StartBeyondTheWorld", "start: [0 m, 0 m, 0 deg]", "start: [1e300 m, 8 m, 0 deg]",
     "27:53: start: [0]: 1e+300 is out of range; allowed: -1e+06 .. 1e+06"},
    {"EdgeToAnUnknownNode", "[1, 2]]", "[1, 3]]", "16:82: edges[1]: node 3 does not exist; there are 3 nodes"},
    {"EdgeToANegativeNode", "[1, 2]]", "[1, -1]]", "16:82: edges[1]: there is no node -1; nodes are counted from 0"},
    {"GoalThatIsNoNumber", "at: [[16.0 m, 7.8 m]]", "at: [[nan, 7.8 m]]",
     "30:30: at[0][0]: 'nan' is not a length; write a number and a unit, e.g. 1 m"},
    {"GoalOutsideOfEverything", "at: [[16.0 m, 7.8 m]]", "at: [[1e308 km, 7.8 m]]", "30:30: at[0][0]: "},
    {"NoGoal", "at: [[16.0 m, 7.8 m]]", "at: []",
     "30:28: goals.r1.at: there is no goal in it; write e.g. [[1 m, 2 m]]"},
    {"TwoMissions", "mission: {", "mission: {goals: {}}\nmission: {",
     "31:1: duplicate key 'mission'; it was first given at line 30"},
    {"MissionBesideAComponentOfThatName", "  report: {", "  mission: {",
     "30:1: 'mission' is a component already (c.yaml:29:3); keep one of the two"},
    {"NameOfDots", "name: one_robot", "name: ..", "4:7: name: .. is not a name for a composition; "},
    {"NameWithASlash", "name: one_robot", "name: ../x", "4:7: name: ../x is not a name for a composition; "},
    {"NameThatLooksLikeAnOption", "name: one_robot", "name: -rf", "4:7: name: -rf is not a name for a composition; "},
    {"NameWithALineBreak", "name: one_robot", "name: \"a\\nb\"",
     "4:7: name: \"a b\" is not a name for a composition; "},
    {"NoName", "name: one_robot", "name:", "4:1: name: expected a text, found nothing"},
    {"TabInTheIndentation", "  robot:\n", "\trobot:\n", "12:1: a tab indents this line; use spaces"},
};

INSTANTIATE_TEST_SUITE_P(Mistake, Spoilt, testing::ValuesIn(mistakes),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_F(BadInput, TheUnspoiltCompositionIsGood) {
  const Result result = kervan({"check", SCENARIO_TESTS "/compositions/one_robot.yaml"});
  EXPECT_EQ(result.code, 0) << result.err;
}

TEST_F(BadInput, OfWindowsLineEndsAndAByteOrderMarkIsNoMistake) {
  std::string text = "\xef\xbb\xbf";
  for (const std::string& line : lines_of(text_of(SCENARIO_TESTS "/compositions/one_robot.yaml")))
    text += line + "\r\n";
  write("c.yaml", text);
  EXPECT_EQ(kervan({"check", "c.yaml"}).code, 0);
}

TEST_F(BadInput, FilesThatAreNoComposition) {
  write("list.yaml", "- kervan\n- 1\n");
  expect_refused({"run", "list.yaml"}, "list.yaml:1:1: a composition is a map that begins with 'kervan: 1'\n");
  write("empty.yaml", "");
  expect_refused({"run", "empty.yaml"}, "empty.yaml:1:1: the file is empty\n");
  write("binary.yaml", std::string("kervan: \x7f\0\x01", 11));
  expect_refused({"run", "binary.yaml"}, "binary.yaml:1:10: this is not a text file\n");
  fs::create_directory(path() / "folder.yaml");
  expect_refused({"run", "folder.yaml"}, "folder.yaml: this is a folder; name a file, or a shipped composition\n");
  expect_refused({"run", "./"}, "./: this is a folder; ");
  fs::create_symlink("/nowhere", path() / "link.yaml");
  expect_refused({"run", "link.yaml"}, "link.yaml: there is no such file\n");
  write("here.yaml", "");
  expect_refused({"run", "here"}, "there is no composition 'here'; a file is named with its ending: here.yaml\n");
  expect_refused({"run", ""}, "there is no composition ''; there are: ");
}

TEST_F(BadInput, FileThatMayNotBeRead) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may read every file";
  write("c.yaml", "kervan: 1\n");
  fs::permissions(path() / "c.yaml", fs::perms::none);
  expect_refused({"run", "c.yaml"}, "c.yaml: cannot read the file: Permission denied\n");
}

TEST_F(BadInput, MalformedWorlds) {
  write("c.yaml", "kervan: 1\nname: c\ncomponents: {a: {type: sim/world, params: {map: world.yaml}}}\n");
  const std::string world = (fs::canonical(path()) / "world.yaml").string();
  const auto expect = [&](const std::string& text, const std::string& message) {
    write("world.yaml", text);
    expect_refused({"run", "c.yaml"}, world + ":" + message + "\n");
  };
  expect("", "1:1: the file is empty");
  expect("name: w\n", "1:1: the key 'kervan_world' is missing");
  expect("kervan_world: 2\nname: w\n", "1:15: kervan_world: 2 is not a known version of this format; allowed: 1");
  expect("kervan_world: 1\nname: w\ncircles: [{center: [0 m, 0 m], radius: -1 m}]\n",
         "3:40: radius: -1 m is out of range; allowed: above 0, at most 1000000 m");
  expect("kervan_world: 1\nname: w\nsegments: [[[0 m, 0 m], [0 m, 0 m]]]\n",
         "3:12: segments[0]: both ends of the segment are the same point; a segment needs a length");
  fs::remove(path() / "world.yaml");
  fs::create_directory(path() / "world.yaml");
  expect_refused({"run", "c.yaml"}, "c.yaml:3:49: map: there is no file world.yaml; looked for world.yaml, ");
}

TEST_F(BadInput, Arguments) {
  expect_refused({"run", "lab", "--arg", "sead=1"},
                 "--arg sead=1: the composition has no argument 'sead'; did you mean 'seed'? it has: controller, ");
  expect_refused({"run", "lab", "--arg", "seed"}, "--arg seed: write --arg name=value\n");
  expect_refused({"run", "lab", "--arg", "seed="}, "--arg seed=: expected an integer: '' is not a number\n");
  expect_refused({"run", "lab", "--arg", "=1"}, "--arg =1: the composition has no argument ''; it has: controller, ");
  expect_refused({"run", "lab", "--arg", ""}, "kervan run: --arg: the value is empty; see kervan run --help\n");
  expect_refused({"run", "lab", "--arg"}, "kervan run: --arg: 1 required NAME=VALUE missing; see kervan run --help\n");
  expect_refused({"run", "lab", "--arg", "drift=nan"}, "--arg drift=nan: 'nan' is not a number\n");
  expect_refused({"run", "lab", "--arg", "seed=1", "--arg", "seed=2"},
                 "--arg seed=2: 'seed' is given twice; keep one of the two\n");
}

TEST_F(BadInput, Options) {
  expect_refused({"run", "lab", "--for", "0"}, "--for 0: 0 has no unit; write e.g. 0 s\n");
  expect_refused({"run", "lab", "--for", "0s"}, "--for 0s: the time must be longer than 0 s\n");
  expect_refused({"run", "lab", "--for", "-1s"}, "--for -1s: the time must be longer than 0 s\n");
  expect_refused({"run", "lab", "--for", ""}, "kervan run: --for: the value is empty; see kervan run --help\n");
  expect_refused({"run", "lab", "--threads", "0"}, "--threads 0: 0 is out of range; allowed: 1 .. 64\n");
  expect_refused({"run", "lab", "--threads", "-1"}, "--threads -1: -1 is out of range; allowed: 1 .. 64\n");
  expect_refused({"run", "lab", "--threads", "10000"}, "--threads 10000: 10000 is out of range; allowed: 1 .. 64\n");
  expect_refused({"run", "lab", "--threads", "two"}, "--threads two: expected an integer: 'two' is not a number\n");
  expect_refused({"run", "lab", "--place", "none"},
                 "--place none: write --place all, --place each or --place CONTAINER=COMPONENT,COMPONENT");
  expect_refused({"run", "lab", "lab"},
                 "kervan run: The following argument was not expected: lab; see kervan run --help\n");
  expect_refused({"run"}, "kervan run: a composition is missing; name a shipped one, such as lab, or a file; see ");
  expect_refused(
      {}, "a command is missing: run, sweep, check, describe, draw, container, systemd, link; see kervan --help\n");
  expect_refused({"--nonsense"}, "kervan: ");
  expect_refused(
      {"rnu", "lab"},
      "there is no command 'rnu'; did you mean 'run'? commands: run, sweep, check, describe, draw, container, "
      "systemd, link\n");
  expect_refused({"describe", "magic/wand"}, "there is no component type 'magic/wand'; there are: ");
}

TEST_F(BadInput, FoldersThatAreNotThereOrCannotBeWritten) {
  write("file", "");
  expect_refused({"run", "lab", "--runs", "file"}, "--runs file: cannot make the folder: Not a directory\n");
  expect_refused({"run", "lab", "--runs", "file/below"},
                 "--runs file/below: cannot make the folder: Not a directory\n");
  expect_refused({"run", "lab", "--runs", "/proc"}, "--runs /proc: cannot make a folder in it: ");
  expect_refused({"run", "lab", "--runs", ""}, "kervan run: --runs: the value is empty; see kervan run --help\n");
  expect_refused({"run", "lab", "--runs", "a/" + std::string(300, 'b')}, "--runs a/bbb");
  environment_["KERVAN_COMPONENT_PATH"] = SCENARIO_COMPONENTS ":/nowhere";
  expect_refused({"run", "lab"}, "KERVAN_COMPONENT_PATH: there is no folder '/nowhere'\n");
  environment_ = {{"KERVAN_SHARE", "/nowhere"}};
  expect_refused({"run", "lab"}, "KERVAN_SHARE: there is no folder '/nowhere'\n");
}

TEST_F(BadInput, ModulesThatHoldNoComponent) {
  fs::create_directories(path() / "modules" / "x");
  write("modules/x/text.so", "this is no module");
  fs::copy_file(SCENARIO_COMPONENTS "/scenario/command_recorder.so", path() / "modules/x/other.so");
  environment_["KERVAN_COMPONENT_PATH"] = (path() / "modules").string();
  const auto expect = [&](const std::string& type, const std::string& message) {
    write("c.yaml", "kervan: 1\nname: c\ncomponents: {a: {type: " + type + "}}\n");
    expect_refused({"run", "c.yaml"}, "c.yaml:3:24: type: '" + type + "' cannot be used: " + message);
  };
  expect("x/text", "cannot load the module of x/text: " + (path() / "modules/x/text.so").string() + ": ");
  expect("x/other",
         (path() / "modules/x/other.so").string() + " holds the component scenario/command_recorder, not x/other");
}

TEST_F(BadInput, IsAnObjectForScriptsToo) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"run", "lab", "--json", "--nonsense"},
                                                    {"run", "--json"},
                                                    {"rnu", "--json"},
                                                    {"check", "lab", "--json", "--arg", "\xff\xfe=1"}}) {
    const Result result = kervan(arguments);
    EXPECT_EQ(result.code, 2);
    EXPECT_TRUE(result.out.starts_with(R"({"result":"error","error":{"message":")")) << result.out;
    EXPECT_EQ(lines_of(result.out).size(), 1u);
    EXPECT_EQ(lines_of(result.err).size(), 1u);
  }
}

}  // namespace
}  // namespace kervan::test
