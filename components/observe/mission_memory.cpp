#include "components/observe/mission_memory.hpp"

#include <charconv>
#include <sstream>

namespace kervan::observe {
namespace {

constexpr const char* first_line = "kervan_mission 1";

template <class Number>
std::string text_of(Number value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

template <class Number>
bool read(std::istream& line, Number& value) {
  std::string word;
  if (!(line >> word)) return false;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

}  // namespace

std::string to_text(const MissionMemories& memories) {
  std::string text = std::string(first_line) + "\n";
  for (const auto& [robot, memory] : memories) {
    text += robot + ' ' + text_of(memory.start.time_since_epoch().count()) + ' ' + text_of(memory.goal) + ' ' +
            text_of(memory.path) + ' ' + text_of(memory.contacts);
    if (memory.min_clearance) text += ' ' + text_of(*memory.min_clearance);
    text += '\n';
  }
  return text;
}

std::optional<MissionMemories> memories_of(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  if (!std::getline(lines, line) || line != first_line) return std::nullopt;
  MissionMemories memories;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string robot;
    MissionMemory memory;
    Time::rep start = 0;
    if (!(words >> robot) || !read(words, start) || !read(words, memory.goal) || !read(words, memory.path) ||
        !read(words, memory.contacts))
      return std::nullopt;
    memory.start = Time(Duration(start));
    if (!(words >> std::ws).eof()) {
      memory.min_clearance.emplace();
      if (!read(words, *memory.min_clearance)) return std::nullopt;
    }
    memories[robot] = memory;
  }
  return memories;
}

}  // namespace kervan::observe
