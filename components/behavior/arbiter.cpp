#include "components/behavior/arbiter.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::behavior {

bool Arbiter::take(Time received, const Request& request) {
  const bool good = !request.behaviour.empty() && request.valid_for > Duration::zero() &&
                    std::isfinite(request.twist.linear) && std::isfinite(request.twist.angular);
  if (!good) {
    ++refused_;
    return false;
  }
  requests_[request.behaviour] = {request, received + request.valid_for};
  return true;
}

void Arbiter::withdraw(const std::string& behaviour) { requests_.erase(behaviour); }

Decision Arbiter::decide(Time now) {
  Decision decision;
  for (auto held = requests_.begin(); held != requests_.end();) {
    if (now + period_ <= held->second.until) {
      ++held;
      continue;
    }
    decision.expired.push_back(held->first);
    held = requests_.erase(held);
  }

  std::vector<const Request*> active;  // in order of their names
  for (const auto& [name, held] : requests_)
    if (held.request.active) active.push_back(&held.request);
  const auto rank = [this](const Request* r) { return r->priority + (r->behaviour == driving_ ? r->hold : 0); };
  const auto before = [&](const Request* a, const Request* b) {
    if (rank(a) != rank(b)) return rank(a) > rank(b);
    return a->behaviour == driving_ && b->behaviour != driving_;
  };
  std::stable_sort(active.begin(), active.end(), before);

  driving_.clear();
  if (active.empty()) {
    decision.why = requests_.empty() ? "no behaviour says anything" : "no behaviour wants to drive";
    return decision;
  }
  const Request& winner = *active.front();
  driving_ = decision.behaviour = winner.behaviour;
  decision.priority = winner.priority;
  decision.twist = winner.twist;
  decision.why = winner.why;
  for (std::size_t i = 1; i < active.size(); ++i) decision.waiting.push_back(active[i]->behaviour);
  return decision;
}

}  // namespace kervan::behavior
