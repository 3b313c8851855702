#include "lattice/packed_lattice.h"

#include <algorithm>

namespace floe {
namespace {

std::array<std::vector<double>*, 4> columns(Beams& beams) {
  return {&beams.young, &beams.shear_modulus, &beams.shear_factor, &beams.height};
}

}  // namespace

void PackedLattice::pack_shapes(Lattice& lattice) {
  if (prisms_) return;
  prisms_ = as_prisms(lattice.shapes);
  if (prisms_) lattice.shapes = {};
}

void PackedLattice::pack_beams(Lattice& lattice) {
  const auto all = columns(lattice.beams);
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::vector<double>& column = *all[k];
    const bool uniform =
        !column.empty() &&
        std::all_of(column.begin(), column.end(), [&](double x) { return x == column.front(); });
    if (!uniform) continue;
    shared_[k] = column.front();
    column = {};
  }
}

void PackedLattice::pack_bodies(Lattice& lattice, const Bodies& copy) {
  const Bodies& b = lattice.bodies;
  const bool same = b.position == copy.position && b.orientation == copy.orientation &&
                    b.mass == copy.mass && b.inertia == copy.inertia &&
                    b.velocity == copy.velocity && b.angular_velocity == copy.angular_velocity &&
                    b.dry == copy.dry;
  if (!same) return;
  bodies_ = &copy;
  lattice.bodies = {};
}

void PackedLattice::unpack(Lattice& lattice) {
  if (bodies_ != nullptr) lattice.bodies = *bodies_;
  if (prisms_) lattice.shapes = polyhedra(*prisms_);
  const auto all = columns(lattice.beams);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (const auto& value = shared_[k]) all[k]->assign(lattice.beams.bodies.size(), *value);
  }
  *this = {};
}

}  // namespace floe
