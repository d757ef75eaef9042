#include "components/grid/checkpoint.hpp"

#include <bit>

#include "framework/map_file/image.hpp"
#include "framework/map_file/map_file.hpp"

namespace kervan::grid {
namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints are little-endian");

// A file is: the eight letters, the version, the length of the whole, what the checkpoint holds, and the checksum of
// all bytes before it.
constexpr char letters[] = "KERVMAP\n";
constexpr std::size_t header_size = 8 + sizeof(std::uint32_t) + sizeof(std::uint64_t);
constexpr std::size_t checksum_size = sizeof(std::uint64_t);

/// FNV-1a of 64 bits.
std::uint64_t checksum(const char* bytes, std::size_t size) {
  std::uint64_t sum = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i < size; ++i) sum = (sum ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3u;
  return sum;
}

template <class Number>
void put(std::string& bytes, Number number) {
  char text[sizeof number];
  std::memcpy(text, &number, sizeof number);
  bytes.append(text, sizeof number);
}

void put(std::string& bytes, const std::string& text) {
  put(bytes, std::uint64_t{text.size()});
  bytes += text;
}

/// Takes values off the bytes, and never more than there are.
class Reader {
 public:
  Reader(const std::string& bytes, std::size_t from, std::size_t end) : bytes_(bytes), at_(from), end_(end) {}

  template <class Number>
  Number number() {
    require(sizeof(Number));
    Number number;
    std::memcpy(&number, bytes_.data() + at_, sizeof number);
    at_ += sizeof number;
    return number;
  }
  std::string text() {
    const auto size = number<std::uint64_t>();
    require(size);
    std::string text = bytes_.substr(at_, size);
    at_ += size;
    return text;
  }
  /// A count of items of which each takes a byte at least.
  std::size_t count() {
    const auto count = number<std::uint64_t>();
    require(count);
    return count;
  }
  bool at_end() const { return at_ == end_; }

 private:
  void require(std::uint64_t size) const {
    if (size > end_ - at_) throw std::invalid_argument("the checkpoint is damaged: its parts do not fit together");
  }

  const std::string& bytes_;
  std::size_t at_, end_;
};

CheckpointLayer read_layer(Reader& reader) {
  CheckpointLayer layer;
  layer.name = reader.text();
  for (std::size_t left = reader.count(); left > 0; --left) layer.numbers.push_back(reader.number<std::uint64_t>());
  layer.box.x = reader.number<std::int32_t>();
  layer.box.y = reader.number<std::int32_t>();
  layer.box.columns = reader.number<std::int32_t>();
  layer.box.rows = reader.number<std::int32_t>();
  layer.bytes_per_cell = reader.number<std::uint32_t>();
  layer.cells = reader.text();
  const CellBox& box = layer.box;
  constexpr int farthest = 1'000'000'000;  // cells; sums of two are still numbers
  const bool placed = box.columns >= 0 && box.rows >= 0 && box.columns <= farthest && box.rows <= farthest &&
                      box.x >= -farthest && box.x <= farthest && box.y >= -farthest && box.y <= farthest;
  const auto size = std::uint64_t{layer.bytes_per_cell} * static_cast<std::uint32_t>(box.columns);
  if (!placed || (box.rows == 0 ? !layer.cells.empty()
                                : layer.cells.size() % static_cast<std::uint32_t>(box.rows) != 0 ||
                                      layer.cells.size() / static_cast<std::uint32_t>(box.rows) != size))
    throw std::invalid_argument("the checkpoint is damaged: the layer '" + layer.name +
                                "' has not as many cells as it says");
  return layer;
}

}  // namespace

std::string to_bytes(const Checkpoint& checkpoint) {
  std::string bytes(letters, 8);
  put(bytes, checkpoint_version);
  put(bytes, std::uint64_t{0});  // the length, which is not known yet
  put(bytes, checkpoint.origin);
  put(bytes, checkpoint.resolution);
  put(bytes, std::uint64_t{checkpoint.layers.size()});
  for (const CheckpointLayer& layer : checkpoint.layers) {
    put(bytes, layer.name);
    put(bytes, std::uint64_t{layer.numbers.size()});
    for (const std::uint64_t number : layer.numbers) put(bytes, number);
    for (const int number : {layer.box.x, layer.box.y, layer.box.columns, layer.box.rows})
      put(bytes, std::int32_t{number});
    put(bytes, layer.bytes_per_cell);
    put(bytes, layer.cells);
  }
  const std::uint64_t length = bytes.size() + checksum_size;
  std::memcpy(bytes.data() + header_size - sizeof length, &length, sizeof length);
  put(bytes, checksum(bytes.data(), bytes.size()));
  return bytes;
}

Checkpoint checkpoint_of(const std::string& bytes) {
  if (bytes.size() < header_size || bytes.compare(0, 8, letters) != 0)
    throw std::invalid_argument("it is no checkpoint of a map");
  Reader header(bytes, 8, header_size);
  if (const auto version = header.number<std::uint32_t>(); version != checkpoint_version)
    throw std::invalid_argument("the checkpoint is of version " + std::to_string(version) +
                                " of the format; allowed: " + std::to_string(checkpoint_version));
  if (const auto length = header.number<std::uint64_t>(); bytes.size() < length)
    throw std::invalid_argument("the checkpoint is cut off: it has " + std::to_string(bytes.size()) + " of " +
                                std::to_string(length) + " bytes");
  else if (bytes.size() > length || length < header_size + checksum_size)
    throw std::invalid_argument("the checkpoint is damaged: its length is wrong");
  const std::size_t end = bytes.size() - checksum_size;
  if (Reader(bytes, end, bytes.size()).number<std::uint64_t>() != checksum(bytes.data(), end))
    throw std::invalid_argument("the checkpoint is damaged: its checksum is wrong");

  Reader reader(bytes, header_size, end);
  Checkpoint checkpoint;
  checkpoint.origin = reader.text();
  checkpoint.resolution = reader.number<double>();
  for (std::size_t left = reader.count(); left > 0; --left) checkpoint.layers.push_back(read_layer(reader));
  if (!reader.at_end() || !(checkpoint.resolution > 0.0))
    throw std::invalid_argument("the checkpoint is damaged: its parts do not fit together");
  return checkpoint;
}

void save_checkpoint(const Checkpoint& checkpoint, const std::string& path) {
  map_file::replace_file(path, to_bytes(checkpoint));
}

Checkpoint load_checkpoint(const std::string& path) {
  try {
    return checkpoint_of(map_file::read_file(path));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(path + ": " + error.what());
  }
}

}  // namespace kervan::grid
