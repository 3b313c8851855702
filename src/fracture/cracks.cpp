#include "fracture/cracks.h"

#include <algorithm>
#include <cmath>

#include "base/collectives.h"

namespace floe {
namespace {

constexpr std::size_t crack_size = 12;  // numbers of a Crack in a checkpoint

std::vector<double> packed(const std::vector<Crack>& cracks) {
  std::vector<double> values;
  values.reserve(cracks.size() * crack_size);
  for (const Crack& c : cracks) {
    values.insert(values.end(),
                  {static_cast<double>(c.beam), c.kappa, c.damage, c.ultimate, c.mode_mix,
                   c.nominal, c.dissipated, c.time, c.place[0], c.place[1], c.place[2],
                   (c.at_tip ? 1.0 : 0.0) + (c.crushed ? 2.0 : 0.0)});
  }
  return values;
}

}  // namespace

std::vector<double> Cracks::as_numbers() const {
  std::vector<double> all(numbers * beams(), 0.0);
  for (const Crack& c : all_) {
    const std::array<double, numbers> values{
        c.kappa,   c.damage,     c.ultimate,           c.mode_mix,
        c.nominal, c.dissipated, c.at_tip ? 1.0 : 0.0, c.crushed ? 1.0 : 0.0,
        c.time,    c.place[0],   c.place[1],           c.place[2]};
    std::copy(values.begin(), values.end(),
              all.begin() + static_cast<std::ptrdiff_t>(numbers) * c.beam);
  }
  return all;
}

Crack Cracks::of_numbers(std::int32_t beam, std::span<const double, numbers> v) {
  return {beam,     v[0], v[1], v[2], v[3], v[4], v[5], v[6] != 0, v[8], {v[9], v[10], v[11]},
          v[7] != 0};
}

void persist_cracks(Archive& archive, const Part& part, std::vector<Crack>& cracks) {
  constexpr std::size_t width = crack_size;
  std::vector<double> all;
  if (!archive.loading()) all = all_gathered(packed(cracks), part.comm);
  archive.common("cracks", all);
  if (!archive.loading()) return;
  archive.renumber_beams(all, width);
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
                      std::fmod(v[11], 2) == 1,
                      v[7],
                      {v[8], v[9], v[10]},
                      v[11] >= 2});
  }
}

}  // namespace floe
