#include "components/planning/ompl_space.hpp"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/spaces/DubinsStateSpace.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/ReedsSheppStateSpace.h>

#include <cmath>
#include <numbers>

#include "components/planning/line_walk.hpp"

namespace kervan::planning {
namespace {

namespace ob = ompl::base;
using geometry::Pose2;
using geometry::Vector2;

// Of one distance, in steps; measured.
constexpr unsigned plane_steps = 1, se2_steps = 2, dubins_steps = 10, reeds_shepp_steps = 60;

constexpr double longest_chord = 0.25;  // of an arc, in radii: it leaves the arc by 0.8 % of the radius
constexpr double closure = 0.01;        // cells; a curve that does not end where it should is none

bool on_map(const Costmap& map, const Vector2& point) {
  return point.x() >= 1.0 && point.y() >= 1.0 && point.x() < map.columns() + 1 && point.y() < map.rows() + 1;
}

bool is_free(const Costmap& map, const Vector2& point) {
  return on_map(map, point) && !map.blocked(map.index(static_cast<int>(point.x()), static_cast<int>(point.y())));
}

ob::RealVectorBounds bounds_of(const Costmap& map) {
  ob::RealVectorBounds bounds(2);
  bounds.setLow(1.0);
  bounds.setHigh(0, std::nextafter(map.columns() + 1.0, 0.0));
  bounds.setHigh(1, std::nextafter(map.rows() + 1.0, 0.0));
  return bounds;
}

/// A space whose distances are counted, and whose states are kept together: a planner that was thrown out of its work
/// does not give them back.
template <class Space>
class Counted : public Space, public OmplMotions, public std::enable_shared_from_this<Counted<Space>> {
 public:
  template <class... Arguments>
  Counted(OmplBudget& budget, unsigned steps, Arguments&&... arguments)
      : Space(std::forward<Arguments>(arguments)...), budget_(budget), steps_(steps) {}
  ~Counted() override {
    for (ob::State* state : all_) Space::freeState(state);
  }

  ob::State* allocState() const override {
    if (spare_.empty()) return all_.emplace_back(Space::allocState());
    ob::State* const state = spare_.back();
    spare_.pop_back();
    return state;
  }
  void freeState(ob::State* state) const override { spare_.push_back(state); }

  double distance(const ob::State* a, const ob::State* b) const override {
    budget_.spend(steps_);
    return Space::distance(a, b);
  }

  ob::StateSpacePtr space() override { return this->shared_from_this(); }

 protected:
  void spend() const { budget_.spend(steps_); }

 private:
  OmplBudget& budget_;
  unsigned steps_;
  mutable std::vector<ob::State*> all_, spare_;
};

/// Where the robot is; it may turn on the spot.
class Plane final : public Counted<ob::RealVectorStateSpace> {
 public:
  Plane(OmplBudget& budget, const Costmap& map) : Counted(budget, plane_steps, 2) { setBounds(bounds_of(map)); }

  Pose2 pose_of(const ob::State* state) const override {
    const double* const values = state->as<StateType>()->values;
    return {values[0], values[1], 0.0};
  }
  void place(ob::State* state, const Pose2& pose) const override {
    double* const values = state->as<StateType>()->values;
    values[0] = pose.x;
    values[1] = pose.y;
  }
  bool trace(const ob::State*, const ob::State* to, std::vector<Pose2>& corners) const override {
    corners.push_back(pose_of(to));
    return true;
  }
};

/// As the plane, but the robot's heading counts as well.
template <class Space>
class WithHeading : public Counted<Space> {
 public:
  template <class... Arguments>
  WithHeading(OmplBudget& budget, unsigned steps, const Costmap& map, Arguments&&... arguments)
      : Counted<Space>(budget, steps, std::forward<Arguments>(arguments)...) {
    this->setBounds(bounds_of(map));
  }

  Pose2 pose_of(const ob::State* state) const override {
    const auto* const pose = state->as<ob::SE2StateSpace::StateType>();
    return {pose->getX(), pose->getY(), pose->getYaw()};
  }
  void place(ob::State* state, const Pose2& pose) const override {
    auto* const values = state->as<ob::SE2StateSpace::StateType>();
    values->setXY(pose.x, pose.y);
    // OMPL's angles are less than pi.
    const double yaw = geometry::wrap_angle(pose.yaw);
    values->setYaw(yaw < std::numbers::pi ? yaw : -std::numbers::pi);
  }
  bool trace(const ob::State*, const ob::State* to, std::vector<Pose2>& corners) const override {
    corners.push_back(pose_of(to));
    return true;
  }
};

using Se2 = WithHeading<ob::SE2StateSpace>;

/// Adds the corners of a line or an arc from `at` on, all in radii; turns counter-clockwise if `turn` is 1, not at all
/// if it is 0. Negative lengths lead backwards.
void add_corners(Pose2& at, int turn, double length, const auto& add) {
  const int pieces = turn == 0 ? 1 : static_cast<int>(std::ceil(std::abs(length) / longest_chord));
  const Pose2 from = at;
  for (int i = 1; i <= pieces && length != 0.0; ++i) {
    const double along = length * i / pieces;
    if (turn == 0) {
      at = {from.x + along * std::cos(from.yaw), from.y + along * std::sin(from.yaw), from.yaw};
    } else {
      const double yaw = from.yaw + turn * along;
      at = {from.x + turn * (std::sin(yaw) - std::sin(from.yaw)), from.y - turn * (std::cos(yaw) - std::cos(from.yaw)),
            yaw};
    }
    add(at);
  }
}

/// Curves of lines and of arcs of one radius.
template <class Space>
class Curves : public WithHeading<Space> {
 public:
  Curves(OmplBudget& budget, unsigned steps, const Costmap& map, double radius)
      : WithHeading<Space>(budget, steps, map, radius), radius_(radius) {}

  bool trace(const ob::State* from, const ob::State* to, std::vector<Pose2>& corners) const override {
    this->spend();
    const Pose2 begin = this->pose_of(from), end = this->pose_of(to);
    Pose2 at{0.0, 0.0, begin.yaw};
    follow(from, to, at, [&](const Pose2& corner) {
      corners.push_back({begin.x + radius_ * corner.x, begin.y + radius_ * corner.y, geometry::wrap_angle(corner.yaw)});
    });
    const Vector2 missed = begin.position() + radius_ * at.position() - end.position();
    if (!(missed.norm() <= closure)) return false;
    // What is left of it are roundings.
    if (at == Pose2{0.0, 0.0, begin.yaw})
      corners.push_back(end);
    else
      corners.back() = end;
    return true;
  }

 private:
  template <class Add>
  void follow(const ob::State* from, const ob::State* to, Pose2& at, const Add& add) const {
    if constexpr (std::is_same_v<Space, ob::DubinsStateSpace>) {
      const auto path = this->dubins(from, to);
      for (int i = 0; i < 3; ++i) add_corners(at, 1 - static_cast<int>(path.type_[i]), path.length_[i], add);
    } else {
      const auto path = this->reedsShepp(from, to);
      constexpr int turns[] = {0, 1, 0, -1};
      for (int i = 0; i < 5; ++i) add_corners(at, turns[path.type_[i]], path.length_[i], add);
    }
  }

  double radius_;
};

class FreeMotions final : public ob::MotionValidator {
 public:
  FreeMotions(const ob::SpaceInformationPtr& information, std::shared_ptr<OmplMotions> motions, const Costmap& map,
              OmplBudget& budget)
      : ob::MotionValidator(information), motions_(std::move(motions)), map_(map), budget_(budget) {}

  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    corners_.clear();
    return motions_->trace(from, to, corners_) && motion_is_free(map_, motions_->pose_of(from), corners_, budget_);
  }
  bool checkMotion(const ob::State* from, const ob::State* to, std::pair<ob::State*, double>& last) const override {
    if (checkMotion(from, to)) return true;
    last.second = 0.0;
    if (last.first != nullptr) si_->copyState(last.first, from);
    return false;
  }

 private:
  std::shared_ptr<OmplMotions> motions_;
  const Costmap& map_;
  OmplBudget& budget_;
  mutable std::vector<Pose2> corners_;
};

}  // namespace

std::shared_ptr<OmplMotions> make_motions(OmplSpace kind, const Costmap& map, double radius, OmplBudget& budget) {
  switch (kind) {
    case OmplSpace::plane: return std::make_shared<Plane>(budget, map);
    case OmplSpace::se2: return std::make_shared<Se2>(budget, se2_steps, map);
    case OmplSpace::dubins: return std::make_shared<Curves<ob::DubinsStateSpace>>(budget, dubins_steps, map, radius);
    case OmplSpace::reeds_shepp:
      return std::make_shared<Curves<ob::ReedsSheppStateSpace>>(budget, reeds_shepp_steps, map, radius);
  }
  return nullptr;
}

bool motion_is_free(const Costmap& map, const Pose2& from, const std::vector<Pose2>& corners, OmplBudget& budget) {
  Vector2 at = from.position();
  if (!on_map(map, at)) return false;
  for (const Pose2& corner : corners) {
    const Vector2 to = corner.position();
    if (!on_map(map, to)) return false;
    unsigned cells = 0;
    const bool open = walk_line(at, to, [&](int x, int y, double) {
      ++cells;
      return !map.blocked(map.index(x, y));
    });
    budget.spend(cells / 4 + 1);  // A cell is a quarter of a step.
    if (!open) return false;
    at = to;
  }
  return true;
}

ob::SpaceInformationPtr make_space_information(const std::shared_ptr<OmplMotions>& motions, const Costmap& map,
                                               OmplBudget& budget) {
  auto information = std::make_shared<ob::SpaceInformation>(motions->space());
  information->setStateValidityChecker([motions = motions.get(), &map, &budget](const ob::State* state) {
    budget.spend(1);
    return is_free(map, motions->pose_of(state).position());
  });
  information->setMotionValidator(std::make_shared<FreeMotions>(information, motions, map, budget));
  information->setup();
  return information;
}

}  // namespace kervan::planning
