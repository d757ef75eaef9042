#include "components/observe/mission_memory.hpp"

#include <gtest/gtest.h>

namespace kervan::observe {
namespace {

using namespace std::chrono_literals;

TEST(MissionMemory, IsReadBackToTheLastBit) {
  const MissionMemories memories{
      {"r1", {.start = Time(-3ns), .goal = 2, .path = 1.0 / 3.0, .contacts = 7, .min_clearance = 0.1}},
      {"r2", {.start = Time(1795421684s), .goal = 0, .path = 0.0, .contacts = 0, .min_clearance = std::nullopt}}};
  const auto read = memories_of(to_text(memories));
  ASSERT_TRUE(read);
  ASSERT_EQ(read->size(), 2u);
  for (const auto& [robot, memory] : memories) {
    const MissionMemory& again = read->at(robot);
    EXPECT_EQ(again.start, memory.start);
    EXPECT_EQ(again.goal, memory.goal);
    EXPECT_EQ(again.path, memory.path);
    EXPECT_EQ(again.contacts, memory.contacts);
    EXPECT_EQ(again.min_clearance, memory.min_clearance);
  }
}

TEST(MissionMemory, RefusesWhatItHasNotWritten) {
  for (const char* text : {"", "kervan_mission 2\n", "kervan_mission 1\nr1\n", "kervan_mission 1\nr1 1 2 x 4\n",
                           "kervan_mission 1\nr1 1 -2 3 4\n", "kervan_mission 1\nr1 1 2 3 4 nonsense\n"})
    EXPECT_FALSE(memories_of(text)) << text;
  EXPECT_TRUE(memories_of("kervan_mission 1\n"));
}

}  // namespace
}  // namespace kervan::observe
