#include "components/observe/map_drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>

#include "components/grid/picture.hpp"
#include "components/observe/decimal.hpp"
#include "components/observe/svg_writer.hpp"
#include "components/observe/world_layer.hpp"

namespace kervan::observe {
namespace {

using geometry::Vector2;

// Lengths of the page are in pixels of a page 1000 px wide; lengths of the world are in metres.
constexpr double page_width = 1000.0, margin = 36.0, header = 74.0, gap = 34.0;
constexpr double map_width = page_width - 2.0 * margin, map_height = 900.0;  // the most
constexpr double detail_size = 240.0, detail_gap = 20.0, line_height = 19.0;
constexpr std::size_t most_details = 3;  // of more robots goals are not enlarged, nor waypoints numbered

constexpr std::array<const char*, 10> robot_colours{"#1769aa", "#d1580f", "#2c8a4b", "#8445a8", "#b3881a",
                                                    "#0f8b8d", "#c2417c", "#5b6b1e", "#7a4a2b", "#4f5bd5"};
constexpr const char* ink = "#1f2933";
constexpr const char* soft_ink = "#6b7785";
constexpr const char* wall_colour = "#2f3b47";
constexpr const char* solid_colour = "#9aa5b1";
constexpr const char* truth_colour = "#e0342b";    // of the world over a map of it
constexpr const char* unknown_colour = "#dfe4e9";  // of what such a map knows nothing of
constexpr const char* success_colour = "#2c8a4b";
constexpr const char* failure_colour = "#c0392b";
constexpr const char* fonts = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// The part of the world that is drawn.
struct Bounds {
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::infinity());
  Vector2 high = -low;

  void add(const Vector2& point, double around = 0.0) {
    if (!point.allFinite()) return;
    low = low.cwiseMin(point - Vector2::Constant(around));
    high = high.cwiseMax(point + Vector2::Constant(around));
  }
  void add(const Polyline& points) {
    for (const auto& point : points) add(point);
  }
  double width() const { return high.x() - low.x(); }
  double height() const { return high.y() - low.y(); }
};

Bounds bounds_of(const MapDrawing& drawing, const grid::Picture& map) {
  Bounds bounds;
  if (!map.box.empty()) {
    bounds.add(drawing.map->resolution() * Vector2(map.box.x, map.box.y));
    bounds.add(drawing.map->resolution() * Vector2(map.box.x + map.box.columns, map.box.y + map.box.rows));
  }
  for (const auto& [a, b] : drawing.world.walls) {
    bounds.add(a);
    bounds.add(b);
  }
  for (const auto& circle : drawing.world.circles) bounds.add(circle.center, circle.radius);
  for (const auto& polygon : drawing.world.polygons) bounds.add(polygon);
  for (const auto& mover : drawing.movers)
    for (const auto& place : mover.places) bounds.add(place);
  bounds.add(drawing.nodes);
  for (const auto& bundle : drawing.bundles)
    for (const auto& path : bundle.paths) bounds.add(path);
  for (const auto& robot : drawing.robots) {
    bounds.add(robot.route);
    bounds.add(robot.truth);
    bounds.add(robot.odometry);
    if (robot.goal) bounds.add(*robot.goal, robot.tolerance);
    for (const auto& snapshot : robot.snapshots)
      for (const auto& area : snapshot.seen) bounds.add(area);
  }
  if (!(bounds.width() >= 0.0)) bounds.add(Vector2::Zero());
  bounds.add(bounds.low, 0.5);
  bounds.add(bounds.high, 0.5);
  return bounds;
}

/// 1, 2 or 5 times a power of ten: the smallest that is at least `value`.
double round_step(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= value * (1.0 - 1e-9)) return factor * power;
  return 10.0 * power;
}

std::string length_text(double length) { return decimal(length, length < 0.095 ? 2 : length < 0.95 ? 1 : 0) + " m"; }

void draw_world(WorldLayer& layer, const DrawnWorld& world) {
  for (const auto& polygon : world.polygons) layer.polygon(polygon, solid_colour, wall_colour, 1.5);
  for (const auto& circle : world.circles) layer.circle(circle.center, circle.radius, solid_colour, wall_colour, 1.5);
  for (const auto& [a, b] : world.walls) layer.line({a, b}, wall_colour, 3.5);
}

/// Thin, so that the cells of a map on it are seen.
void draw_truth_of_map(WorldLayer& layer, const DrawnWorld& world) {
  for (const auto& polygon : world.polygons) layer.polygon(polygon, "none", truth_colour, 1.4);
  for (const auto& circle : world.circles) layer.circle(circle.center, circle.radius, "none", truth_colour, 1.4);
  for (const auto& [a, b] : world.walls) layer.line({a, b}, truth_colour, 1.4);
}

void draw_mover(WorldLayer& layer, const DrawnMover& mover, double tolerance) {
  layer.line(simplified(mover.way, tolerance), solid_colour, 1.6, layer.dashes(6.0, 4.0));
  for (std::size_t i = 0; i < mover.places.size(); ++i)
    layer.polygon(mover.places[i], i + 1 == mover.places.size() ? solid_colour : "none", solid_colour, 1.5);
}

void draw_goal(WorldLayer& layer, const Vector2& at) {
  layer.circle(at, 7.0 * layer.px(), "none", failure_colour, 1.8);
  layer.circle(at, 2.2 * layer.px(), failure_colour, "none", 0.0);
}

void draw_closest(WorldLayer& layer, const Vector2& at) {
  const double r = 5.5 * layer.px();
  layer.polygon({at + Vector2(r, 0), at + Vector2(0, r), at + Vector2(-r, 0), at + Vector2(0, -r)}, "#ffd54a", ink,
                1.2);
}

void draw_start(WorldLayer& layer, const Vector2& at, const char* colour) {
  layer.circle(at, 4.5 * layer.px(), "#ffffff", colour, 2.2);
}

void draw_end(WorldLayer& layer, const Vector2& at, const char* colour) {
  layer.circle(at, 4.5 * layer.px(), colour, "#ffffff", 1.2);
}

void draw_contact(WorldLayer& layer, const Vector2& at) {
  const double r = 4.5 * layer.px();
  layer.line({at + Vector2(-r, -r), at + Vector2(r, r)}, failure_colour, 2.4);
  layer.line({at + Vector2(-r, r), at + Vector2(r, -r)}, failure_colour, 2.4);
}

void draw_route(WorldLayer& layer, const Polyline& route, const char* colour) {
  layer.line(route, colour, 9.0, {}, "0.22");
}

void draw_odometry(WorldLayer& layer, const Polyline& path) { layer.line(path, ink, 1.1, layer.dashes(3.0, 3.0)); }

void draw_truth(WorldLayer& layer, const Polyline& path, const char* colour) { layer.line(path, colour, 2.4); }

void draw_driven(WorldLayer& layer, const DrawnRobot& robot, const char* colour, double tolerance) {
  draw_truth(layer, simplified(robot.truth, tolerance), colour);
  for (const auto& stretch : robot.stretches)
    layer.line(simplified(stretch.path, tolerance), stretch.colour.c_str(), 3.2);
  draw_odometry(layer, simplified(robot.odometry, tolerance));
}

/// A node of the graph that no route uses.
void draw_node(WorldLayer& layer, const Vector2& at, std::size_t number) {
  layer.circle(at, 8.5 * layer.px(), "#f1f4f7", "#a9b4bf", 1.3);
  layer.label(at, std::to_string(number), 10.5, soft_ink, "middle", {0.0, 3.8});
}

/// A waypoint of a route: a dot on the route, and the number beside it where the driven path does not hide it.
void draw_waypoint(WorldLayer& layer, const Vector2& at, std::size_t number) {
  const Vector2 badge = at + layer.px() * Vector2(-15.0, 15.0);
  layer.line({badge, at}, ink, 1.0);
  layer.circle(at, 2.6 * layer.px(), ink, "#ffffff", 0.8);
  layer.circle(badge, 9.0 * layer.px(), "#ffffff", ink, 1.3);
  layer.label(badge, std::to_string(number), 11.0, ink, "middle", {0.0, 4.0}, "bold");
}

void draw_arrowhead(WorldLayer& layer, const geometry::Pose2& pose, const char* colour) {
  const auto corner = [&](double x, double y) { return pose * Vector2(layer.px() * Vector2(x, y)); };
  layer.polygon({corner(9.0, 0.0), corner(-5.0, 5.0), corner(-2.5, 0.0), corner(-5.0, -5.0)}, colour, "#ffffff", 1.0);
}

/// Where the robot was, and when.
void draw_snapshot_mark(WorldLayer& layer, const Snapshot& snapshot, const char* colour) {
  draw_arrowhead(layer, snapshot.pose, colour);
  const int digits = std::abs(snapshot.time - std::round(snapshot.time)) < 0.05 ? 0 : 1;
  layer.label(snapshot.pose.position(), decimal(snapshot.time, digits) + " s", 10.5, colour, "start", {8.0, -8.0}, "",
              true);
}

void draw_grid(WorldLayer& layer, const Bounds& bounds) {
  const double step = round_step(std::max(bounds.width(), bounds.height()) / 12.0);
  // Counted in whole steps: adding the step up would leave 0 drawn as 1e-17. The count is bounded, because far from the
  // origin a double may no longer tell one step from the next.
  constexpr int most = 20;
  const double first_x = std::ceil(bounds.low.x() / step), first_y = std::ceil(bounds.low.y() / step);
  for (int i = 0; i < most && (first_x + i) * step <= bounds.high.x(); ++i) {
    const double x = (first_x + i) * step;
    layer.line({{x, bounds.low.y()}, {x, bounds.high.y()}}, "#e9edf1", 1.0);
    layer.label({x, bounds.low.y()}, decimal(x, step < 1.0 ? 1 : 0), 10.0, soft_ink, "middle", {0.0, 14.0});
  }
  for (int i = 0; i < most && (first_y + i) * step <= bounds.high.y(); ++i) {
    const double y = (first_y + i) * step;
    layer.line({{bounds.low.x(), y}, {bounds.high.x(), y}}, "#e9edf1", 1.0);
    layer.label({bounds.low.x(), y}, decimal(y, step < 1.0 ? 1 : 0), 10.0, soft_ink, "end", {-6.0, 3.5});
  }
}

/// A scale bar that ends at `right`, its length a round number of metres near `target` pixels.
void draw_scale(WorldLayer& layer, const Vector2& right, double target) {
  const double length = round_step(target * layer.px());
  const Vector2 left = right - Vector2(length, 0.0);
  const Vector2 tick(0.0, 4.0 * layer.px());
  layer.line({left + tick, left - tick, left, right, right - tick, right + tick}, ink, 1.5);
  layer.label((left + right) / 2.0, length_text(length), 11.0, ink, "middle", {0.0, -7.0}, "", true);
}

bool on_a_route(const MapDrawing& drawing, const Vector2& point) {
  const auto is_here = [&](const Vector2& other) { return (other - point).norm() < 1e-6; };
  return std::any_of(drawing.robots.begin(), drawing.robots.end(), [&](const DrawnRobot& robot) {
    return std::any_of(robot.route.begin(), robot.route.end(), is_here);
  });
}

const char* colour_of(std::size_t robot) { return robot_colours[robot % robot_colours.size()]; }

/// Half the side of the square around a goal that is worth enlarging: what happened there fills a good part of it.
double detail_reach(const DrawnRobot& robot) {
  double farthest = robot.tolerance;
  if (robot.closest) farthest = std::max(farthest, (*robot.closest - *robot.goal).norm());
  if (!robot.truth.empty()) farthest = std::max(farthest, (robot.truth.back() - *robot.goal).norm());
  return std::clamp(2.2 * farthest, 0.5, 2.5);
}

bool has_detail(const DrawnRobot& robot) { return robot.goal && robot.goal->allFinite() && !robot.truth.empty(); }

/// A path among many: thin, and darker where several lie on each other.
void draw_strand(WorldLayer& layer, const Polyline& path, const char* colour) {
  layer.line(path, colour, 1.3, {}, "0.55");
}

void draw_bundle(WorldLayer& layer, const DrawnBundle& bundle, const char* colour, double tolerance) {
  for (const auto& path : bundle.paths) draw_strand(layer, simplified(path, tolerance), colour);
  for (const auto& path : bundle.paths) {
    if (path.empty()) continue;
    layer.circle(path.front(), 2.6 * layer.px(), "#ffffff", colour, 1.4);
    layer.circle(path.back(), 2.6 * layer.px(), colour, "#ffffff", 0.8);
  }
}

void draw_map(SvgWriter& svg, const MapDrawing& drawing, const grid::Picture& map, const Bounds& bounds, double px) {
  svg.element("rect", {{"x", metres(bounds.low.x())},
                       {"y", metres(-bounds.high.y())},
                       {"width", metres(bounds.width())},
                       {"height", metres(bounds.height())},
                       {"fill", drawing.map ? unknown_colour : "#ffffff"},
                       {"stroke", "#d5dbe1"},
                       {"stroke-width", metres(px)}});
  WorldLayer layer(svg, px);
  if (!map.box.empty()) {
    const double cell = drawing.map->resolution();
    layer.image(cell * Vector2(map.box.x, map.box.y), cell * map.box.columns, cell * map.box.rows, map.png);
  }
  draw_grid(layer, bounds);
  for (std::size_t i = 0; i < drawing.robots.size(); ++i) draw_route(layer, drawing.robots[i].route, colour_of(i));
  for (std::size_t i = 0; i < drawing.robots.size(); ++i)
    for (const auto& snapshot : drawing.robots[i].snapshots)
      for (const auto& area : snapshot.seen) layer.veil(area, colour_of(i));
  if (drawing.map)
    draw_truth_of_map(layer, drawing.world);
  else
    draw_world(layer, drawing.world);

  const double tolerance = px / 3.0;  // a third of a pixel
  for (const auto& mover : drawing.movers) draw_mover(layer, mover, tolerance);
  for (std::size_t i = 0; i < drawing.bundles.size(); ++i)
    draw_bundle(layer, drawing.bundles[i], colour_of(i), tolerance);

  for (std::size_t i = 0; i < drawing.nodes.size(); ++i)
    if (!on_a_route(drawing, drawing.nodes[i])) draw_node(layer, drawing.nodes[i], i);

  for (std::size_t i = 0; i < drawing.robots.size(); ++i) {
    const auto& robot = drawing.robots[i];
    draw_driven(layer, robot, colour_of(i), tolerance);
  }
  for (std::size_t i = 0; i < drawing.nodes.size(); ++i)
    if (on_a_route(drawing, drawing.nodes[i])) draw_waypoint(layer, drawing.nodes[i], i);
  for (std::size_t i = 0; i < drawing.robots.size(); ++i) {
    const auto& robot = drawing.robots[i];
    if (drawing.nodes.empty() && drawing.robots.size() <= most_details)
      for (std::size_t k = 0; k < robot.route.size(); ++k) draw_waypoint(layer, robot.route[k], k);
    if (!robot.truth.empty()) draw_start(layer, robot.truth.front(), colour_of(i));
    if (!robot.truth.empty()) draw_end(layer, robot.truth.back(), colour_of(i));
    if (robot.goal) draw_goal(layer, *robot.goal);
    if (robot.closest) draw_closest(layer, *robot.closest);
    for (const auto& contact : robot.contacts) draw_contact(layer, contact);
    for (const auto& snapshot : robot.snapshots) draw_snapshot_mark(layer, snapshot, colour_of(i));
    if (drawing.robots.size() > 1 && !robot.truth.empty())
      layer.label(robot.truth.front(), robot.name, 11.5, colour_of(i), "middle", {0.0, 18.0}, "bold", true);
  }
  draw_scale(layer, bounds.high + Vector2(0.0, 12.0 * px), 110.0);
}

/// The surroundings of a goal in a square whose upper left corner is at (x, y) of the viewBox, in metres of the map.
void draw_detail(SvgWriter& svg, const MapDrawing& drawing, std::size_t index, double x, double y, double map_px) {
  const auto& robot = drawing.robots[index];
  const Vector2 goal = *robot.goal;
  const double reach = detail_reach(robot);
  const double px = 2.0 * reach / detail_size;
  svg.open("svg", {{"x", metres(x)},
                   {"y", metres(y)},
                   {"width", metres(detail_size * map_px)},
                   {"height", metres(detail_size * map_px)},
                   {"viewBox", metres(goal.x() - reach) + ' ' + metres(-goal.y() - reach) + ' ' + metres(2.0 * reach) +
                                   ' ' + metres(2.0 * reach)}});
  svg.element("rect", {{"x", metres(goal.x() - reach)},
                       {"y", metres(-goal.y() - reach)},
                       {"width", metres(2.0 * reach)},
                       {"height", metres(2.0 * reach)},
                       {"fill", "#ffffff"}});
  WorldLayer layer(svg, px);
  draw_route(layer, robot.route, colour_of(index));
  draw_world(layer, drawing.world);
  layer.circle(goal, robot.tolerance, "none", success_colour, 1.4, layer.dashes(5.0, 4.0));
  const double tolerance = px / 3.0;
  draw_driven(layer, robot, colour_of(index), tolerance);
  draw_goal(layer, goal);
  draw_end(layer, robot.truth.back(), colour_of(index));
  if (robot.closest) draw_closest(layer, *robot.closest);
  for (const auto& contact : robot.contacts) draw_contact(layer, contact);
  draw_scale(layer, goal + Vector2(reach - 12.0 * px, 14.0 * px - reach), 60.0);
  layer.label(goal, "goal of " + robot.name, 11.5, ink, "start", {8.0 - detail_size / 2.0, 18.0 - detail_size / 2.0},
              "bold", true);
  svg.close("svg");
  svg.element("rect", {{"x", metres(x)},
                       {"y", metres(y)},
                       {"width", metres(detail_size * map_px)},
                       {"height", metres(detail_size * map_px)},
                       {"fill", "none"},
                       {"stroke", soft_ink},
                       {"stroke-width", metres(map_px)}});
}

void draw_detail_frame(SvgWriter& svg, const DrawnRobot& robot, double px) {
  const double reach = std::max(detail_reach(robot), 14.0 * px);
  svg.element("rect", {{"x", metres(robot.goal->x() - reach)},
                       {"y", metres(-robot.goal->y() - reach)},
                       {"width", metres(2.0 * reach)},
                       {"height", metres(2.0 * reach)},
                       {"fill", "none"},
                       {"stroke", soft_ink},
                       {"stroke-width", metres(px)},
                       {"stroke-dasharray", metres(3.0 * px) + ' ' + metres(2.0 * px)}});
}

void draw_header(SvgWriter& svg, const MapDrawing& drawing) {
  svg.open("text", {{"x", pixels(margin)}, {"y", "36"}, {"font-size", "22"}, {"font-weight", "bold"}, {"fill", ink}});
  svg.span(drawing.title, {});
  svg.span(drawing.result, {{"dx", "14"}, {"fill", drawing.result == "success" ? success_colour : failure_colour}});
  svg.close("text");
  svg.text(drawing.subtitle, {{"x", pixels(margin)}, {"y", "58"}, {"font-size", "13"}, {"fill", soft_ink}});
}

/// The colours of the behaviours that were in charge, by their names, in two columns. Returns where they end.
double draw_behaviours(SvgWriter& svg, const std::vector<DrawnStretch>& stretches, double left, double y) {
  std::map<std::string, std::string> colours;
  for (const auto& stretch : stretches) colours[stretch.behaviour] = stretch.colour;
  std::size_t place = 0;
  for (const auto& [behaviour, colour] : colours) {
    const double x = left + (place % 2 == 0 ? 0.0 : 205.0);
    if (place++ % 2 == 0) y += line_height;
    svg.element("rect", {{"x", pixels(x)}, {"y", pixels(y - 7.0)}, {"width", "28"}, {"height", "5"}, {"fill", colour}});
    svg.text(behaviour.empty() ? "nobody in charge" : behaviour,
             {{"x", pixels(x + 40.0)}, {"y", pixels(y)}, {"font-size", "12"}, {"fill", ink}});
  }
  return y;
}

/// The figures of one robot from (left, top) downwards, page pixels. Returns where they end.
double draw_figures(SvgWriter& svg, const DrawnRobot& robot, const char* colour, double left, double top) {
  double y = top + line_height;
  svg.open("text", {{"x", pixels(left)}, {"y", pixels(y)}, {"font-size", "13"}, {"fill", ink}});
  svg.span(robot.name, {{"font-weight", "bold"}, {"fill", colour}});
  if (robot.goal)
    svg.span(robot.reached ? "reached the goal" : "did not reach the goal",
             {{"dx", "8"}, {"font-weight", "bold"}, {"fill", robot.reached ? success_colour : failure_colour}});
  svg.close("text");
  // Two columns of label and value.
  for (std::size_t k = 0; k < robot.figures.size(); ++k) {
    const double x = left + (k % 2 == 0 ? 0.0 : 205.0);
    if (k % 2 == 0) y += line_height;
    svg.text(robot.figures[k].first, {{"x", pixels(x)}, {"y", pixels(y)}, {"font-size", "12"}, {"fill", soft_ink}});
    svg.text(robot.figures[k].second,
             {{"x", pixels(x + 185.0)}, {"y", pixels(y)}, {"font-size", "12"}, {"fill", ink}, {"text-anchor", "end"}});
  }
  y = draw_behaviours(svg, robot.stretches, left, y);
  return y + 8.0;
}

/// The robots' figures from (margin, top) downwards, page pixels; those of many robots side by side. Returns where they
/// end.
double draw_figures(SvgWriter& svg, const MapDrawing& drawing, double top) {
  const std::size_t count = drawing.robots.size(), columns = count > most_details ? 2 : 1;
  const std::size_t rows = (count + columns - 1) / columns;
  double bottom = top;
  for (std::size_t column = 0; column < columns; ++column) {
    double y = top;
    for (std::size_t i = column * rows; i < std::min(count, (column + 1) * rows); ++i)
      y = draw_figures(svg, drawing.robots[i], colour_of(i), margin + static_cast<double>(column) * 480.0, y);
    bottom = std::max(bottom, y);
  }
  return bottom;
}

/// A patch of a map, around a sample line.
void draw_patch(WorldLayer& layer, const Polyline& line, const char* fill) {
  const Vector2 up(0.0, 5.0);
  layer.polygon({line[0] - up, line[1] - up, line[1] + up, line[0] + up}, fill, "#d5dbe1", 1.0);
}

/// What the lines and marks mean that the drawing has, in two columns from (margin, top) downwards, page pixels.
/// Returns where it ends.
double draw_legend(SvgWriter& svg, const MapDrawing& drawing, double top) {
  WorldLayer layer(svg, 1.0);
  const char* colour = robot_colours[0];
  struct Entry {
    const char* text;
    void (*draw)(WorldLayer&, const Polyline&, const char*);  // given the two ends of a sample line
  };
  std::vector<Entry> entries;
  const auto explain = [&](bool drawn, const Entry& entry) {
    if (drawn) entries.push_back(entry);
  };
  const auto any = [&](auto has) { return std::any_of(drawing.robots.begin(), drawing.robots.end(), has); };
  const bool driven = any([](const DrawnRobot& r) { return !r.truth.empty(); });
  const bool goals = any([](const DrawnRobot& r) { return r.goal.has_value(); });
  explain(driven, {"driven, truth", [](WorldLayer& l, const Polyline& p, const char* c) { draw_truth(l, p, c); }});
  explain(goals, {"goal", [](WorldLayer& l, const Polyline& p, const char*) { draw_goal(l, (p[0] + p[1]) / 2.0); }});
  explain(any([](const DrawnRobot& r) { return !r.odometry.empty(); }),
          {"driven, by odometry", [](WorldLayer& l, const Polyline& p, const char*) { draw_odometry(l, p); }});
  explain(goals, {"tolerance", [](WorldLayer& l, const Polyline& p, const char*) {
                    l.circle((p[0] + p[1]) / 2.0, 6.5, "none", success_colour, 1.4, l.dashes(5.0, 4.0));
                  }});
  explain(any([](const DrawnRobot& r) { return !r.route.empty(); }),
          {"planned route", [](WorldLayer& l, const Polyline& p, const char* c) { draw_route(l, p, c); }});
  explain(any([](const DrawnRobot& r) { return r.closest.has_value(); }),
          {"closest approach",
           [](WorldLayer& l, const Polyline& p, const char*) { draw_closest(l, (p[0] + p[1]) / 2.0); }});
  explain(driven, {"start and end", [](WorldLayer& l, const Polyline& p, const char* c) {
                     draw_start(l, p[0] + Vector2(5.0, 0.0), c);
                     draw_end(l, p[1] - Vector2(5.0, 0.0), c);
                   }});
  explain(any([](const DrawnRobot& r) { return !r.contacts.empty(); }),
          {"contact", [](WorldLayer& l, const Polyline& p, const char*) { draw_contact(l, (p[0] + p[1]) / 2.0); }});
  explain(any([](const DrawnRobot& r) { return !r.snapshots.empty(); }),
          {"seen by its sensors, at the time beside it", [](WorldLayer& l, const Polyline& p, const char* c) {
             const geometry::Pose2 at{p[0].x(), p[0].y(), 0.0};
             l.veil(cone(at, 0.5, 26.0), c);
             draw_arrowhead(l, at, c);
           }});
  explain(!drawing.movers.empty(),
          {"moving obstacle, at the end filled", [](WorldLayer& l, const Polyline& p, const char*) {
             const Vector2 r(4.0, 4.0), s(4.0, -4.0);
             draw_mover(l, {p, {{p[1] - r, p[1] + s, p[1] + r, p[1] - s}}}, 0.0);
           }});
  const bool mapped = drawing.map.has_value();
  explain(mapped,
          {"the map: free", [](WorldLayer& l, const Polyline& p, const char*) { draw_patch(l, p, "#ffffff"); }});
  explain(mapped,
          {"the map: occupied", [](WorldLayer& l, const Polyline& p, const char*) { draw_patch(l, p, "#000000"); }});
  explain(mapped, {"the map: nothing known",
                   [](WorldLayer& l, const Polyline& p, const char*) { draw_patch(l, p, unknown_colour); }});
  explain(mapped,
          {"the world, truth", [](WorldLayer& l, const Polyline& p, const char*) { l.line(p, truth_colour, 1.4); }});
  double y = top;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const double x = margin + (i % 2 == 0 ? 0.0 : 205.0);
    if (i % 2 == 0) y += line_height;
    // The layer turns y around, as for the world.
    entries[i].draw(layer, {{x + 2.0, -(y - 4.0)}, {x + 30.0, -(y - 4.0)}}, colour);
    svg.text(entries[i].text, {{"x", pixels(x + 40.0)}, {"y", pixels(y)}, {"font-size", "12"}, {"fill", ink}});
  }
  return y;
}

/// The labels of the bundles from (margin, top) downwards, in three columns, page pixels. Returns where they end.
double draw_bundle_labels(SvgWriter& svg, const std::vector<DrawnBundle>& bundles, double top) {
  WorldLayer layer(svg, 1.0);
  double y = top;
  for (std::size_t i = 0; i < bundles.size(); ++i) {
    const double x = margin + 310.0 * static_cast<double>(i % 3);
    if (i % 3 == 0) y += line_height;
    layer.line({{x + 2.0, -(y - 4.0)}, {x + 30.0, -(y - 4.0)}}, colour_of(i), 3.0);
    svg.text(bundles[i].label, {{"x", pixels(x + 40.0)}, {"y", pixels(y)}, {"font-size", "12"}, {"fill", ink}});
  }
  return y;
}

/// Everything below the map, from `top` downwards. Returns where it ends.
double draw_foot(SvgWriter& svg, const MapDrawing& drawing, double top) {
  if (!drawing.bundles.empty()) top = draw_bundle_labels(svg, drawing.bundles, top);
  return drawing.robots.empty() ? top : draw_legend(svg, drawing, draw_figures(svg, drawing, top) + 4.0);
}

}  // namespace

std::string to_svg(const MapDrawing& drawing) {
  const grid::Picture map = drawing.map ? picture_of(*drawing.map) : grid::Picture{};
  const Bounds bounds = bounds_of(drawing, map);
  const double px = std::max(bounds.width() / map_width, bounds.height() / map_height);
  const double map_bottom = header + bounds.height() / px + gap;

  // The foot of the page is laid out first, because the page's height depends on it.
  SvgWriter foot;
  const bool labelled = !drawing.robots.empty() || !drawing.bundles.empty();
  const double text_bottom = labelled ? draw_foot(foot, drawing, map_bottom - 6.0) : map_bottom - margin;
  std::vector<std::size_t> details;
  for (std::size_t i = 0; i < drawing.robots.size() && drawing.robots.size() <= most_details; ++i)
    if (has_detail(drawing.robots[i])) details.push_back(i);
  const bool beside = details.size() <= 2;  // the text takes the width of two details
  const double details_top = beside ? map_bottom : text_bottom + gap;
  const double details_bottom = details.empty() ? 0.0 : details_top + detail_size;
  const double page_height = std::max(text_bottom, details_bottom) + margin;

  const double centring = (map_width - bounds.width() / px) / 2.0;
  const Vector2 corner(bounds.low.x() - (margin + centring) * px, -bounds.high.y() - header * px);  // of the viewBox
  const auto at_page = [&](double x, double y) { return Vector2(corner + px * Vector2(x, y)); };

  SvgWriter svg;
  svg.open("svg", {{"xmlns", "http://www.w3.org/2000/svg"},
                   {"width", pixels(page_width)},
                   {"height", pixels(page_height)},
                   {"viewBox", metres(corner.x()) + ' ' + metres(corner.y()) + ' ' + metres(page_width * px) + ' ' +
                                   metres(page_height * px)},
                   {"font-family", fonts}});
  svg.element("rect", {{"x", metres(corner.x())},
                       {"y", metres(corner.y())},
                       {"width", metres(page_width * px)},
                       {"height", metres(page_height * px)},
                       {"fill", "#fafbfc"}});
  draw_map(svg, drawing, map, bounds, px);
  for (std::size_t i = 0; i < details.size(); ++i) {
    draw_detail_frame(svg, drawing.robots[details[i]], px);
    const double from_right = static_cast<double>(details.size() - i) * (detail_size + detail_gap) - detail_gap;
    const Vector2 at = at_page(page_width - margin - from_right, details_top);
    draw_detail(svg, drawing, details[i], at.x(), at.y(), px);
  }
  svg.open("g", {{"transform",
                  "translate(" + metres(corner.x()) + ' ' + metres(corner.y()) + ") scale(" + decimal(px, 6) + ")"}});
  draw_header(svg, drawing);
  svg.append(foot);
  svg.close("g");
  svg.close("svg");
  return svg.document();
}

}  // namespace kervan::observe
