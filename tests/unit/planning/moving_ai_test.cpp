// The queries of movingai.com, a few for each map; kervan_moving_ai_experiment asks them all.
#include "tests/planning/moving_ai.hpp"

#include <gtest/gtest.h>

namespace kervan::planning {
namespace {

class MovingAi : public testing::TestWithParam<int> {};

TEST_P(MovingAi, WaysAreAsShortAsTheyCanBe) {
  const std::vector<std::string> names = test::moving_ai_names();
  if (names.empty())
    GTEST_SKIP() << "there are no test data in " << test::test_data_folder()
                 << "; KERVAN_TEST_DATA may name another folder";
  ASSERT_EQ(names.size(), 9u);
  const std::string& name = names[static_cast<std::size_t>(GetParam())];
  SCOPED_TRACE(name);
  test::MovingAiMap file = test::moving_ai_map(name);
  const Costmap map = test::bare_costmap(file.cells, file.box);
  const std::vector<test::MovingAiQuery> queries = test::moving_ai_queries(name);
  ASSERT_GE(queries.size(), 160u);
  GridSearch search;
  for (std::size_t i = queries.size() / 20; i < queries.size(); i += queries.size() / 9)
    for (const SearchRule rule : {SearchRule::all_neighbours, SearchRule::canonical, SearchRule::jump_point}) {
      ASSERT_EQ(search.find(map, queries[i].start, queries[i].goal, rule), Reached::goal) << "query " << i;
      // The files print six digits.
      EXPECT_NEAR(search.cost(), queries[i].length, 1e-5 * (1.0 + queries[i].length)) << "query " << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Maps, MovingAi, testing::Range(0, 9));

}  // namespace
}  // namespace kervan::planning
