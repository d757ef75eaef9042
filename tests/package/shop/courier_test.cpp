#include <gtest/gtest.h>

#include "framework/test/harness.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "shop_msgs/msg/Parcel.hpp"

namespace {

using namespace std::chrono_literals;

TEST(Courier, AddsUpTheWayOfTheParcel) {
  kervan::test::Harness harness("shop/courier", {{"mass", 2.5}});
  harness.advance(0s);
  EXPECT_EQ(harness.reason(), "odom: nothing received yet");
  for (const double x : {0.0, 3.0, 1.0}) {
    nav_msgs::msg::Odometry odometry;
    odometry.pose.pose.position.x = x;
    harness.feed("odom", odometry);
    harness.advance(100ms);
  }
  const auto* parcel = harness.latest<shop_msgs::msg::Parcel>("parcel");
  ASSERT_TRUE(parcel);
  EXPECT_EQ(*parcel, (shop_msgs::msg::Parcel{
                         .number = "P-1", .header = {.frame_id = "base_link"}, .mass = 2.5, .carried = 3.0}));
  EXPECT_EQ(harness.state(), kervan::ComponentState::active);
}

}  // namespace
