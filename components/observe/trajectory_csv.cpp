#include "components/observe/trajectory_csv.hpp"

#include "components/observe/decimal.hpp"

namespace kervan::observe {
namespace {

constexpr int metres = 4, radians = 5;  // decimals

std::string to_csv(const geometry::Pose2& pose) {
  return decimal(pose.x, metres) + ',' + decimal(pose.y, metres) + ',' + decimal(pose.yaw, radians);
}

}  // namespace

std::string to_csv(const TrajectoryRow& row) {
  std::string line = decimal(row.time, 3);
  line.append(",").append(row.robot).append(",").append(to_csv(row.truth)).append(",");
  line.append(row.odom ? to_csv(*row.odom) : ",,").append(",");
  line.append(decimal(row.twist.linear, metres)).append(",").append(decimal(row.twist.angular, radians));
  return line;
}

}  // namespace kervan::observe
