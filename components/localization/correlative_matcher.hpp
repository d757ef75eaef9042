/// Finds where in a map a set of echoes lies best.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "components/localization/likelihood_field.hpp"
#include "components/localization/odometry_filter.hpp"

namespace kervan::localization {

struct CorrelativeMatcherParams {
  double resolution = 0.05;     ///< m, side of the map's cells
  double sigma = 0.07;          ///< m, how far from what is occupied an echo may lie and still belong to it
  double grain = 0.02;          ///< m, standard deviation of an echo that belongs to a surface of no thickness
  std::size_t least_used = 30;  ///< echoes that the map must have an opinion about
  double least_score = 0.4;     ///< mean likelihood of those, of 1, below which they do not fit the map
  double rival = 0.9;           ///< another place as good as this share of the best one makes the match ambiguous
  double alike = 30.0;          ///< so many echoes are worth an independent one: the next match sees the same walls
};

/// Where echoes came from, in the robot's frame, m.
using Echoes = std::vector<geometry::Vector2>;

/// Half of what is searched around the expected pose.
struct SearchWindow {
  double distance = 0.15;  ///< m, along x and along y
  double turn = 0.05;      ///< rad
};

enum class MatchKind {
  matched,
  too_few,    ///< the map says nothing about most of the echoes
  poor,       ///< the echoes fit the map nowhere in the window
  ambiguous,  ///< they fit it in two places nearly as well
};

struct Match {
  MatchKind kind = MatchKind::too_few;
  geometry::Pose2 pose;                        ///< of the robot in map; as expected unless `matched`
  Covariance covariance = Covariance::Zero();  ///< of that; wide along a line that the echoes say nothing about
  bool line = false;                           ///< matched, but along a line the echoes say next to nothing
  double score = 0.0;                          ///< mean likelihood of the echoes used, 0 .. 1
  std::size_t used = 0;                        ///< echoes that were compared
  std::size_t tried = 0;                       ///< poses that were looked at, whole squares of them counting as one
};

/// Correlative matching, coarse to fine (E. B. Olson 2009, "Real-Time Correlative Scan Matching",
/// doi:10.1109/ROBOT.2009.5152375): every pose of the window, in steps of a cell and of the turn that moves the
/// farthest echo by one, is scored by the mean likelihood of the echoes' ends. Squares of four by four positions are
/// first bounded by the largest values in reach and looked into only while their bound beats the best pose found, so
/// that it is exactly the one an exhaustive search would find (Hess, Kohler, Rapp and Andor 2016,
/// doi:10.1109/ICRA.2016.7487258). Of equally good poses the one nearest to the expected one is taken. From there least
/// squares lay the echoes on the surfaces nearest to them, which gives the pose between the cells, and how sure it is.
/// There is nothing random.
class CorrelativeMatcher {
 public:
  explicit CorrelativeMatcher(const CorrelativeMatcherParams& params);

  /// `expected`: pose of the robot in map.
  Match match(const PointMap& map, const Echoes& echoes, const geometry::Pose2& expected, const SearchWindow& window);

 private:
  struct Square {
    std::uint32_t bound;  // of the sum
    std::int32_t turn;    // step
    std::int32_t x, y;    // cells, of its lower left position
  };
  struct Candidate {
    std::uint32_t sum = 0;
    int turn = 0, x = 0, y = 0;
    bool operator==(const Candidate&) const = default;
  };

  grid::CellBox box_around(const Echoes& echoes, const geometry::Pose2& expected, const SearchWindow& window) const;
  Match search(const PointMap& map, const Echoes& echoes, const geometry::Pose2& expected, const SearchWindow& window);
  void use(const Echoes& echoes, const geometry::Pose2& expected);
  void place_turns(const geometry::Pose2& expected);
  void bound_squares();
  std::uint32_t sum_at(const std::vector<std::uint8_t>& values, int turn, int x, int y) const;
  template <class Look>
  void look_into(const Square& square, Look look);
  Candidate best_candidate();
  void refine(const PointMap& map, const geometry::Pose2& expected, Match& match, const SearchWindow& window) const;
  bool has_rival(const Candidate& best, const geometry::Pose2& expected, const Match& match);
  bool nearer(const Candidate& a, const Candidate& b) const;

  CorrelativeMatcherParams params_;
  LikelihoodField field_;

  // Of the match at hand, kept for their memory.
  std::vector<geometry::Vector2> used_;  // in the robot's frame
  double turn_step_ = 0.0;
  int turns_ = 0, shifts_ = 0;          // steps to either side
  std::vector<std::ptrdiff_t> places_;  // in the field, of each turn the places of all used echoes
  std::vector<Square> squares_;
  std::size_t tried_ = 0;
};

}  // namespace kervan::localization
