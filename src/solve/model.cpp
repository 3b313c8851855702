#include "floe/solve/model.h"

#include <algorithm>
#include <cmath>

#include "floe/base/log.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

/// Bits of a space's unknowns from bits of x y z rx ry rz.
template <class Space>
std::uint8_t bits_of_unknowns(std::uint8_t components) {
  unsigned bits = 0;
  for (std::size_t k = 0; k < Space::components.size(); ++k)
    bits |= (components >> Space::components[k] & 1U) << k;
  return static_cast<std::uint8_t>(bits);
}

}  // namespace

std::vector<std::uint8_t> prescribed_components(const Lattice& lattice,
                                                const std::vector<Boundary>& boundaries) {
  std::vector<std::uint8_t> held(static_cast<std::size_t>(lattice.bodies.size()), 0);
  for (std::size_t b = 0; b < boundaries.size(); ++b) {
    const Boundary& boundary = boundaries[b];
    const auto& set = lattice.set(boundary.set, "boundary: " + boundary.name + ": set");
    // Boundaries before this one that prescribe the same component of one of its bodies must agree
    // with it.
    for (std::size_t a = 0; a < b; ++a) {
      const auto& other =
          lattice.set(boundaries[a].set, "boundary: " + boundaries[a].name + ": set");
      std::vector<std::int32_t> common;
      std::set_intersection(set.begin(), set.end(), other.begin(), other.end(),
                            std::back_inserter(common));
      if (common.empty()) continue;
      constexpr std::array<const char*, 6> names{"x", "y", "z", "rx", "ry", "rz"};
      for (std::size_t k = 0; k < 6; ++k) {
        if (!boundary.fixed[k] || !boundaries[a].fixed[k]) continue;
        const double later = std::max({1.0, boundary.ramp.seconds, boundaries[a].ramp.seconds});
        for (const double time : {0.0, 0.5 * boundary.ramp.seconds, later, 2 * later}) {
          if (boundary.value(time)[k] != boundaries[a].value(time)[k])
            throw InputError("boundary: " + boundary.name + ": prescribes " + names[k] + " of " +
                             std::to_string(common.size()) + " bodies that boundary: " +
                             boundaries[a].name + " prescribes differently");
        }
      }
    }
    for (const std::int32_t body : set) {
      for (std::size_t k = 0; k < 6; ++k) {
        if (boundary.fixed[k])
          held[static_cast<std::size_t>(body)] |= static_cast<std::uint8_t>(1U << k);
      }
    }
  }
  return held;
}

template <class Space>
Model<Space>::Model(const Lattice& lattice, MPI_Comm comm, const std::vector<Boundary>& boundaries)
    : part_(partition(lattice, comm)), inertial_mass_(part_.bodies.mass) {
  const std::vector<std::uint8_t> all = prescribed_components(lattice, boundaries);
  for (const std::int32_t body : part_.global)
    prescribed_.push_back(bits_of_unknowns<Space>(all[static_cast<std::size_t>(body)]));
  held_ = prescribed_;
  for (const Boundary& boundary : boundaries)
    boundaries_.push_back(
        {boundary, part_.localise(lattice.set(boundary.set, "boundary: " + boundary.name))});
  // Rotations are solved for as lengths (see Tangent): times the mean beam, or a body's radius of
  // gyration.
  double sum = 0;
  for (const double length : lattice.beams.length) sum += length;
  if (lattice.beams.size() > 0) {
    length_scale_ = sum / lattice.beams.size();
  } else {
    length_scale_ = std::sqrt(lattice.bodies.inertia[0][0] / lattice.bodies.mass[0]);
  }
}

template <class Space>
void Model<Space>::release_sections() {
  Beams kept;
  kept.bodies = std::move(part_.beams.bodies);
  part_.beams = std::move(kept);
}

template <class Space>
void Model<Space>::set_beams(std::unique_ptr<BeamForce<Space>> beams, Kinematics kinematics) {
  beams_ = beams.get();
  kinematics_ = kinematics;
  forces_.push_back(std::move(beams));
}

template <class Space>
void Model<Space>::add_mass(std::span<const double> added) {
  for (std::size_t b = 0; b < added.size(); ++b) inertial_mass_[b] += added[b];
}

template <class Space>
void Model<Space>::evaluate(const State<Space>& state, Wrenches<Space>& wrenches) const {
  const Timed timed(Event::forces);
  std::fill(wrenches.values.begin(), wrenches.values.end(), 0.0);
  for (const auto& force : forces_) force->add(state, wrenches);
}

template <class Space>
auto Model<Space>::evaluate_apart(const State<Space>& state, Wrenches<Space>& wrenches,
                                  Wrenches<Space>& share) const -> Squares {
  std::fill(wrenches.values.begin(), wrenches.values.end(), 0.0);
  const auto square_of = [&](const Wrenches<Space>& all) {
    double sum = 0;
    const double scale = 1.0 / length_scale_;
    for (std::size_t k = 0; k < static_cast<std::size_t>(part_.owned) * n; ++k) {
      const double value = all.at(k) * (k % n < Space::translations ? 1.0 : scale);
      sum += value * value;
    }
    return sum;
  };
  Squares squares;
  for (const auto& force : forces_) {
    if (force.get() == beams_) continue;
    std::fill(share.values.begin(), share.values.end(), 0.0);
    force->add(state, share);
    squares.apart += square_of(share);
    for (std::size_t k = 0; k < wrenches.values.size(); ++k) wrenches.values[k] += share.values[k];
  }
  squares.together = square_of(wrenches);
  if (beams_ != nullptr) beams_->add(state, wrenches);
  return squares;
}

template <class Space>
std::vector<double> Model<Space>::ramp_ends() const {
  std::vector<double> ends;
  for (const PlacedBoundary& placed : boundaries_) ends.push_back(placed.boundary.ramp.seconds);
  for (const auto& force : forces_) ends.push_back(force->settles());
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  if (!ends.empty() && ends.front() == 0) ends.erase(ends.begin());
  return ends;
}

template <class Space>
void Model<Space>::pin(const std::vector<Pin>& pins) {
  held_ = prescribed_;
  for (const Pin& p : pins) {
    const std::int32_t local = part_.local_index(p.body);
    if (local >= 0)
      held_[static_cast<std::size_t>(local)] |=
          bits_of_unknowns<Space>(static_cast<std::uint8_t>(1U << p.component));
  }
}

template <class Space>
void Model<Space>::prescribe(double time, std::span<double> values,
                             std::span<const std::int32_t> rows) const {
  spread(&Boundary::value, time, values, rows);
}

template <class Space>
void Model<Space>::prescribe_rates(double time, std::span<double> rates) const {
  spread(&Boundary::rate, time, rates);
}

template <class Space>
void Model<Space>::prescribe_accelerations(double time, std::span<double> accelerations) const {
  spread(&Boundary::acceleration, time, accelerations);
}

template <class Space>
void Model<Space>::spread(Prescription motion, double time, std::span<double> values,
                          std::span<const std::int32_t> rows) const {
  for (const PlacedBoundary& placed : boundaries_) {
    const std::array<double, 6> value = (placed.boundary.*motion)(time);
    for (const std::int32_t body : placed.bodies) {
      const std::int32_t row = rows.empty() ? body : rows[static_cast<std::size_t>(body)];
      if (row < 0) continue;
      for (std::size_t k = 0; k < n; ++k) {
        const auto component = static_cast<std::size_t>(Space::components[k]);
        if (placed.boundary.fixed[component])
          values[static_cast<std::size_t>(row) * n + k] = value[component];
      }
    }
  }
}

template <class Space>
std::vector<std::pair<std::string, double>> Model<Space>::report(const State<Space>& state) const {
  Columns columns;
  for (const auto& force : forces_) force->report(state, columns);
  // Forces of one kind (several loads) share a column.
  std::vector<std::pair<std::string, double>> sums;
  for (const auto& [name, value] : columns.values()) {
    const auto found =
        std::find_if(sums.begin(), sums.end(), [&](const auto& s) { return s.first == name; });
    if (found == sums.end()) {
      sums.emplace_back(name, value);
    } else {
      found->second += value;
    }
  }
  for (auto& [name, value] : sums) {
    const double mine = value;
    MPI_Allreduce(&mine, &value, 1, MPI_DOUBLE, MPI_SUM, part_.comm);
  }
  return sums;
}

template class Model<Spatial>;
template class Model<Planar>;

}  // namespace floe
