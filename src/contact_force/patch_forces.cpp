#include "contact_force/patch_forces.h"

#include <algorithm>
#include <limits>

#include "base/collectives.h"
#include "contact/surface_patches.h"
#include "floe/base/petsc.h"

namespace floe {

PatchForces::PatchForces(const std::vector<Obstacle>& obstacles) {
  first_.push_back(0);
  for (const Obstacle& o : obstacles) first_.push_back(first_.back() + o.patches.size());
}

PatchSample PatchForces::sample(const Contacts& contacts,
                                std::span<const Vec3<double>> on_obstacles, double time,
                                MPI_Comm comm) {
  forces_.assign(first_.back(), {});
  for (std::size_t k = 0; k < contacts.contacts(); ++k) {
    share_out(contacts.solids().obstacles(), contacts.on_obstacle_of(k, true));
    share_out(contacts.solids().obstacles(), contacts.on_obstacle_of(k, false));
  }
  if (size(comm) > 1 && !forces_.empty())
    sum_over_ranks(std::span(&forces_[0].x, 3 * forces_.size()), comm);
  PatchSample sample{.time = time, .obstacles = {}};
  for (std::size_t k = 0; k + 1 < first_.size(); ++k) {
    if (first_[k] == first_[k + 1]) continue;
    PatchSample::OfObstacle& of = sample.obstacles.emplace_back();
    of.name = contacts.solids().obstacles()[k].name;
    of.force = on_obstacles[k];
    for (std::size_t patch = first_[k]; patch < first_[k + 1]; ++patch) {
      const Vec3<double>& force = forces_[patch];
      if (dot(force, force) > 0) of.loaded.emplace_back(patch - first_[k], force);
    }
  }
  return sample;
}

/// Shares the force of a contact out over the patches that lie in it.
void PatchForces::share_out(const std::vector<Obstacle>& obstacles,
                            const Contacts::OnObstacle& of) {
  if (of.obstacle < 0 || !of.counted) return;
  const auto k = static_cast<std::size_t>(of.obstacle);
  const std::vector<SurfacePatch>& patches = obstacles[k].patches;
  if (patches.empty()) return;
  planes_.clear();
  for (const auto& planes : {of.planes, of.worn})
    for (const HalfSpace& plane : planes) planes_.push_back(placed(plane, of.axes, of.x));
  touched_.clear();
  areas_.clear();
  double sum = 0, shortest = std::numeric_limits<double>::infinity();
  std::size_t nearest = 0;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const double distance = length(patches[p].centre - of.centre);
    if (distance < shortest) shortest = distance, nearest = p;
    if (length(patches[p].centre - of.x) > patches[p].radius + of.radius) continue;
    if (!(dot(patches[p].normal, of.normal) > 0)) continue;
    const double area = area_inside(patches[p], planes_, polygon_, work_);
    if (!(area > 0)) continue;
    touched_.push_back(p);
    areas_.push_back(area);
    sum += area;
  }
  if (touched_.empty()) touched_.push_back(nearest), areas_.push_back(sum = 1);
  for (std::size_t n = 0; n < touched_.size(); ++n) {
    Vec3<double>& force = forces_[first_[k] + touched_[n]];
    force = force + (areas_[n] / sum) * of.force;
  }
}

}  // namespace floe
