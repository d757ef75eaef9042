#include "tests/experiments/error_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "components/observe/svg_writer.hpp"

namespace kervan::test {
namespace {

constexpr double width = 900.0, height = 480.0, left = 60.0, right = 20.0, top = 50.0, bottom = 50.0;
constexpr std::array<const char*, 6> colours = {"#d1495b", "#00798c", "#edae49", "#30638e", "#003d5b", "#777777"};

std::string number(double value, int digits = 1) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

/// A round number for a fifth of `length` or so: 1, 2 or 5 times a power of ten.
double tick(double length) {
  const double raw = length / 5.0, power = std::pow(10.0, std::floor(std::log10(raw)));
  return raw < 2.0 * power ? 2.0 * power : raw < 5.0 * power ? 5.0 * power : 10.0 * power;
}

class Plot {
 public:
  Plot(double seconds, double metres) : seconds_(seconds), metres_(metres) {
    svg_.open("svg", {{"xmlns", "http://www.w3.org/2000/svg"},
                      {"viewBox", "0 0 " + number(width) + " " + number(height)},
                      {"font-family", "sans-serif"},
                      {"font-size", "13"}});
    svg_.element("rect", {{"width", number(width)}, {"height", number(height)}, {"fill", "#ffffff"}});
  }

  double x(double second) const { return left + second / seconds_ * (width - left - right); }
  double y(double metre) const { return height - bottom - metre / metres_ * (height - top - bottom); }

  void line(double x1, double y1, double x2, double y2, const char* colour) {
    svg_.element("line",
                 {{"x1", number(x1)}, {"y1", number(y1)}, {"x2", number(x2)}, {"y2", number(y2)}, {"stroke", colour}});
  }
  void text(const std::string& content, double at_x, double at_y, const char* anchor) {
    svg_.text(content, {{"x", number(at_x)}, {"y", number(at_y)}, {"text-anchor", anchor}});
  }
  void axes() {
    for (double t = 0.0; t <= seconds_ + 1e-9; t += tick(seconds_)) {
      line(x(t), top, x(t), height - bottom, "#e0e0e0");
      text(number(t, 0), x(t), height - bottom + 18.0, "middle");
    }
    for (double e = 0.0; e <= metres_ + 1e-9; e += tick(metres_)) {
      line(left, y(e), width - right, y(e), "#e0e0e0");
      text(number(e, 2), left - 6.0, y(e) + 4.0, "end");
    }
    text("time, s", 0.5 * (left + width - right), height - 12.0, "middle");
    text("m", left - 6.0, top - 8.0, "end");
  }
  void curve(const std::vector<double>& values, const char* colour, const char* thickness) {
    std::string points;
    for (std::size_t i = 0; i < values.size(); ++i)
      points += number(x(static_cast<double>(i))) + "," + number(y(values[i])) + " ";
    svg_.element("polyline", {{"points", points}, {"fill", "none"}, {"stroke", colour}, {"stroke-width", thickness}});
  }
  std::string document() {
    svg_.close("svg");
    return svg_.document();
  }

 private:
  observe::SvgWriter svg_;
  double seconds_, metres_;
};

}  // namespace

void save_error_plot(const std::string& path, const std::string& title, const std::vector<ErrorCurve>& curves) {
  std::size_t longest = 2;
  double highest = 0.01;
  for (const ErrorCurve& curve : curves) {
    longest = std::max(longest, curve.mean.size());
    for (const double error : curve.worst) highest = std::max(highest, error);
  }
  Plot plot(static_cast<double>(longest - 1), 1.05 * highest);
  plot.axes();
  plot.text(title, left, 22.0, "start");
  for (std::size_t i = 0; i < curves.size(); ++i) {
    plot.curve(curves[i].worst, colours[i % colours.size()], "1");
    plot.curve(curves[i].mean, colours[i % colours.size()], "2.5");
    const double at_x = left + 16.0 + 210.0 * static_cast<double>(i);
    plot.line(at_x, 36.0, at_x + 24.0, 36.0, colours[i % colours.size()]);
    plot.text(curves[i].name, at_x + 30.0, 40.0, "start");
  }
  std::ofstream(path) << plot.document();
}

}  // namespace kervan::test
