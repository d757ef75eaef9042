#include "components/exploration/target_tour.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace kervan::exploration {
namespace {

using namespace std::chrono_literals;
using geometry::Pose2;
using geometry::Vector2;
using Event = TargetTour::Event;

TargetTourParams params() {
  TargetTourParams params;
  params.area = Area{{0, 0}, {10, 10}};
  return params;
}

/// Steps of 50 ms with a robot that drives straight at its target at `speed`, m/s, for `length`. Every new target gets
/// the straight line as its route. Returns the targets.
std::vector<Vector2> drive(TargetTour& tour, double speed, Duration length) {
  std::vector<Vector2> targets;
  Pose2 pose;
  for (Duration t = 0s; t < length; t += 50ms) {
    if (tour.step(Time(t), pose, true) == Event::new_target) {
      targets.push_back(*tour.target());
      tour.route(std::vector<Vector2>{pose.position(), *tour.target()});
    }
    if (tour.manoeuvre() || !tour.target()) continue;
    const Vector2 way = *tour.target() - pose.position();
    const Vector2 next = pose.position() + std::min(1.0, 0.05 * speed / way.norm()) * way;
    pose.x = next.x();
    pose.y = next.y();
  }
  return targets;
}

TEST(TargetTour, GoesFromOneTargetToTheNext) {
  TargetTour tour(params());
  const auto targets = drive(tour, 0.6, 300s);
  const TourFigures& figures = tour.figures();
  EXPECT_EQ(figures.targets, targets.size());
  EXPECT_EQ(figures.reached, figures.targets - 1);
  EXPECT_EQ(figures.stuck + figures.late + figures.unreachable, 0u);
  EXPECT_NEAR(figures.path, 0.6 * 300, 1.0);
  // About one a metre: each target ends 0.4 m early, and what is left of less than a metre before it has no point.
  EXPECT_GT(figures.points, 0.75 * figures.path);
  EXPECT_LE(figures.points, figures.path);
  ASSERT_TRUE(figures.first_reached);
  EXPECT_LT(*figures.first_reached, 30s);
}

TEST(TargetTour, SlowAndFastRobotsGetTheSameTargets) {
  TargetTour slow(params()), fast(params());
  const auto some = drive(slow, 0.3, 200s), more = drive(fast, 0.6, 200s);
  ASSERT_GT(more.size(), some.size());
  for (std::size_t k = 0; k < some.size(); ++k) EXPECT_EQ(some[k], more[k]);
}

TEST(TargetTour, AStuckRobotBacksTurnsAndGetsTheNextTarget) {
  TargetTour tour(params());
  Duration t = 0s;
  ASSERT_EQ(tour.step(Time(t), {}, true), Event::new_target);
  const Vector2 first = *tour.target();
  Event event = Event::none;
  for (; event != Event::stuck && t < 10s; t += 50ms) event = tour.step(Time(t), {}, true);
  ASSERT_EQ(event, Event::stuck);
  ASSERT_TRUE(tour.manoeuvre());
  EXPECT_LT(tour.manoeuvre()->linear, 0.0);
  for (; event != Event::new_target && t < 60s; t += 50ms) {
    event = tour.step(Time(t), {}, true);
    tour.give_up();  // of a target that is left behind already
  }
  EXPECT_FALSE(tour.manoeuvre());
  EXPECT_NE(*tour.target(), first);
  EXPECT_EQ(tour.figures().stuck, 1u);
  EXPECT_EQ(tour.figures().targets, 2u);
}

TEST(TargetTour, ATargetThatIsGivenUpOrTakesTooLongIsReplaced) {
  TargetTour tour(params());
  ASSERT_EQ(tour.step(Time(0s), {}, false), Event::new_target);
  tour.give_up();
  EXPECT_FALSE(tour.target());
  ASSERT_EQ(tour.step(Time(1s), {}, false), Event::new_target);
  EXPECT_EQ(tour.step(Time(60s), {}, false), Event::none);
  EXPECT_EQ(tour.step(Time(61s), {}, false), Event::new_target);
  EXPECT_EQ(tour.figures().unreachable, 1u);
  EXPECT_EQ(tour.figures().late, 1u);
  EXPECT_EQ(tour.figures().targets, 3u);
  EXPECT_FALSE(tour.figures().first_reached);
}

TEST(TargetTour, WithoutAnAreaItWaitsForObstacles) {
  TargetTour tour({});
  EXPECT_EQ(tour.step(Time(0s), {}, false), Event::no_target);
  Obstacles room;
  room.walls = {{{0, 0}, {10, 0}}, {{10, 0}, {10, 6}}, {{10, 6}, {0, 6}}, {{0, 6}, {0, 0}}};
  tour.surround(room);
  EXPECT_EQ(tour.step(Time(1s), {}, false), Event::new_target);
  EXPECT_GE(room.distance(*tour.target()), 0.5);
}

}  // namespace
}  // namespace kervan::exploration
