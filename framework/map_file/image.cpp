#include "framework/map_file/image.hpp"

#include <png.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace kervan::map_file {

namespace {

void require_size(std::int64_t columns, std::int64_t rows) {
  if (columns < 1 || rows < 1) throw std::invalid_argument("the picture has no pixels");
  if (columns > most_pixels || rows > most_pixels || columns * rows > most_pixels)
    throw std::invalid_argument("the picture has " + std::to_string(columns) + " x " + std::to_string(rows) +
                                " pixels; allowed: " + std::to_string(most_pixels));
}

/// libpng's own structure, and what must be freed with it.
struct PngImage {
  png_image image{};
  PngImage() { image.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&image); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;

  [[noreturn]] void fail() const { throw std::invalid_argument("not a readable PNG: " + std::string(image.message)); }
};

Image parse_png(const std::string& bytes) {
  PngImage reader;
  png_image& png = reader.image;
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) reader.fail();
  require_size(png.width, png.height);
  Image image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  const std::size_t count = std::size_t{png.width} * png.height;
  const bool coloured = (png.format & PNG_FORMAT_FLAG_COLOR) != 0;
  png.format = coloured ? PNG_FORMAT_RGBA : PNG_FORMAT_GA;
  std::vector<std::uint8_t> buffer(PNG_IMAGE_SIZE(png));
  if (!png_image_finish_read(&png, nullptr, buffer.data(), 0, nullptr)) reader.fail();
  image.pixels.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* const p = buffer.data() + i * (coloured ? 4 : 2);
    image.pixels[i] = coloured ? Pixel{static_cast<std::uint8_t>((p[0] + p[1] + p[2]) / 3), p[3]} : Pixel{p[0], p[1]};
  }
  return image;
}

/// Reads the numbers of a PGM's header, and those of a P2's pixels: separated by white space and comments.
class PgmNumbers {
 public:
  PgmNumbers(const std::string& bytes, std::size_t at) : bytes_(bytes), at_(at) {}

  int next(const char* what, int highest) {
    skip_space();
    const std::size_t begin = at_;
    std::int64_t value = 0;
    while (at_ < bytes_.size() && bytes_[at_] >= '0' && bytes_[at_] <= '9' && value <= highest)
      value = 10 * value + (bytes_[at_++] - '0');
    if (at_ == begin) throw std::invalid_argument(std::string("not a readable PGM: the ") + what + " is missing");
    if (value > highest)
      throw std::invalid_argument(std::string("not a readable PGM: the ") + what + " is above " +
                                  std::to_string(highest));
    return static_cast<int>(value);
  }
  std::size_t at() const { return at_; }

 private:
  void skip_space() {
    while (at_ < bytes_.size()) {
      if (bytes_[at_] == '#') {
        while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
      } else if (std::strchr(" \t\r\n\v\f", bytes_[at_]) != nullptr) {
        ++at_;
      } else {
        return;
      }
    }
  }

  const std::string& bytes_;
  std::size_t at_;
};

Image parse_pgm(const std::string& bytes) {
  PgmNumbers numbers(bytes, 2);
  Image image;
  image.columns = numbers.next("width", static_cast<int>(most_pixels));
  image.rows = numbers.next("height", static_cast<int>(most_pixels));
  require_size(image.columns, image.rows);
  const int brightest = numbers.next("brightest value", 65535);
  if (brightest < 1) throw std::invalid_argument("not a readable PGM: the brightest value is 0");
  const std::size_t count = static_cast<std::size_t>(image.columns) * static_cast<std::size_t>(image.rows);
  const auto shade = [&](int value) {
    return Pixel{static_cast<std::uint8_t>((std::min(value, brightest) * 255 + brightest / 2) / brightest)};
  };
  const auto require_pixels = [&](std::size_t found) {
    if (found < count)
      throw std::invalid_argument("not a readable PGM: it has " + std::to_string(found) + " of " +
                                  std::to_string(count) + " pixels");
  };
  if (bytes[1] == '5') {  // binary, behind one character of white space
    const std::size_t begin = std::min(numbers.at() + 1, bytes.size()), size = brightest > 255 ? 2 : 1;
    require_pixels((bytes.size() - begin) / size);
    image.pixels.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(bytes[begin + i * size + k]); };
      image.pixels.push_back(shade(size == 2 ? byte(0) << 8 | byte(1) : byte(0)));
    }
  } else {
    require_pixels(std::min(count, bytes.size() / 2));  // before memory is asked for: a digit and a space each
    image.pixels.reserve(count);
    for (std::size_t i = 0; i < count; ++i) image.pixels.push_back(shade(numbers.next("value of a pixel", 65535)));
  }
  return image;
}

/// What libpng wants to write from: grey, or grey with opacity where a pixel is not opaque.
std::vector<std::uint8_t> png_buffer(const Image& image, bool with_opacity) {
  std::vector<std::uint8_t> buffer;
  buffer.reserve(image.pixels.size() * (with_opacity ? 2 : 1));
  for (const Pixel& pixel : image.pixels) {
    buffer.push_back(pixel.shade);
    if (with_opacity) buffer.push_back(pixel.opacity);
  }
  return buffer;
}

}  // namespace

std::string to_png(const Image& image) {
  require_size(image.columns, image.rows);
  const bool with_opacity =
      std::any_of(image.pixels.begin(), image.pixels.end(), [](const Pixel& pixel) { return pixel.opacity != 255; });
  const std::vector<std::uint8_t> buffer = png_buffer(image, with_opacity);
  PngImage writer;
  png_image& png = writer.image;
  png.width = static_cast<png_uint_32>(image.columns);
  png.height = static_cast<png_uint_32>(image.rows);
  png.format = with_opacity ? PNG_FORMAT_GA : PNG_FORMAT_GRAY;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, buffer.data(), 0, nullptr))
    throw std::invalid_argument("cannot be written as PNG: " + std::string(png.message));
  bytes.resize(size);
  return bytes;
}

std::string to_pgm(const Image& image) {
  require_size(image.columns, image.rows);
  std::string bytes = "P5\n" + std::to_string(image.columns) + ' ' + std::to_string(image.rows) + "\n255\n";
  for (const Pixel& pixel : image.pixels) bytes.push_back(static_cast<char>(pixel.shade));
  return bytes;
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes;
  char part[1 << 16];
  while (file && (file.read(part, sizeof part) || file.gcount() > 0))
    bytes.append(part, static_cast<std::size_t>(file.gcount()));
  // A folder can be opened, but not read.
  if (!file.is_open() || file.bad())
    throw std::invalid_argument("cannot read the file: " + std::string(std::strerror(errno)));
  return bytes;
}

Image load_image(const std::string& path) { return parse_image(read_file(path)); }

Image parse_image(const std::string& bytes) {
  if (bytes.starts_with("\x89PNG")) return parse_png(bytes);
  if (bytes.starts_with("P5") || bytes.starts_with("P2")) return parse_pgm(bytes);
  throw std::invalid_argument("neither a PNG nor a PGM (P2, P5) picture");
}

}  // namespace kervan::map_file
