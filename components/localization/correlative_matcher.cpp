#include "components/localization/correlative_matcher.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace kervan::localization {
namespace {

using geometry::Pose2;
using geometry::Vector2;

constexpr double widest_window = 3.0;  // m
constexpr double widest_turn = 1.6;    // rad
constexpr int most_turns = 400;        // to either side
constexpr int rounds = 5;              // of the least squares
constexpr double apart = 0.2;          // m between two places that are not the same
constexpr double turned_apart = 0.1;   // rad

}  // namespace

CorrelativeMatcher::CorrelativeMatcher(const CorrelativeMatcherParams& params)
    : params_(params), field_(params.sigma / params.resolution) {}

/// Around all places wherever in the window the robot is, with the cells that values and bounds look at.
grid::CellBox CorrelativeMatcher::box_around(const Echoes& echoes, const Pose2& expected,
                                             const SearchWindow& window) const {
  double low_x = 1e300, low_y = 1e300, high_x = -1e300, high_y = -1e300, farthest = 0.0;
  for (const Vector2& place : echoes) {
    const Vector2 at = expected * place;
    low_x = std::min(low_x, at.x());
    low_y = std::min(low_y, at.y());
    high_x = std::max(high_x, at.x());
    high_y = std::max(high_y, at.y());
    farthest = std::max(farthest, place.norm());
  }
  const double turn = std::min(window.turn, widest_turn), distance = std::min(window.distance, widest_window);
  const double margin =
      distance + farthest * turn + (field_.reach() + LikelihoodField::bound_side + 3) * params_.resolution;
  const Vector2 low(low_x - margin, low_y - margin), high(high_x + margin, high_y + margin);
  if (echoes.empty() || !grid::has_cell(low) || !grid::has_cell(high)) return {};
  const grid::Cell first = grid::cell_of(low, params_.resolution), last = grid::cell_of(high, params_.resolution);
  return {first.x, first.y, last.x - first.x + 1, last.y - first.y + 1};
}

Match CorrelativeMatcher::match(const PointMap& map, const Echoes& echoes, const Pose2& expected,
                                const SearchWindow& window) {
  const grid::CellBox box = box_around(echoes, expected, window);
  if (box.empty()) return {MatchKind::too_few, expected};
  field_.build(map, box);
  return search(map, echoes, expected, window);
}

Match CorrelativeMatcher::search(const PointMap& map, const Echoes& echoes, const Pose2& expected,
                                 const SearchWindow& window) {
  Match match{MatchKind::too_few, expected};
  use(echoes, expected);
  match.used = used_.size();
  if (match.used < params_.least_used) return match;

  double farthest = 1.0;
  for (const Vector2& place : used_) farthest = std::max(farthest, place.norm());
  turn_step_ = params_.resolution / farthest;
  const double turn = std::min(window.turn, widest_turn);
  turns_ = std::min(static_cast<int>(std::ceil(turn / turn_step_)), most_turns);
  turn_step_ = std::max(turn_step_, turn / most_turns);
  shifts_ = static_cast<int>(std::ceil(std::min(window.distance, widest_window) / params_.resolution));
  place_turns(expected);
  bound_squares();

  const Candidate best = best_candidate();
  match.pose = {expected.x + best.x * params_.resolution, expected.y + best.y * params_.resolution,
                geometry::wrap_angle(expected.yaw + best.turn * turn_step_)};
  refine(map, expected, match, window);
  match.score = best.sum / (255.0 * static_cast<double>(match.used));
  if (match.score < params_.least_score)
    match.kind = MatchKind::poor;
  else
    match.kind = has_rival(best, expected, match) ? MatchKind::ambiguous : MatchKind::matched;
  match.tried = tried_;
  if (match.kind != MatchKind::matched) match.pose = expected;
  return match;
}

/// Echoes that the map can say something about. What lies where it knows nothing yet would pull the robot back to where
/// it has been.
void CorrelativeMatcher::use(const Echoes& echoes, const Pose2& expected) {
  used_.clear();
  for (const Vector2& place : echoes)
    if (field_.tells(grid::cell_of(expected * place, params_.resolution))) used_.push_back(place);
}

void CorrelativeMatcher::place_turns(const Pose2& expected) {
  places_.clear();
  for (int turn = -turns_; turn <= turns_; ++turn) {
    const Pose2 turned{expected.x, expected.y, expected.yaw + turn * turn_step_};
    const double c = std::cos(turned.yaw), s = std::sin(turned.yaw);
    for (const Vector2& place : used_) {
      const Vector2 at(turned.x + c * place.x() - s * place.y(), turned.y + s * place.x() + c * place.y());
      places_.push_back(static_cast<std::ptrdiff_t>(field_.index(grid::cell_of(at, params_.resolution))));
    }
  }
}

std::uint32_t CorrelativeMatcher::sum_at(const std::vector<std::uint8_t>& values, int turn, int x, int y) const {
  const std::ptrdiff_t shift = y * field_.stride() + x;
  const std::ptrdiff_t* const places = places_.data() + static_cast<std::size_t>(turn + turns_) * used_.size();
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < used_.size(); ++i) sum += values[static_cast<std::size_t>(places[i] + shift)];
  return sum;
}

void CorrelativeMatcher::bound_squares() {
  squares_.clear();
  tried_ = 0;
  for (int turn = -turns_; turn <= turns_; ++turn)
    for (int y = -shifts_; y <= shifts_; y += LikelihoodField::bound_side)
      for (int x = -shifts_; x <= shifts_; x += LikelihoodField::bound_side)
        squares_.push_back({sum_at(field_.bounds(), turn, x, y), turn, x, y});
  tried_ += squares_.size();
  std::sort(squares_.begin(), squares_.end(), [](const Square& a, const Square& b) {
    if (a.bound != b.bound) return a.bound > b.bound;
    return std::array{a.turn, a.y, a.x} < std::array{b.turn, b.y, b.x};
  });
}

template <class Look>
void CorrelativeMatcher::look_into(const Square& square, Look look) {
  for (int y = square.y; y < std::min(square.y + LikelihoodField::bound_side, shifts_ + 1); ++y)
    for (int x = square.x; x < std::min(square.x + LikelihoodField::bound_side, shifts_ + 1); ++x) {
      ++tried_;
      look(Candidate{sum_at(field_.values(), square.turn, x, y), square.turn, x, y});
    }
}

/// Whether `a` is nearer to the expected pose. A step of the turn moves the farthest echo as far as one of the others
/// moves all; the rest of the order is only there to be one.
bool CorrelativeMatcher::nearer(const Candidate& a, const Candidate& b) const {
  const auto off = [](const Candidate& c) { return c.x * c.x + c.y * c.y + c.turn * c.turn; };
  if (off(a) != off(b)) return off(a) < off(b);
  return std::array{a.turn, a.y, a.x} < std::array{b.turn, b.y, b.x};
}

CorrelativeMatcher::Candidate CorrelativeMatcher::best_candidate() {
  Candidate best{sum_at(field_.values(), 0, 0, 0), 0, 0, 0};
  for (const Square& square : squares_) {
    if (square.bound < best.sum) break;
    look_into(square, [&](const Candidate& candidate) {
      if (candidate.sum > best.sum || (candidate.sum == best.sum && nearer(candidate, best))) best = candidate;
    });
  }
  return best;
}

/// Gauss-Newton for the pose from which the echoes lie on the surfaces nearest to them (Chen and Medioni 1992,
/// doi:10.1016/0262-8856(92)90066-C), each with a loss that hardly grows beyond sigma (Cauchy's): along a wall they say
/// nothing. Its information is the covariance.
void CorrelativeMatcher::refine(const PointMap& map, const Pose2& expected, Match& match,
                                const SearchWindow& window) const {
  using Vector3 = Eigen::Vector3d;
  Covariance information = Covariance::Zero();
  const Vector3 weak(1.0 / std::pow(4.0 * window.distance, 2), 1.0 / std::pow(4.0 * window.distance, 2),
                     1.0 / std::pow(4.0 * window.turn, 2));
  for (int round = 0; round < rounds; ++round) {
    Vector3 pull = Vector3::Zero();
    information.setZero();
    const double c = std::cos(match.pose.yaw), s = std::sin(match.pose.yaw);
    for (const Vector2& place : used_) {
      const Vector2 arm(c * place.x() - s * place.y(), s * place.x() + c * place.y());
      const Vector2 at = match.pose.position() + arm;
      const auto surface = map.surface(at, 2.0 * params_.sigma);
      if (!surface) continue;
      const double off = surface->normal.dot(at - surface->middle);
      const double variance = params_.grain * params_.grain + surface->thickness * surface->thickness;
      const double weight =
          1.0 / (variance * params_.alike * (1.0 + off * off / (params_.sigma * params_.sigma / 4.0)));
      const Vector3 slope(surface->normal.x(), surface->normal.y(),
                          surface->normal.y() * arm.x() - surface->normal.x() * arm.y());
      information += weight * slope * slope.transpose();
      pull -= weight * off * slope;
    }
    const Vector3 gone(match.pose.x - expected.x, match.pose.y - expected.y,
                       geometry::angle_between(expected.yaw, match.pose.yaw));
    information.diagonal() += weak;
    pull -= weak.cwiseProduct(gone);
    const Vector3 step = information.ldlt().solve(pull);
    match.pose = {match.pose.x + step[0], match.pose.y + step[1], geometry::wrap_angle(match.pose.yaw + step[2])};
  }
  match.covariance = information.inverse();
  const double widest =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(match.covariance.topLeftCorner<2, 2>()).eigenvalues().maxCoeff();
  match.line = widest > window.distance * window.distance;
}

/// A place nearly as good that is not just farther along where the echoes fit anyway.
bool CorrelativeMatcher::has_rival(const Candidate& best, const Pose2& expected, const Match& match) {
  const auto worth_it = static_cast<std::uint32_t>(params_.rival * best.sum);
  const Covariance information = match.covariance.inverse();
  bool found = false;
  for (const Square& square : squares_) {
    if (found || square.bound < worth_it) break;
    look_into(square, [&](const Candidate& candidate) {
      if (candidate.sum < worth_it) return;
      const Eigen::Vector3d off(expected.x + candidate.x * params_.resolution - match.pose.x,
                                expected.y + candidate.y * params_.resolution - match.pose.y,
                                geometry::angle_between(match.pose.yaw, expected.yaw + candidate.turn * turn_step_));
      if (off.head<2>().norm() < apart && std::abs(off[2]) < turned_apart) return;
      found |= off.dot(information * off) > 25.0;
    });
  }
  return found;
}

}  // namespace kervan::localization
