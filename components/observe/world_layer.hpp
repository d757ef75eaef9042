/// Shapes of a world on a page of SVG.
#pragma once

#include <string>

#include "components/observe/polyline.hpp"
#include "components/observe/svg_writer.hpp"

namespace kervan::observe {

/// Numbers of the drawing: lengths of the world in metres, of the page in pixels.
std::string metres(double value);
std::string pixels(double value);

/// Draws shapes of the world, given in metres of the map; widths and sizes of texts are in pixels. A pixel is `px`
/// metres, so that lines and marks keep their size on the page at any scale. Points that are not finite are left out.
class WorldLayer {
 public:
  WorldLayer(SvgWriter& svg, double px) : svg_(svg), px_(px) {}

  double px() const { return px_; }

  void line(const Polyline& points, const char* colour, double width, const std::string& dashes = {},
            const char* opacity = "");

  /// A dash pattern given in pixels.
  std::string dashes(double on, double off) const { return metres(on * px_) + ' ' + metres(off * px_); }

  void circle(const geometry::Vector2& center, double radius, const char* fill, const char* stroke, double width,
              const std::string& dashes = {});

  void polygon(const Polyline& corners, const char* fill, const char* stroke, double width);

  /// An area that lets what is below it shine through, with a thin edge.
  void veil(const Polyline& corners, const char* colour);

  /// A PNG whose lower left corner is at `low`; its pixels stay sharp.
  void image(const geometry::Vector2& low, double width, double height, const std::string& png);

  void label(const geometry::Vector2& at, const std::string& content, double size, const char* colour,
             const char* anchor, const geometry::Vector2& offset, const char* weight = "", bool halo = false);

 private:
  SvgWriter& svg_;
  double px_;
};

}  // namespace kervan::observe
