#include "output/cracks.h"

#include <algorithm>

#include "base/collectives.h"
#include "base/on_root.h"
#include "files/hdf5.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "lattice/pieces.h"

namespace floe {
namespace {

constexpr std::size_t width = 11;

}  // namespace

/// Returns all broken beams on rank 0, in the order of (time, beam).
std::vector<Break> CrackLog::gather() const {
  std::vector<double> mine, all;
  for (const Break& b : fracture_->breaks())
    mine.insert(mine.end(), {b.time, static_cast<double>(b.beam), b.place[0], b.place[1],
                             b.place[2], b.mode_mix, b.energy, b.nominal, b.brittle ? 1.0 : 0.0,
                             b.at_tip ? 1.0 : 0.0, b.area});
  const auto ranks = static_cast<std::size_t>(size(part_.comm));
  const int count = static_cast<int>(mine.size());
  std::vector<int> counts(ranks), offsets(ranks, 0);
  MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, part_.comm);
  for (std::size_t r = 1; r < ranks; ++r) offsets[r] = offsets[r - 1] + counts[r - 1];
  all.resize(static_cast<std::size_t>(offsets.back()) + static_cast<std::size_t>(counts.back()));
  MPI_Gatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), offsets.data(), MPI_DOUBLE,
              0, part_.comm);
  std::vector<Break> breaks;
  for (std::size_t k = 0; k + width <= all.size(); k += width) {
    const double* v = &all[k];
    breaks.push_back({v[0],
                      static_cast<std::int32_t>(v[1]),
                      {v[2], v[3], v[4]},
                      v[5],
                      v[6],
                      v[7],
                      v[8] != 0,
                      v[9] != 0,
                      v[10]});
  }
  std::sort(breaks.begin(), breaks.end(), [](const Break& a, const Break& b) {
    return a.time != b.time ? a.time < b.time : a.beam < b.beam;
  });
  return breaks;
}

double CrackLog::update() {
  const std::int64_t now =
      sum_over_ranks(static_cast<std::int64_t>(fracture_->breaks().size()), part_.comm);
  if (now != written_) {
    const std::vector<Break> breaks = gather();
    on_root(part_.comm, [&] {
      find_fragments(breaks);
      write(breaks);
    });
    written_ = now;
  }
  auto fragments = static_cast<double>(mass_.size());
  broadcast(fragments, part_.comm);
  return fragments;
}

/// Finds the pieces that unbroken beams connect, the heaviest first.
void CrackLog::find_fragments(const std::vector<Break>& breaks) {
  const auto n = lattice_.bodies.position.size();
  std::vector<std::uint8_t> broken(lattice_.beams.bodies.size(), 0);
  for (const Break& b : breaks) item(broken, b.beam) = 1;
  const std::vector<std::int32_t> piece = connected_pieces(lattice_, broken);
  std::vector<double> mass(n, 0);
  for (std::size_t b = 0; b < n; ++b) item(mass, piece[b]) += lattice_.bodies.mass[b];
  std::vector<std::int32_t> roots;
  for (std::size_t b = 0; b < n; ++b) {
    if (piece[b] == static_cast<std::int32_t>(b)) roots.push_back(static_cast<std::int32_t>(b));
  }
  std::stable_sort(roots.begin(), roots.end(),
                   [&](std::int32_t a, std::int32_t b) { return item(mass, a) > item(mass, b); });
  std::vector<std::int32_t> index(n);
  for (std::size_t k = 0; k < roots.size(); ++k)
    item(index, roots[k]) = static_cast<std::int32_t>(k);
  fragment_of_.assign(n, 0);
  bodies_.assign(roots.size(), 0);
  mass_.clear();
  for (const std::int32_t r : roots) mass_.push_back(item(mass, r));
  for (std::size_t b = 0; b < n; ++b) {
    fragment_of_[b] = item(index, piece[b]);
    ++item(bodies_, fragment_of_[b]);
  }
}

void CrackLog::write(const std::vector<Break>& breaks) const {
  Hdf5File file = Hdf5File::create(dir_ + "/breaks.h5");
  const auto column = [&](const char* name, auto value) {
    std::vector<double> values;
    values.reserve(breaks.size());
    for (const Break& b : breaks) values.push_back(value(b));
    file.write(name, values);
  };
  column("/time", [](const Break& b) { return b.time; });
  column("/mode_mix", [](const Break& b) { return b.mode_mix; });
  column("/energy", [](const Break& b) { return b.energy; });
  column("/nominal_energy", [](const Break& b) { return b.nominal; });
  std::vector<std::int32_t> beam, bodies, brittle;
  std::vector<Point3> place;
  for (const Break& b : breaks) {
    const auto [i, j] = item(lattice_.beams.bodies, b.beam);
    beam.push_back(b.beam);
    bodies.insert(bodies.end(), {i, j});
    brittle.push_back(b.brittle ? 1 : 0);
    place.push_back(b.place);
  }
  file.write("/beam", beam);
  file.write("/bodies", bodies, 2);
  file.write("/brittle", brittle);
  file.write("/place", place);
  file.write("/fragments/of_body", fragment_of_);
  file.write("/fragments/bodies", bodies_);
  file.write("/fragments/mass", mass_);
  file.close();
}

}  // namespace floe
