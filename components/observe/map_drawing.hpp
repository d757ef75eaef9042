/// A run as a picture: the world, what was planned, what was driven, and how near the goal it came.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/grid/occupancy.hpp"
#include "components/observe/polyline.hpp"
#include "components/observe/snapshot.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::observe {

/// Everything is in metres in the map frame.
struct DrawnCircle {
  geometry::Vector2 center = geometry::Vector2::Zero();
  double radius = 0.0;
};

struct DrawnWorld {
  std::vector<std::pair<geometry::Vector2, geometry::Vector2>> walls;
  std::vector<DrawnCircle> circles;
  std::vector<Polyline> polygons;  ///< solid; the last corner joins the first
};

/// An obstacle that has moved.
struct DrawnMover {
  Polyline way;                  ///< of its middle
  std::vector<Polyline> places;  ///< its outline at some times, in their order; the last one is drawn solid
};

/// A part of a driven path that has a colour of its own: that of the behaviour in charge.
struct DrawnStretch {
  std::string behaviour;  ///< empty: nobody
  std::string colour;     ///< "#1769aa"
  Polyline path;
};

/// One robot's run. What is empty or absent is not drawn.
struct DrawnRobot {
  std::string name;
  Polyline route;                       ///< as planned
  Polyline truth;                       ///< as driven
  Polyline odometry;                    ///< as the robot believes it has driven
  std::vector<DrawnStretch> stretches;  ///< of the truth, over it, with their colours beside the map
  std::optional<geometry::Vector2> goal;
  double tolerance = 0.10;                   ///< around the goal
  std::optional<geometry::Vector2> closest;  ///< where it came nearest to the goal
  std::vector<geometry::Vector2> contacts;   ///< where it touched something
  std::vector<Snapshot> snapshots;           ///< what its sensors saw, drawn in its colour with the time beside it
  bool reached = false;
  std::vector<std::pair<std::string, std::string>> figures;  ///< label and value, shown beside the map
};

/// Paths of many runs that have something in common, in one colour.
struct DrawnBundle {
  std::string label;
  std::vector<Polyline> paths;
};

struct MapDrawing {
  std::string title;
  std::string result;    ///< "success", "failed", "aborted", or empty; shown in its colour beside the title
  std::string subtitle;  ///< one line under the title
  DrawnWorld world;
  std::vector<DrawnMover> movers;
  std::optional<grid::Occupancy> map;  ///< that was made, drawn below everything else; the world is then outlined only
  Polyline
      nodes;  ///< of the waypoint graph, drawn with their numbers; when empty, those of up to three robots' routes are
  std::vector<DrawnBundle> bundles;  ///< drawn thin, each with its label below the map
  std::vector<DrawnRobot> robots;    ///< none: the picture of a world, without a legend
};

/// The drawing as one self-contained SVG document, 1000 px wide. Its viewBox is in metres; because y points down in
/// SVG, a point (x, y) of the map is drawn at (x, -y). Beside the map stand the legend, the robots' figures and, for up
/// to three robots, the surroundings of the goal enlarged. Points that are not finite are left out. Equal drawings give
/// equal bytes. Throws std::invalid_argument if the map has too many cells for a picture.
std::string to_svg(const MapDrawing& drawing);

}  // namespace kervan::observe
