// Worlds with traps in them: in each the robot reaches its goal, or gives it up and says why. It plans over what its
// laser has shown, or drives straight towards its goal on a force field, with nothing but control/recovery to get it
// free.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

constexpr const char* reached = "";
// How the reason of one that gives up begins.
constexpr const char* no_route = "r1 has given up: no route: no free way leads from the robot to the goal";
constexpr const char* trapped =
    "r1 has given up: trapped: the robot stands though it has somewhere to go, and nothing has "
    "helped: forgetting, a new plan, ";
constexpr const char* too_long = "r1 has given up: the goal was not reached within 280.0 s";

struct TrapWorld {
  const char *name, *planned, *straight;
};

std::ostream& operator<<(std::ostream& out, const TrapWorld& world) { return out << world.name; }

constexpr TrapWorld traps[] = {
    {"u_shallow", reached, reached},    {"u_deep", reached, reached},        {"u_narrow", reached, reached},
    {"u_behind", reached, too_long},    {"u_around", reached, reached},      {"v_shape", reached, trapped},
    {"corner", reached, reached},       {"dead_end", reached, reached},      {"double_u", reached, reached},
    {"spiral", reached, trapped},       {"comb", reached, reached},          {"slit", reached, trapped},
    {"narrow_door", reached, trapped},  {"zigzag", reached, trapped},        {"corridor", reached, trapped},
    {"closed_goal", no_route, trapped}, {"closed_start", no_route, trapped}, {"door_closes", reached, reached},
    {"door_locks", no_route, trapped},  {"door_opens", reached, reached},    {"two_doors", reached, reached},
    {"cart_waits", reached, reached},   {"cart_patrols", reached, reached},
};

class Traps : public testing::TestWithParam<TrapWorld> {
 protected:
  static void expect(const char* way, const std::string& reason, double most_contacts) {
    const Folder folder;
    const std::string world = GetParam().name;
    const Result result = run({KERVAN_PROGRAM,
                               {"run", SCENARIO_TESTS "/compositions/traps.yaml", "--json", "--arg", "world=" + world,
                                "--arg", std::string("way=") + way}},
                              folder.path());
    ASSERT_EQ(lines_of(result.out).size(), 1u) << result.out << result.err;
    const auto summary = nlohmann::json::parse(result.out);
    const auto& robot = summary["robots"]["r1"];
    EXPECT_EQ(summary["result"], reason.empty() ? "success" : "failed") << summary;
    EXPECT_EQ(robot["reached"], reason.empty()) << summary;
    EXPECT_EQ(summary.value("reason", "").substr(0, reason.size()), reason) << summary;
    EXPECT_LE(robot["contacts"], most_contacts) << summary;
  }
};

TEST_P(Traps, LetARobotWithAPlanReachItsGoalOrGiveItUp) { expect("planned", GetParam().planned, 0); }

// A wall's end that its sonars miss may be touched.
TEST_P(Traps, LetARobotWithoutAPlanReachItsGoalOrGiveItUp) { expect("straight", GetParam().straight, 1); }

INSTANTIATE_TEST_SUITE_P(Scenario, Traps, testing::ValuesIn(traps),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace kervan::test
