#include "fracture_laws/strengths.h"

#include <cmath>

#include "base/collectives.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/lattice/material.h"

namespace floe {
namespace {

/// A number in (0, 1) from a seed and an index (SplitMix64; Steele, Lea & Flood 2014).
double uniform(std::uint64_t seed, std::int32_t index) {
  std::uint64_t z = seed * 0xD1342543DE82EF95U + static_cast<std::uint64_t>(index) + 1;
  for (int round = 0; round < 2; ++round) {  // twice, since seeds and indices are small numbers
    z += 0x9E3779B97F4A7C15U;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    z ^= z >> 31U;
  }
  return (static_cast<double>(z >> 11U) + 0.5) * 0x1p-53;
}

/// Mean section of the beams of the whole lattice [m^2]. Sums of integers give the same bits on any
/// number of ranks. Collective.
double mean_section(const Part& part) {
  double largest = 0;
  const auto area = [&](std::size_t m) { return part.beams.width[m] * part.beams.height[m]; };
  for (std::size_t m = 0; m < part.beams.bodies.size(); ++m) largest = std::max(largest, area(m));
  largest = largest_over_ranks(largest, part.comm);
  constexpr double fine = 0x1p31;
  std::int64_t sum = 0;
  for (std::size_t m = 0; m < part.beams.bodies.size(); ++m) {
    if (part.counts_here[m]) sum += std::llround(fine * (area(m) / largest));
  }
  sum = sum_over_ranks(sum, part.comm);
  return largest * (static_cast<double>(sum) / fine) / static_cast<double>(part.global_beams);
}

}  // namespace

double weibull_factor(std::uint64_t seed, std::int32_t beam, double modulus, double area_ratio) {
  return std::pow(-std::log(uniform(seed, beam)) / area_ratio, 1 / modulus) /
         std::tgamma(1 + 1 / modulus);
}

namespace {

/// Part of the torsional moment of a beam that its section carries as a free bar. A torsion
/// constant beyond Saint-Venant's (narrow facets of a calibrated sheet, or Iy + Iz) stands for the
/// plate around the beam: the section has the stress that its twist makes of it, or narrow facets
/// would break under next to no load.
double share_of_section(double torsion, double w, double h) {
  return std::min(1.0, saint_venant_torsion(w, h) / torsion);
}

}  // namespace

std::vector<Strength<double>> strengths(const Part& part, const FractureOptions& options) {
  const Beams& beams = part.beams;
  const auto sides = [&](const std::vector<double>& all) {
    return all.size() == beams.bodies.size();
  };
  if (!on_all_ranks(sides(beams.width) && sides(beams.height), part.comm))
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
    const double scatter = scattered ? weibull_factor(options.seed, part.global_beam[m],
                                                      options.weibull_modulus, w * h / reference)
                                     : 1;
    const double all_of_it = scatter * factor(beams.strength, static_cast<std::int32_t>(m));
    all.push_back(section_strength(w, h, all_of_it * options.tensile_strength,
                                   all_of_it * options.shear_strength));
    all.back().bending_y *= options.bending_factor;
    all.back().torsion *= options.bending_factor * share_of_section(beams.torsion[m], w, h);
  }
  return all;
}

Criterion needed_criterion(const FractureOptions& options) {
  return options.bending_factor != 1 || options.compressive_strength > 0 ? Criterion::general
                                                                         : Criterion::plain;
}

FurtherStrength<double> further_strength(const FractureOptions& options) {
  FurtherStrength<double> further{options.bending_factor, 0, 0};
  if (options.compressive_strength > 0) {
    further.pressure = options.tensile_strength / (2 * options.shear_strength);
    further.friction = 1 - 2 * options.shear_strength / options.compressive_strength;
  }
  return further;
}

Strength<double> tip_strength(const Part& part, std::int32_t beam, const FractureOptions& options) {
  constexpr double in_plane = 2.45, out_of_plane = 4.0;  // kappa, measured on notched sheets
  const Beams& beams = part.beams;
  const double w = item(beams.width, beam), h = item(beams.height, beam);
  const double energy = options.energy * factor(beams.energy, beam);
  const double scale = item(beams.young, beam) * energy / item(beams.length, beam);
  const double membrane = std::sqrt(2 / in_plane * scale),
               bending = std::sqrt(6 / out_of_plane * scale);
  const Strength<double> stretched = section_strength(w, h, membrane, bending),
                         bent = section_strength(w, h, bending, bending);
  return {stretched.axial, bent.bending_y, stretched.bending_z, stretched.shear, stretched.torsion};
}

double overload(const Part& part, const std::vector<BeamSection>& sections,
                FractureOptions fracture) {
  fracture.weibull_modulus = 0;
  fracture.compressive_strength = 0;
  const std::vector<Strength<double>> all = strengths(part, fracture);
  const FurtherStrength<double> further = further_strength(fracture);
  double most = 0;
  for (std::size_t m = 0; m < sections.size(); ++m) {
    const auto& [n, qy, qz, t, my, mz] = sections[m];
    const BeamStress<double> stress{n, qy, qz, {t, my, mz}};
    most = std::max(most, criteria(all[m], further, stress, false).tension);
  }
  return std::sqrt(largest_over_ranks(most, part.comm));
}

}  // namespace floe
