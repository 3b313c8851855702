#include "floe/forces/fracture.h"

#include <cmath>

#include "floe/base/ranks.h"
#include "forces/breakable_beams.h"

namespace floe {
namespace {

/// A number in (0, 1) from a seed and an index (SplitMix64; Steele, Lea & Flood 2014).
double uniform(std::uint64_t seed, std::int32_t index) {
  std::uint64_t z = seed * 0xD1342543DE82EF95U + static_cast<std::uint64_t>(index) + 1;
  for (int round = 0; round < 2; ++round) {  // twice: seeds and indices are small numbers
    z += 0x9E3779B97F4A7C15U;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    z ^= z >> 31U;
  }
  return (static_cast<double>(z >> 11U) + 0.5) * 0x1p-53;
}

/// Mean section over the whole lattice, the same bits on any number of ranks: sums of integers.
double mean_section(const Part& part) {
  double largest = 0;
  const auto area = [&](std::size_t m) { return part.beams.width[m] * part.beams.height[m]; };
  for (std::size_t m = 0; m < part.beams.bodies.size(); ++m) largest = std::max(largest, area(m));
  largest = largest_over_ranks(largest, part.comm);
  constexpr double fine = 0x1p31;
  std::int64_t sum = 0, all = 0;
  for (std::size_t m = 0; m < part.beams.bodies.size(); ++m) {
    if (part.counts_here[m]) sum += std::llround(fine * (area(m) / largest));
  }
  MPI_Allreduce(&sum, &all, 1, MPI_INT64_T, MPI_SUM, part.comm);
  return largest * (static_cast<double>(all) / fine) / static_cast<double>(part.global_beams);
}

constexpr std::size_t crack_size = 11;

std::vector<double> packed(const std::vector<Crack>& cracks) {
  std::vector<double> values;
  values.reserve(cracks.size() * crack_size);
  for (const Crack& c : cracks) {
    values.insert(values.end(),
                  {static_cast<double>(c.beam), c.kappa, c.damage, c.ultimate, c.mode_mix,
                   c.nominal, c.dissipated, c.time, c.place[0], c.place[1], c.place[2]});
  }
  return values;
}

}  // namespace

double weibull_factor(std::uint64_t seed, std::int32_t beam, double modulus, double area_ratio) {
  return std::pow(-std::log(uniform(seed, beam)) / area_ratio, 1 / modulus) /
         std::tgamma(1 + 1 / modulus);
}

std::vector<Strength<double>> strengths(const Part& part, const FractureOptions& options) {
  const Beams& beams = part.beams;
  const auto sides = [&](const std::vector<double>& all) {
    return all.size() == beams.bodies.size();
  };
  int missing = sides(beams.width) && sides(beams.height) ? 0 : 1;
  MPI_Allreduce(MPI_IN_PLACE, &missing, 1, MPI_INT, MPI_MAX, part.comm);
  if (missing != 0)
    throw InputError(
        "forces: fracture needs the sides of the beams' sections: the lattice file has no "
        "/beams/width and /beams/height");
  const bool scattered = options.weibull_modulus > 0;
  const double reference = !scattered                 ? 1
                           : options.weibull_area > 0 ? options.weibull_area
                                                      : mean_section(part);
  std::vector<Strength<double>> all;
  all.reserve(beams.bodies.size());
  for (std::size_t m = 0; m < beams.bodies.size(); ++m) {
    const double w = beams.width[m], h = beams.height[m];
    const double factor = scattered ? weibull_factor(options.seed, part.global_beam[m],
                                                     options.weibull_modulus, w * h / reference)
                                    : 1;
    all.push_back(
        section_strength(w, h, factor * options.tensile_strength, factor * options.shear_strength));
  }
  return all;
}

double overload(const Part& part, const std::vector<BeamSection>& sections,
                FractureOptions fracture) {
  fracture.weibull_modulus = 0;
  const std::vector<Strength<double>> all = strengths(part, fracture);
  double most = 0;
  for (std::size_t m = 0; m < sections.size(); ++m) {
    const auto& [n, qy, qz, t, my, mz] = sections[m];
    most = std::max(most, criterion(all[m], BeamStress<double>{n, qy, qz, {t, my, mz}}));
  }
  return std::sqrt(largest_over_ranks(most, part.comm));
}

void remember_cracks(Memory& memory, const Part& part, std::vector<Crack>& cracks) {
  constexpr std::size_t width = crack_size;
  std::vector<double> mine = packed(cracks), all;
  const auto ranks = static_cast<std::size_t>(size(part.comm));
  if (!memory.loading()) {
    const int count = static_cast<int>(mine.size());
    std::vector<int> counts(ranks), offsets(ranks, 0);
    MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, part.comm);
    for (std::size_t r = 1; r < ranks; ++r) offsets[r] = offsets[r - 1] + counts[r - 1];
    all.resize(static_cast<std::size_t>(offsets.back()) + static_cast<std::size_t>(counts.back()));
    MPI_Allgatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), offsets.data(),
                   MPI_DOUBLE, part.comm);
  }
  memory.common("cracks", all);
  if (!memory.loading()) return;
  cracks.clear();
  for (std::size_t k = 0; k + width <= all.size(); k += width) {
    const double* v = &all[k];
    cracks.push_back({static_cast<std::int32_t>(v[0]),
                      v[1],
                      v[2],
                      v[3],
                      v[4],
                      v[5],
                      v[6],
                      v[7],
                      {v[8], v[9], v[10]}});
  }
}

Worst worst_of(const Worst& mine, MPI_Comm comm) {
  Worst all{};
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm);
  return all;
}

namespace {

template <Kinematics kinematics, bool damped, template <class> class Frame>
BreakableForce make_with(const Part& part, const BeamOptions& beams,
                         const FractureOptions& fracture) {
  auto force = std::make_unique<BreakableBeams<kinematics, damped, Frame>>(part, beams, fracture);
  Fracture* cracks = force.get();
  return {std::move(force), cracks};
}

template <Kinematics kinematics>
BreakableForce make_kinematic(const Part& part, const BeamOptions& beams,
                              const FractureOptions& fracture) {
  const bool damped = beams.damping_ratio > 0;
  if (all_flat(part))
    return damped ? make_with<kinematics, true, FlatFrame>(part, beams, fracture)
                  : make_with<kinematics, false, FlatFrame>(part, beams, fracture);
  return damped ? make_with<kinematics, true, AnyFrame>(part, beams, fracture)
                : make_with<kinematics, false, AnyFrame>(part, beams, fracture);
}

}  // namespace

BreakableForce make_breakable_beams(const Part& part, const BeamOptions& beams,
                                    const FractureOptions& fracture) {
  return beams.kinematics == Kinematics::linear
             ? make_kinematic<Kinematics::linear>(part, beams, fracture)
             : make_kinematic<Kinematics::corotational>(part, beams, fracture);
}

}  // namespace floe
