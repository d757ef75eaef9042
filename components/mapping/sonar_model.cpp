#include "components/mapping/sonar_model.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::mapping {

RegionBorders SonarModel::borders(double s) const {
  if (params_.regions == Regions::reading) return {s - params_.tolerance, s + params_.tolerance};
  if (s < fixed_near) return {s, s};  // nearer than the wall should be: only that what lies before it is empty
  if (s > fixed_far) return {fixed_near, fixed_near};
  return {fixed_near, fixed_far};
}

Region SonarModel::region(double r, double alpha, double s) const {
  if (!(std::abs(alpha) <= params_.half_aperture) || r > params_.max_range) return Region::outside;
  const RegionBorders borders = this->borders(s);
  if (r < borders.empty_below) return Region::empty;
  return r <= borders.occupied_to && borders.occupied_to > borders.empty_below ? Region::occupied : Region::beyond;
}

double SonarModel::occupied(double r, double alpha) const { return empty(r, alpha) * params_.max_occupied; }

double SonarModel::empty(double r, double alpha) const {
  const double R = params_.max_range, beta = params_.half_aperture;
  return 0.5 * ((R - r) / R + (beta - std::abs(alpha)) / beta);
}

double SonarModel::counted_occupied(double r, double alpha) const {
  const double p = occupied(r, alpha);
  if (params_.record_above > 0.0 && !(p > params_.record_above)) return 0.5;
  return params_.literal ? p : std::max(p, 0.5);
}

double SonarModel::counted_empty(double r, double alpha) const {
  const double p = empty(r, alpha);
  return params_.literal ? p : std::max(p, 0.5);
}

Likelihood SonarModel::likelihood(double r, double alpha, double s) const {
  switch (region(r, alpha, s)) {
    case Region::occupied: return {occupied(r, alpha), 1.0 - occupied(r, alpha)};
    case Region::empty: return {1.0 - empty(r, alpha), empty(r, alpha)};
    default: return {};
  }
}

grid::Masses SonarModel::masses(double r, double alpha, double s) const {
  switch (region(r, alpha, s)) {
    case Region::occupied: return {occupied(r, alpha), 0.0};
    case Region::empty: return {0.0, empty(r, alpha)};
    default: return {};
  }
}

double updated(double prior, const Likelihood& reading) {
  const double occupied = reading.occupied * prior, empty = reading.empty * (1.0 - prior);
  return occupied / (occupied + empty);
}

}  // namespace kervan::mapping
