/// Pictures of maps, PNG or PGM.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kervan::map_file {

/// The most pixels a picture may have: what a small file claims must not cost gigabytes.
inline constexpr std::int64_t most_pixels = 100'000'000;

struct Pixel {
  std::uint8_t shade = 0;      ///< 0 black .. 255 white; the mean of red, green and blue
  std::uint8_t opacity = 255;  ///< 0 transparent .. 255 opaque
};

struct Image {
  int columns = 0;
  int rows = 0;
  std::vector<Pixel> pixels;  ///< row by row from the top, as pictures are stored
};

/// What `rule` makes of each pixel, from the lowest row to the highest: a picture's last row is the lowest of the map.
template <class Rule>
auto cells_of(const Image& image, Rule rule) {
  std::vector<decltype(rule(Pixel()))> cells;
  cells.reserve(image.pixels.size());
  const auto columns = static_cast<std::size_t>(image.columns);
  for (std::size_t row = static_cast<std::size_t>(image.rows); row-- > 0;)
    for (std::size_t column = 0; column < columns; ++column)
      cells.push_back(rule(image.pixels[row * columns + column]));
  return cells;
}

/// The whole file. Throws std::invalid_argument, "cannot read the file: …", if it cannot be read.
std::string read_file(const std::string& path);

/// Reads a PNG of any kind, or a PGM (P2 or P5). Throws std::invalid_argument that says what is wrong with the file;
/// the path is not part of it.
Image load_image(const std::string& path);

/// The same for a file in memory.
Image parse_image(const std::string& bytes);

/// The bytes of a grey PNG, with opacity if a pixel is not opaque, or of a PGM (P5), which has none. Throws
/// std::invalid_argument if the picture has no or too many pixels.
std::string to_png(const Image& image);
std::string to_pgm(const Image& image);

}  // namespace kervan::map_file
