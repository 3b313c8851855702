#include "model/model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <string_view>

#include "base/collectives.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/files/log.h"

namespace floe {
namespace {

/// Converts bits of x y z rx ry rz to bits of the space's unknowns.
template <class Space>
std::uint8_t bits_of_unknowns(std::uint8_t components) {
  unsigned bits = 0;
  for (std::size_t k = 0; k < Space::components.size(); ++k)
    bits |= (components >> Space::components[k] & 1U) << k;
  return static_cast<std::uint8_t>(bits);
}

/// Bodies of the boundary's set. \throws InputError for an unknown set
const std::vector<std::int32_t>& set_of(const Boundary& boundary, const Lattice& lattice) {
  return lattice.set(boundary.set, "boundary: " + boundary.name + ": set");
}

/// \throws InputError if two boundaries that share bodies move one component differently
void require_same_motion(const Boundary& a, const Boundary& b, std::size_t component,
                         const Lattice& lattice) {
  const double later = std::max({1.0, a.ramp.seconds, b.ramp.seconds});
  std::vector<double> times{0.0, 0.5 * b.ramp.seconds, later, 2 * later};
  for (const Boundary* other : {&a, &b}) {
    const std::vector<double> rows = other->table.table.times();
    for (std::size_t k = 0; k < rows.size(); ++k) {
      times.push_back(rows[k]);
      if (k > 0) times.push_back(0.3 * rows[k - 1] + 0.7 * rows[k]);
    }
  }
  for (const double time : times) {
    if (a.value(time)[component] == b.value(time)[component]) continue;
    std::vector<std::int32_t> common;
    const auto &one = set_of(a, lattice), &other = set_of(b, lattice);
    std::set_intersection(one.begin(), one.end(), other.begin(), other.end(),
                          std::back_inserter(common));
    throw InputError("boundary: " + b.name + ": prescribes " +
                     std::string(component_names[component]) + " of " +
                     std::to_string(common.size()) + " bodies that boundary: " + a.name +
                     " prescribes differently");
  }
}

}  // namespace

std::vector<std::uint8_t> prescribed_components(const Lattice& lattice,
                                                const std::vector<Boundary>& boundaries) {
  std::vector<std::uint8_t> held(static_cast<std::size_t>(lattice.bodies.size()), 0);
  std::vector<const Boundary*> first;  // per body: the first boundary that prescribes the component
  for (std::size_t k = 0; k < component_names.size(); ++k) {
    first.assign(held.size(), nullptr);
    std::map<std::string_view, const Boundary*> on_set;
    for (const Boundary& boundary : boundaries) {
      const auto& set = set_of(boundary, lattice);
      if (!boundary.fixed[k]) continue;
      if (const auto [other, is_new] = on_set.try_emplace(boundary.set, &boundary); !is_new) {
        require_same_motion(*other->second, boundary, k, lattice);
        continue;
      }
      const Boundary* same = nullptr;  // the last earlier boundary with which this one was compared
      for (const std::int32_t body : set) {
        const Boundary*& other = item(first, body);
        if (other == nullptr) {
          other = &boundary;
          item(held, body) |= static_cast<std::uint8_t>(1U << k);
        } else if (other != same) {
          require_same_motion(*other, boundary, k, lattice);
          same = other;
        }
      }
    }
  }
  return held;
}

template <class Space>
Model<Space>::Model(const Lattice& lattice, MPI_Comm comm, const std::vector<Boundary>& boundaries,
                    const Vec3<double>& strips)
    : part_(partition(lattice, comm, strips)) {
  place(lattice, boundaries);
  // Rotations are solved for as lengths (see Tangent): times the mean beam length, or a body's
  // radius of gyration where there are no beams.
  double sum = 0;
  for (const double length : lattice.beams.length) sum += length;
  if (lattice.beams.size() > 0) {
    length_scale_ = sum / lattice.beams.size();
  } else {
    length_scale_ = std::sqrt(lattice.bodies.inertia[0][0] / lattice.bodies.mass[0]);
  }
}

/// Finds the boundaries' bodies on this rank, and starts with the bodies' own masses.
template <class Space>
void Model<Space>::place(const Lattice& lattice, const std::vector<Boundary>& boundaries) {
  inertial_mass_ = part_.bodies.mass;
  const std::vector<std::uint8_t> all = prescribed_components(lattice, boundaries);
  for (const std::int32_t body : part_.global)
    prescribed_.push_back(bits_of_unknowns<Space>(item(all, body)));
  held_ = prescribed_;
  for (const Boundary& boundary : boundaries)
    boundaries_.push_back(
        {boundary, part_.localise(lattice.set(boundary.set, "boundary: " + boundary.name))});
}

template <class Space>
void Model<Space>::divide(const Lattice& lattice, const std::vector<std::int32_t>& owner) {
  beams_ = nullptr;
  fracture_ = nullptr;
  forces_.clear();  // they refer to the part
  added_inertia_.clear();
  std::vector<Boundary> boundaries;
  for (const PlacedBoundary& placed : boundaries_) boundaries.push_back(placed.boundary);
  boundaries_.clear();
  prescribed_.clear();
  part_ = partition(lattice, part_.comm, owner);
  place(lattice, boundaries);
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
std::vector<double> Model<Space>::changes(double end) const {
  std::vector<double> ends;
  const auto take = [&ends](const std::vector<double>& times) {
    ends.insert(ends.end(), times.begin(), times.end());
  };
  for (const PlacedBoundary& placed : boundaries_) {
    ends.push_back(placed.boundary.ramp.seconds);
    take(placed.boundary.table.table.times_until(end));
  }
  for (const auto& force : forces_) {
    if (const auto* role = force->roles().time) take(role->changes(end));
  }
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
      item(held_, local) |= bits_of_unknowns<Space>(static_cast<std::uint8_t>(1U << p.component));
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
      const std::int32_t row = rows.empty() ? body : item(rows, body);
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
std::vector<std::pair<std::string, double>> Model<Space>::report(
    const State<Space>& state, std::span<const double> works) const {
  Columns columns;
  for (const auto& force : forces_) {
    const auto* role = force->roles().work;
    const std::size_t count = role != nullptr ? role->works() : 0;
    force->report(state, works.first(count), columns);
    works = works.subspan(count);
  }
  // Forces of the same kind (several loads) share a column.
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
  for (auto& [name, value] : sums) value = sum_over_ranks(value, part_.comm);
  return sums;
}

template class Model<Spatial>;
template class Model<Planar>;

}  // namespace floe
