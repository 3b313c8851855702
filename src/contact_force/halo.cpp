#include "contact_force/halo.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "base/collectives.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"

namespace floe {
ContactHalo::ContactHalo(const Part& part) : part_(part), alone_(size(part.comm) == 1) {
  const auto owned = static_cast<std::size_t>(part.owned);
  std::vector<int> counts;
  global_ = all_gathered(std::vector(part.global.begin(), part.global.begin() + part.owned),
                         part.comm, &counts);
  std::vector<double> mine;
  for (std::size_t b = 0; b < owned; ++b) {
    const Point3& x = part.bodies.position[b];
    mine.insert(mine.end(), {x.x, x.y, x.z});
    mine.insert(mine.end(), part.bodies.orientation[b].begin(), part.bodies.orientation[b].end());
  }
  const std::vector<double> all = all_gathered(mine, part.comm);
  owner_.resize(global_.size());
  rest_.resize(global_.size());
  axes_.resize(global_.size());
  std::size_t k = 0;
  for (std::size_t r = 0; r < counts.size(); ++r) {
    for (int n = 0; n < counts[r]; ++n, ++k) {
      const auto b = static_cast<std::size_t>(global_[k]);
      const double* row = &all[7 * k];
      owner_[b] = static_cast<std::int32_t>(r);
      rest_[b] = {row[0], row[1], row[2]};
      axes_[b] = {row[3], row[4], row[5], row[6]};
    }
  }
}

std::vector<Pose> ContactHalo::poses(const State<Spatial>& state) const {
  std::vector<double> mine;
  mine.reserve(static_cast<std::size_t>(part_.owned) * 7);
  for (std::int32_t b = 0; b < part_.owned; ++b) {
    const double* r = state.record(static_cast<std::size_t>(b));
    mine.insert(mine.end(), r, r + 7);
  }
  const std::vector<double> all = all_gathered(mine, part_.comm);
  std::vector<Pose> poses(global_.size());
  for (std::size_t k = 0; k < global_.size(); ++k) {
    const auto b = static_cast<std::size_t>(global_[k]);
    const double* r = &all[7 * k];
    poses[b] = {rest_[b] + Vec3<double>{r[0], r[1], r[2]},
                product(Quat<double>{r[3], r[4], r[5], r[6]}, axes_[b])};
  }
  return poses;
}

void ContactHalo::choose(std::span<const std::int32_t> wanted) {
  wanted_.assign(wanted.begin(), wanted.end());
  local_.clear();
  from_.assign(wanted.size(), -1);
  std::vector<std::int32_t> foreign;
  const int me = rank(part_.comm);
  for (const std::int32_t body : wanted_) {
    const bool here = item(owner_, body) == me;
    local_.push_back(here ? part_.local_index(body) : -1);
    if (!here) foreign.push_back(body);
  }
  if (!alone_) connect(sent_by_any(foreign));
}

/// Returns the bodies that any rank wants of another, sorted by owner and index; alike on all
/// ranks. Collective.
/// \param foreign  bodies that this rank wants of others
std::vector<std::int32_t> ContactHalo::sent_by_any(const std::vector<std::int32_t>& foreign) const {
  std::vector<std::int32_t> all = all_gathered(foreign, part_.comm);
  std::sort(all.begin(), all.end(), [&](std::int32_t a, std::int32_t b) {
    return std::pair(item(owner_, a), a) < std::pair(item(owner_, b), b);
  });
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// Chooses the bodies that this rank sends, and finds those that it receives in the buffers of
/// their owners. Collective.
/// \param sent  by any rank, sorted by owner and index
void ContactHalo::connect(const std::vector<std::int32_t>& sent) {
  std::map<std::int32_t, std::int32_t> place;  // of a body in the buffer of its owner
  std::int32_t owner = -1, next = 0;
  sent_.clear();
  sent_at_.clear();
  for (const std::int32_t body : sent) {
    if (item(owner_, body) != owner) next = 0;
    owner = item(owner_, body);
    place[body] = next++;
    if (owner != rank(part_.comm)) continue;
    sent_.push_back(part_.local_index(body));
    // Pairs of an owned body are listed here too, so that the body is wanted here.
    const auto found = std::lower_bound(wanted_.begin(), wanted_.end(), body);
    sent_at_.push_back(static_cast<std::int32_t>(found - wanted_.begin()));
  }
  std::vector<std::int32_t> owners, places;
  auto received = static_cast<std::int32_t>(sent_.size());
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    if (local_[k] >= 0) continue;
    owners.push_back(item(owner_, wanted_[k]));
    places.push_back(place[wanted_[k]]);
    from_[k] = received++;
  }
  buffer_.assign(static_cast<std::size_t>(received) * Spatial::record, 0.0);
  ghosts_ = Ghosts(part_.comm, static_cast<std::int32_t>(sent_.size()), owners, places);
}

void ContactHalo::gather(const State<Spatial>& state, std::span<MovingPose> bodies) {
  if (!alone_) {
    for (std::size_t k = 0; k < sent_.size(); ++k)
      std::copy_n(state.record(static_cast<std::size_t>(sent_[k])), Spatial::record,
                  &buffer_[k * Spatial::record]);
    ghosts_.update(buffer_, Spatial::record);
  }
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const double* r = local_[k] >= 0
                          ? state.record(static_cast<std::size_t>(local_[k]))
                          : &buffer_[static_cast<std::size_t>(from_[k]) * Spatial::record];
    const auto b = static_cast<std::size_t>(wanted_[k]);
    const double* v = r + Spatial::velocity;
    const double* w = r + Spatial::angular_velocity;
    bodies[k] = {{rest_[b] + Vec3<double>{r[0], r[1], r[2]},
                  product(Quat<double>{r[3], r[4], r[5], r[6]}, axes_[b])},
                 {v[0], v[1], v[2]},
                 {w[0], w[1], w[2]}};
  }
}

void ContactHalo::complete(std::span<Acceleration> accelerations) {
  constexpr std::size_t width = sizeof(Acceleration) / sizeof(double);
  if (alone_) return;
  for (std::size_t k = 0; k < sent_.size(); ++k) {
    const Acceleration& a = item(accelerations, sent_at_[k]);
    const std::array<double, width> row{a.linear.x,  a.linear.y,  a.linear.z,
                                        a.angular.x, a.angular.y, a.angular.z};
    std::copy_n(row.begin(), width, &buffer_[k * width]);
  }
  ghosts_.update(buffer_, width);
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    if (local_[k] >= 0) continue;
    const double* row = &buffer_[static_cast<std::size_t>(from_[k]) * width];
    accelerations[k] = {.linear = {row[0], row[1], row[2]}, .angular = {row[3], row[4], row[5]}};
  }
}

}  // namespace floe
