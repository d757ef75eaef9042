/// Who was in charge of a robot when, and who would have liked to be.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

namespace kervan::observe {

/// Times are in s since the start of the run.
class ArbitrationLog {
 public:
  /// A behaviour that did the same from one time to another.
  struct Stretch {
    double from;
    double to;
  };
  struct Behaviour {
    int priority = 0;  ///< the highest with which it was in charge; 0 if it never was
    std::vector<Stretch> in_charge;
    std::vector<Stretch> waiting;
  };

  /// From `time` on `in_charge` drives (empty: nobody), and those in `waiting` would like to. Times must not go back.
  void add(double time, const std::string& in_charge, int priority, std::span<const std::string> waiting);
  /// The run ends: what goes on ends now.
  void end(double time);

  bool empty() const { return behaviours_.empty(); }
  const std::map<std::string, Behaviour>& behaviours() const { return behaviours_; }
  /// Names in the order of a drawing: highest priority first, then by name.
  std::vector<std::string> ranked() const;

  /// The colour of a behaviour, the same in all drawings of a run: "#1769aa". Of one that is not in the log, of nobody.
  const char* colour_of(const std::string& behaviour) const;

 private:
  static void extend(std::vector<Stretch>& stretches, double from, double to);

  std::map<std::string, Behaviour> behaviours_;
  double since_ = 0.0;
  std::string in_charge_;  // since then
  std::vector<std::string> waiting_;
};

/// The log as one self-contained SVG document: a row for each behaviour, filled while it is in charge, thin while it
/// waits, and its share of the time. Equal logs give equal bytes.
std::string to_svg(const ArbitrationLog& log, const std::string& title, double end);

}  // namespace kervan::observe
