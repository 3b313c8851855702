#include "contact_force/obstacle_forces.h"

#include <span>
#include <string>
#include <utility>

#include "base/collectives.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

void add(Columns& columns, const std::string& name, const Vec3<double>& v) {
  columns.add(name + "_x", v.x);
  columns.add(name + "_y", v.y);
  columns.add(name + "_z", v.z);
}

}  // namespace

std::span<const Vec3<double>> ObstacleForces::now(const Contacts& contacts, MPI_Comm comm) {
  const std::size_t n = peak_.size();
  forces_.clear();
  for (std::size_t k = 0; k < n; ++k) forces_.push_back(contacts.on_obstacle(k).force);
  if (size(comm) > 1 && n > 0) sum_over_ranks(std::span(&forces_[0].x, 3 * n), comm);
  return forces_;
}

void ObstacleForces::take(const Contacts& contacts, double dt, MPI_Comm comm) {
  const std::size_t n = peak_.size();
  if (n == 0) return;
  now(contacts, comm);
  for (std::size_t k = 0; k < n; ++k) {
    if (dot(forces_[k], forces_[k]) > dot(peak_[k], peak_[k])) peak_[k] = forces_[k];
    impulse_[k] = impulse_[k] + dt * forces_[k];
  }
  time_ += dt;
}

std::vector<std::array<double, 6>> ObstacleForces::numbers() const {
  std::vector<std::array<double, 6>> all;
  for (std::size_t k = 0; k < peak_.size(); ++k) {
    const Vec3<double>&p = peak_[k], &i = impulse_[k];
    all.push_back({p.x, p.y, p.z, i.x, i.y, i.z});
  }
  return all;
}

void ObstacleForces::set_numbers(std::span<const std::array<double, 6>> numbers) {
  for (std::size_t k = 0; k < peak_.size(); ++k) {
    const auto& n = numbers[k];
    peak_[k] = {n[0], n[1], n[2]};
    impulse_[k] = {n[3], n[4], n[5]};
  }
}

void ObstacleForces::report(const Contacts& contacts, bool first, Columns& columns) const {
  const double share = first && time_ > 0 ? 1 / time_ : 0.0;
  for (std::size_t k = 0; k < peak_.size(); ++k) {
    const std::string& name = contacts.solids().obstacles()[k].name;
    const ContactWrench& wrench = contacts.on_obstacle(k);
    add(columns, name + "_force", wrench.force);
    add(columns, name + "_moment", wrench.moment);
    add(columns, name + "_peak_force", first ? peak_[k] : Vec3<double>{});
    add(columns, name + "_mean_force", share * impulse_[k]);
  }
}

void ObstacleForces::persist(const std::vector<Obstacle>& obstacles, Archive& archive) {
  const auto common = [&](const std::string& name, Vec3<double>& v) {
    archive.common(name + "_x", v.x);
    archive.common(name + "_y", v.y);
    archive.common(name + "_z", v.z);
  };
  for (std::size_t k = 0; k < peak_.size(); ++k) {
    common("peak_" + obstacles[k].name, peak_[k]);
    common("impulse_" + obstacles[k].name, impulse_[k]);
  }
}

}  // namespace floe
