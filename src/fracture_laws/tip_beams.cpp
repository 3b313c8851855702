#include "fracture_laws/tip_beams.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/collectives.h"
#include "floe/base/item.h"
#include "fracture_laws/strengths.h"

namespace floe {

double overload_of(std::int32_t beam, const std::vector<TipOverload>& sorted) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), TipOverload{beam, 0});
  return at != sorted.end() && at->beam == beam ? at->s : 0.0;
}

TipBeams::TipBeams(const Part& part, const FractureOptions& options, bool linear,
                   Junctions junctions)
    : part_(part),
      options_(options),
      linear_(linear),
      tips_(std::move(junctions)),
      doomed_(part.beams.bodies.size(), 0) {}

// -- Strengths
bool TipBeams::weakens(std::int32_t m, const Strength<double>& whole) const {
  if (!tips_.is_tip(item(part_.global_beam, m))) return false;
  const Strength<double> tip = tip_strength(part_, m, options_);
  return tip.axial > whole.axial || tip.bending_y > whole.bending_y;
}

TipBeams::Strengths TipBeams::armed(std::int32_t m, const Strengths& whole) const {
  Strength<double> first = whole.first;
  const Strength<double> tip = tip_strength(part_, m, options_);
  const auto earlier = [](double& of, double at_tip) { of = std::max(of, at_tip / armed_from); };
  earlier(first.axial, tip.axial), earlier(first.bending_y, tip.bending_y);
  earlier(first.bending_z, tip.bending_z), earlier(first.shear, tip.shear);
  earlier(first.torsion, tip.torsion);
  double transverse = whole.first.shear * whole.further.transverse;
  earlier(transverse, tip.shear);
  // Without friction s under pressure is at least that at initiation.
  return {first, {transverse / first.shear, whole.further.pressure, 0}};
}

// -- Overloads
/// Square of the opening that counts as much as a unit turn of the faces against each other, of
/// the plate that the lattice is [m^2].
double TipBeams::bent_opening(std::int32_t m) const {
  const LatticeModuli& sheet = tips_.junctions().moduli;
  const double nu = sheet.bending_poisson, h = item(part_.beams.height, m);
  return h * h / 12 * sheet.bending / sheet.young * (1 - nu) * (3 + nu);
}

/// Poses of bodies of the whole lattice. Collective. \param bodies  sorted, alike on all ranks
std::vector<BodyPose> TipBeams::poses_of(const std::vector<std::int32_t>& bodies,
                                         const State<Spatial>& state) const {
  constexpr std::size_t size = 7;
  std::vector<double> values(size * bodies.size(), 0.0);
  const auto owned = part_.global.begin() + part_.owned;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const auto found = std::lower_bound(part_.global.begin(), owned, bodies[k]);
    if (found == owned || *found != bodies[k]) continue;
    const double* r = state.record(static_cast<std::size_t>(found - part_.global.begin()));
    std::copy_n(r, 3, &values[size * k]);
    std::copy_n(r + Spatial::rotation, 4, &values[size * k + 3]);
  }
  sum_over_ranks(std::span<double>(values), part_.comm);  // all but one are 0: no rounding
  std::vector<BodyPose> poses;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const double* v = &values[size * k];
    poses.push_back({{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}});
  }
  return poses;
}

std::vector<TipOverload> TipBeams::overloads(const std::vector<ArmedBeam>& mine,
                                             const State<Spatial>& state) const {
  std::vector<double> rows;
  for (const auto& [s, m] : mine)
    rows.insert(rows.end(), {static_cast<double>(item(part_.global_beam, m)), s,
                             item(part_.beams.young, m) * tips_.junctions().moduli.young,
                             bent_opening(m), options_.energy * factor(part_.beams.energy, m)});
  rows = all_gathered(rows, part_.comm);
  if (rows.empty()) return {};
  struct Tip {
    std::int32_t beam;
    double s, young, bent, energy;
    std::vector<CrackBehind> cracks;
  };
  std::vector<Tip> beams;
  std::vector<std::int32_t> bodies;
  for (std::size_t k = 0; k + 5 <= rows.size(); k += 5) {
    const auto beam = static_cast<std::int32_t>(rows[k]);
    beams.push_back({beam, rows[k + 1], rows[k + 2], rows[k + 3], rows[k + 4], tips_.behind(beam)});
    tips_.append_bodies(beams.back().cracks, bodies);
  }
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  const std::vector<BodyPose> poses = poses_of(bodies, state);
  const auto pose_of = [&](std::int32_t body) {
    return item(poses, std::lower_bound(bodies.begin(), bodies.end(), body) - bodies.begin());
  };
  std::vector<TipOverload> all;
  for (const Tip& tip : beams) {
    double most = 0;
    for (const CrackBehind& crack : tip.cracks) {
      const double released =
          tip.young * tips_.opening(crack, tip.bent, linear_, pose_of) / tip.energy;
      const double s_open = std::sqrt(released);
      most = std::max(most, s_open * std::min(s_open, tip.s));
    }
    if (most > 0) all.push_back({tip.beam, std::sqrt(most)});
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// -- Beams that are gone
/// Local index of a global beam, or none.
std::int32_t TipBeams::local_beam(std::int32_t global) const {
  const auto& all = part_.global_beam;
  const auto found = std::lower_bound(all.begin(), all.end(), global);
  return found == all.end() || *found != global ? none
                                                : static_cast<std::int32_t>(found - all.begin());
}

/// Notes that a global beam is gone: tips change.
void TipBeams::lose(std::int32_t global, Change& change) {
  if (!tips_.lose(global)) return;
  lost_.push_back(global);
  tips_.for_neighbours(global, [&](std::int32_t beam) {
    if (const std::int32_t m = local_beam(beam); m != none) change.strengths.push_back(m);
  });
}

/// Beams that will break in the next evaluation, whatever their s.
void TipBeams::doom(std::int32_t global, Change& change) {
  all_doomed_.push_back(global);
  const std::int32_t m = local_beam(global);
  if (m == none) return;
  item(doomed_, m) = 1;
  change.doomed.push_back(m);
}

TipBeams::Change TipBeams::propagate(const std::vector<std::int32_t>& broken,
                                     const std::vector<ArmedBeam>& overloaded,
                                     const State<Spatial>& state) {
  Change change;
  for (const std::int32_t m : all_doomed_) {
    const std::int32_t here = local_beam(m);
    if (here == none) continue;
    item(doomed_, here) = 0;
    change.doomed.push_back(here);
  }
  all_doomed_.clear();
  if (!on_any_rank(!broken.empty() || !overloaded.empty(), part_.comm)) return change;
  std::vector<std::int32_t> broken_here;
  broken_here.reserve(broken.size());
  for (const std::int32_t m : broken) broken_here.push_back(item(part_.global_beam, m));
  for (const std::int32_t beam : all_gathered(broken_here, part_.comm)) lose(beam, change);
  std::vector<TipOverload> turns = overloads(overloaded, state);
  std::sort(turns.begin(), turns.end(), [](const TipOverload& a, const TipOverload& b) {
    return std::pair(-a.s, a.beam) < std::pair(-b.s, b.beam);
  });
  for (const auto& [beam, s] : turns) {
    if (s <= 1 || !tips_.is_tip(beam)) continue;
    lose(beam, change);
    doom(beam, change);
  }
  lost_.clear();
  return change;
}

TipBeams::Change TipBeams::lose(std::int32_t global) {
  Change change;
  lose(global, change);
  return change;
}

void TipBeams::keep() {
  lost_before_.insert(lost_before_.end(), lost_.begin(), lost_.end());
  lost_.clear();
}

void TipBeams::retreat() {
  tips_.reset();
  for (const std::int32_t beam : lost_before_) (void)tips_.lose(beam);
  lost_.clear();
}

TipBeams::Change TipBeams::persist(Archive& archive, const std::vector<Crack>& cracks) {
  Change change;
  std::vector<double> doomed(all_doomed_.begin(), all_doomed_.end());
  archive.common("doomed", doomed);
  if (!archive.loading()) return change;
  for (const Crack& c : cracks) {
    if (c.broken()) (void)tips_.lose(c.beam);
  }
  for (const double beam : doomed) {
    (void)tips_.lose(static_cast<std::int32_t>(beam));
    doom(static_cast<std::int32_t>(beam), change);
  }
  return change;
}

}  // namespace floe
