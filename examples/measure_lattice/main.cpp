// measure_lattice LATTICE.h5 [X0 Y0 X1 Y1]: reads a lattice, as each run of floe writes one, cuts
// it from (X0, Y0) to (X1, Y1), and measures it before and after: what a sheet of this lattice is
// as a plate, what it weighs and in how many pieces it is.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/beams/moduli.h"
#include "floe/lattice/lattice.h"

namespace {

/// Mass of each piece [kg], the heaviest first: bodies that beams join, directly or by others.
std::vector<double> pieces(const floe::Lattice& lattice) {
  std::vector<std::size_t> piece(lattice.bodies.mass.size());
  std::iota(piece.begin(), piece.end(), std::size_t{0});
  const auto find = [&](std::size_t body) {
    while (piece[body] != body) body = piece[body] = piece[piece[body]];
    return body;
  };
  for (const auto& [i, j] : lattice.beams.bodies)
    piece[find(static_cast<std::size_t>(i))] = find(static_cast<std::size_t>(j));
  std::vector<double> mass(piece.size(), 0);
  for (std::size_t body = 0; body < piece.size(); ++body)
    mass[find(body)] += lattice.bodies.mass[body];
  std::erase(mass, 0);
  std::sort(mass.begin(), mass.end(), std::greater<>());
  return mass;
}

void measure(const char* when, const floe::Lattice& lattice) {
  const std::vector<double> mass = pieces(lattice);
  std::printf("%s: %d bodies, %d beams, %zu piece%s, the heaviest of %.4g kg\n", when,
              lattice.bodies.size(), lattice.beams.size(), mass.size(), mass.size() == 1 ? "" : "s",
              mass.empty() ? 0 : mass.front());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 && argc != 6) {
    std::fprintf(stderr, "usage: measure_lattice LATTICE.h5 [X0 Y0 X1 Y1]\n");
    return 2;
  }
  try {
    floe::Lattice lattice = floe::read_lattice(argv[1]);
    measure("whole", lattice);
    if (lattice.beams.size() > 0) {
      const floe::Shear shear = floe::Shear::one_point;
      const floe::LatticeModuli moduli =
          floe::lattice_moduli(floe::lattice_ratios(lattice, shear), 0.3, shear);
      std::printf("a large sheet of it: E/Eb = %.4f, Poisson's ratio %.4f\n", moduli.young,
                  moduli.poisson);
    }
    if (argc == 6) {
      const auto number = [&](int k) { return std::strtod(argv[k], nullptr); };
      floe::cut(lattice, {number(2), number(3)}, {number(4), number(5)});
      measure("cut", lattice);
    }
  } catch (const floe::InputError& error) {
    std::fprintf(stderr, "measure_lattice: %s\n", error.what());
    return 2;
  }
  return 0;
}
