/// \file
/// A patch of the regular triangular lattice (model.md, "Effective moduli of the lattice,
/// calibrated sheets").
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "floe/beams/moduli.h"
#include "floe/lattice/lattice.h"

namespace floe::test {

/// All points within `rings` neighbours of the origin's body (a hexagon), rotated by `turn` [rad]
/// about z; beams of section l/sqrt(3) x h join neighbours. Sets: `rim`, the outermost ring, whose
/// bodies lack neighbours, and one set of one body `rimN` for each of them. Body `centre` is the
/// one at the origin.
struct Triangles {
  Lattice lattice;
  std::int32_t centre = 0;
  double cell = 0;  ///< area of a body's hexagon [m^2]
};

inline Triangles triangles(int rings, double l, double h, const Ice& ice, double shear_factor,
                           Torsion torsion, double turn = 0) {
  Triangles t;
  t.cell = std::sqrt(3.0) / 2 * l * l;
  Lattice& lattice = t.lattice;
  const auto distance = [](int a, int b) {
    return std::max({std::abs(a), std::abs(b), std::abs(a + b)});
  };
  const int side = 2 * rings + 1;
  std::vector<std::int32_t> number(static_cast<std::size_t>(side * side), -1);
  const auto at = [&](int a, int b) -> std::int32_t& {
    return number[static_cast<std::size_t>((a + rings) * side + b + rings)];
  };
  const double c = std::cos(turn), s = std::sin(turn);
  for (int a = -rings; a <= rings; ++a) {
    for (int b = -rings; b <= rings; ++b) {
      if (distance(a, b) > rings) continue;
      const double x = l * (a + 0.5 * b), y = l * std::sqrt(0.75) * b;
      const std::int32_t body = lattice.bodies.size();
      at(a, b) = body;
      if (a == 0 && b == 0) t.centre = body;
      if (distance(a, b) == rings) lattice.sets["rim"].push_back(body);
      lattice.bodies.position.push_back({c * x - s * y, s * x + c * y, 0});
      lattice.bodies.orientation.push_back({1, 0, 0, 0});
      lattice.bodies.mass.push_back(ice.density * t.cell * h);
      lattice.bodies.inertia.push_back({1, 1, 1});  // of no account in statics
    }
  }
  for (const std::int32_t body : lattice.sets["rim"])
    lattice.sets["rim" + std::to_string(body)] = {body};
  for (std::int32_t body = 0; body < lattice.bodies.size(); ++body)
    lattice.sets["all"].push_back(body);

  const double w = l / std::sqrt(3.0), iy = w * h * h * h / 12, iz = h * w * w * w / 12;
  Beams& beams = lattice.beams;
  const auto join = [&](std::int32_t i, std::int32_t j) {
    const Point3 &p = lattice.bodies.position[static_cast<std::size_t>(i)],
                 &q = lattice.bodies.position[static_cast<std::size_t>(j)];
    beams.bodies.push_back({i, j});
    beams.area.push_back(w * h);
    beams.inertia_y.push_back(iy);
    beams.inertia_z.push_back(iz);
    beams.torsion.push_back(torsion == Torsion::polar ? iy + iz : saint_venant_torsion(w, h));
    beams.length.push_back(l);
    beams.young.push_back(ice.young);
    beams.shear_modulus.push_back(ice.young / (2 * (1 + ice.poisson)));
    beams.shear_factor.push_back(shear_factor);
    beams.axis_y.push_back({-(q[1] - p[1]) / l, (q[0] - p[0]) / l, 0});
  };
  for (int a = -rings; a <= rings; ++a) {
    for (int b = -rings; b <= rings; ++b) {
      if (distance(a, b) > rings) continue;
      // In the order of the second body: (a, b+1), then (a+1, b-1), then (a+1, b).
      for (const auto& [da, db] : {std::array{0, 1}, std::array{1, -1}, std::array{1, 0}}) {
        if (distance(a + da, b + db) <= rings) join(at(a, b), at(a + da, b + db));
      }
    }
  }
  return t;
}

}  // namespace floe::test
